#pragma once

#include "app/session/opening/document_readers.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"

#include <cstddef>
#include <cstdint>

namespace gs::app {

/// Streams of the visible worlds: their bytes, priorities, and the bandwidth of each viewport. One thread.
class StreamTransfers {
 public:
  StreamTransfers(StepContext& step, SessionViewports& viewports, const DocumentReaders& readers,
                  const LoadOptions& load)
      : step_(step), viewports_(viewports), readers_(readers), load_(load) {}

  /// Limits the bandwidth of each world to the highest limit of the viewports that show it.
  void limit_rates();
  /// Passes received bytes to the streams. Returns true if the picture changed.
  bool feed();
  /// Gives nodes that look large in the active viewport the highest priority.
  void prioritize();
  /// Requests the parts of streams that the last drawn picture lacked. Shares the bandwidth by viewport weight.
  void request();

  /// Returns a viewport's share of the bandwidth, 0 to 1; 0 means that it receives nothing.
  [[nodiscard]] double reading_share(std::size_t pane) const;
  /// Returns the limit of a viewport's bandwidth in bits per second; 0 means unlimited.
  [[nodiscard]] std::uint64_t rate_of(std::size_t pane) const;
  /// Returns the bytes received over the network for a viewport.
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
