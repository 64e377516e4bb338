#pragma once

#include "app/loading/fetch/fetch.h"
#include "app/streams/cell_stream.h"
#include "net/cells/cell_receiver.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

namespace gs::app {

struct Loading;

/// Transfers of streams as cells.
class CellTransfers {
 public:
  explicit CellTransfers(Loading& loading) : loading_(loading) {}

  /// Begins a resource. Returns false if the text must not request it.
  bool begin(Fetch& fetch, const net::Url& url);
  /// Handles received cells. Returns true if there were any.
  bool step();
  /// Stops the transfer for a fetch.
  void stop(const Fetch& fetch);
  /// Stops the stream that views follow in this row of the ledger.
  void cancel_stream(std::uint64_t row);
  void set_rate();
  /// Returns true if no stream awaits what views want.
  [[nodiscard]] bool streams_rest() const;
  [[nodiscard]] bool has_streams() const { return !cells_.empty(); }
  /// Returns the number of received and lost datagrams.
  [[nodiscard]] net::CellClientStatistics statistics() const;

 private:
  struct Cells;
  void open(Fetch& fetch, const net::Url& url);

  Loading& loading_;
  std::vector<std::shared_ptr<Cells>> cells_;
  std::deque<Fetch*> waiting_;                      // fetches that documents requested
  std::unordered_set<std::string> silent_servers_;  // servers that did not answer a request
  net::CellClientStatistics ended_;                 // statistics of finished streams
};

}  // namespace gs::app
