#pragma once

#include "app/session/opening/document_readers.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"

#include <cstddef>
#include <cstdint>

namespace gs::app {

/// Transfers of the streams in visible worlds: received bytes, priorities, and the bandwidth of each viewport. One
/// thread.
class StreamTransfers {
 public:
  StreamTransfers(StepContext& step, SessionViewports& viewports, const DocumentReaders& readers,
                  const LoadOptions& load)
      : step_(step), viewports_(viewports), readers_(readers), load_(load) {}

  /// Sets the bandwidth limit of each world: the highest limit of the viewports that show it.
  void limit_rates();
  /// Passes received bytes to the streams. Returns true if a picture changed.
  bool feed();
  /// Prioritises references of the active viewport's world by the apparent size of their nodes.
  void prioritize();
  /// Requests the stream parts that the last drawn pictures lacked. Divides the bandwidth by the weights of the
  /// viewports.
  void request();

  /// Returns a viewport's share of the bandwidth, 0 to 1; 0 means that it expects no data.
  [[nodiscard]] double reading_share(std::size_t pane) const;
  /// Returns the bandwidth limit of a viewport in bits/s; 0 means unlimited.
  [[nodiscard]] std::uint64_t rate_of(std::size_t pane) const;
  /// Returns the number of bytes received over the network for a viewport's file.
  [[nodiscard]] std::uint64_t received(std::size_t pane) const;

 private:
  [[nodiscard]] bool reads(std::size_t pane) const;
  void weigh();

  StepContext& step_;
  SessionViewports& viewports_;
  const DocumentReaders& readers_;
  const LoadOptions& load_;
  double next_priorities_ = 0;
};

}  // namespace gs::app
