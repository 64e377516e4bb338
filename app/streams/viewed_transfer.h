#pragma once

#include "base/noncopyable.h"
#include "net/transfer/load_types.h"

#include <cstdint>

namespace gs::app {

/// Transfer of the parts that views choose while the world is shown. Reader thread only.
class ViewedTransfer : NonCopyable {
 public:
  virtual ~ViewedTransfer() = default;
  /// Requests parts that views want now. Returns true if it did anything.
  virtual bool ask_for_more() = 0;
  /// Handles an event of the loader. Returns false if the event belongs to another transfer.
  virtual bool take(net::LoadEvent& event) = 0;
  /// Returns true if a fetch receives the parts, so that it ends with the transfer.
  [[nodiscard]] virtual bool has_fetch() const { return false; }
  /// Cancels all requests and ends the transfer.
  virtual void cancel() = 0;
  /// Cancels the requests of a row of the ledger. Ignores rows of other transfers.
  virtual void cancel_row(std::uint64_t row) = 0;
  /// Returns true if the transfer is complete, failed or cancelled.
  [[nodiscard]] virtual bool over() const = 0;
  /// Reports whether no request is pending.
  [[nodiscard]] virtual bool rests() const = 0;
};

}  // namespace gs::app
