#pragma once

#include <atomic>
#include <chrono>

namespace gs::app {

/// Time limit of loading. A flag can also cancel loading.
struct LoadLimit {
  std::chrono::steady_clock::time_point at;
  const std::atomic<bool>* cancelled = nullptr;  // must outlive loading; null if loading cannot be cancelled

  LoadLimit(std::chrono::steady_clock::time_point time, const std::atomic<bool>* flag = nullptr)
      : at(time), cancelled(flag) {}
  /// Returns true if loading must stop. Missing parts are then omitted.
  [[nodiscard]] bool over() const { return (cancelled && *cancelled) || std::chrono::steady_clock::now() > at; }
};

}  // namespace gs::app
