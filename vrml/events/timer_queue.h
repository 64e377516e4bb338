#pragma once

#include "vrml/event_model/behaviour.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace gs::vrml {

/// Nodes that behaviours must call at certain times: in each step, once more with the present timestamp, or at the time
/// of an alarm. Part of Execution.
class TimerQueue {
 public:
  explicit TimerQueue(Execution& execution) : execution_(execution) {}

  /// Starts or stops calls of on_time in each step.
  void run(EventNode node, bool running);
  /// Requests one more call of on_time with the present timestamp.
  void look_again(EventNode node);
  /// Requests look_again() for all running nodes.
  void look_again_at_running();
  /// Requests a call of on_time in the first step at or after `time` that follows the present step. A new request of a
  /// node replaces its previous one.
  void call_at(EventNode node, double time);

  /// Begins a step at the time `now`. Calls look_again() for nodes with due alarms, then calls the running nodes.
  void begin_step(double now);
  /// Calls all nodes that look_again() added, until there are none left.
  void call_waiting();
  [[nodiscard]] bool has_running() const;
  /// Returns the time of the next alarm; nullopt if there is none.
  [[nodiscard]] std::optional<double> next_alarm() const;

  /// Discards the alarm of a node that is removed.
  void remove(EventNode node);
  /// Discards removed nodes.
  void forget_removed();

 private:
  struct Alarm {
    double time;
    EventNode node;
    std::uint32_t number;
    friend bool operator>(const Alarm& a, const Alarm& b) {
      return a.time != b.time ? a.time > b.time : a.node != b.node ? a.node > b.node : a.number > b.number;
    }
  };

  void take_woken();

  Execution& execution_;
  std::vector<EventNode> running_, looking_;  // running_ is sorted by rank and omits nodes that rest in IdleSensors
  std::uint64_t last_rank_ = 0;
  std::vector<Alarm> alarms_;  // heap; the earliest alarm is first
  std::size_t live_alarms_ = 0;
  std::uint32_t alarm_number_ = 0;
};

}  // namespace gs::vrml
