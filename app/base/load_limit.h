#pragma once

#include <atomic>
#include <chrono>

namespace gs::app {

/// Until when something may be loaded: a time, and as long as nobody has cancelled it.
struct LoadLimit {
  std::chrono::steady_clock::time_point at;
  const std::atomic<bool>* cancelled = nullptr;  // outlives the loading; null: nobody can

  LoadLimit(std::chrono::steady_clock::time_point time, const std::atomic<bool>* flag = nullptr)
      : at(time), cancelled(flag) {}
  /// What is missing now is left out.
  [[nodiscard]] bool over() const { return (cancelled && *cancelled) || std::chrono::steady_clock::now() > at; }
};

}  // namespace gs::app
