#pragma once

#include "vrml/event_model/script_host.h"

#include <chrono>

namespace gs::app::script {

/// Time that the programs of a world use in a step. One thread.
class StepTime {
 public:
  using Duration = std::chrono::steady_clock::duration;

  /// `seconds` is the time for all programs of a step; 0 means unlimited.
  explicit StepTime(double seconds) : seconds_(seconds) {}

  /// Begins a step. Returns the Script of the longest call if the time of the last step did not suffice, else 0.
  vrml::EventNode begin() {
    const vrml::EventNode slowest = late_ ? slowest_ : 0;
    spent_ = longest_ = {};
    late_ = false;
    return slowest;
  }
  /// Adds the time of a call.
  void add(vrml::EventNode script, Duration took) {
    spent_ += took;
    if (took <= longest_) return;
    longest_ = took;
    slowest_ = script;
  }
  /// Adds time that no single call has used.
  void add(Duration took) { spent_ += took; }
  /// Reports whether time is left. If none is left, the step is late.
  [[nodiscard]] bool has_time() {
    if (seconds_ <= 0) return true;
    const bool has = spent_ < std::chrono::duration<double>(seconds_);
    late_ = late_ || !has;
    return has;
  }
  [[nodiscard]] bool is_late() const { return late_; }

 private:
  const double seconds_;
  Duration spent_{}, longest_{};  // in this step: time of all calls, and of the longest call
  vrml::EventNode slowest_ = 0;   // Script of the longest call
  bool late_ = false;
};

}  // namespace gs::app::script
