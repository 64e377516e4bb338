#pragma once

#include <atomic>
#include <chrono>

namespace gs::app {

/// Deadline of loading, which a flag can also cancel.
struct LoadLimit {
  std::chrono::steady_clock::time_point at;
  const std::atomic<bool>* cancelled = nullptr;  // outlives the loading; null if it cannot be cancelled

  LoadLimit(std::chrono::steady_clock::time_point time, const std::atomic<bool>* flag = nullptr)
      : at(time), cancelled(flag) {}
  /// Returns true if loading must stop; everything that is missing then is omitted.
  [[nodiscard]] bool over() const { return (cancelled && *cancelled) || std::chrono::steady_clock::now() > at; }
};

}  // namespace gs::app
