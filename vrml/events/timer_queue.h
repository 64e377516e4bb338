#pragma once

#include "vrml/event_model/behaviour.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace gs::vrml {

/// Nodes that time concerns: those that run in each step, those that must be evaluated once more with the present
/// timestamp, and those with an alarm. Part of Execution.
class TimerQueue {
 public:
  explicit TimerQueue(Execution& execution) : execution_(execution) {}

  /// Turns calls of on_time in each step on or off.
  void run(EventNode node, bool running);
  /// Requests one more call of on_time with this timestamp.
  void look_again(EventNode node);
  /// Requests look_again() for all running nodes.
  void look_again_at_running();
  /// Requests a call of on_time in the first step at or after `time`, later than the present step. Each node has one
  /// such request; a new one replaces it.
  void call_at(EventNode node, double time);

  /// Begins a step at `now`: requests look_again() for nodes with due alarms, and calls the running nodes.
  void begin_step(double now);
  /// Calls the nodes of look_again() until there are none.
  void call_waiting();
  [[nodiscard]] bool has_running() const;
  /// Returns the time of the next alarm; nullopt if there is none.
  [[nodiscard]] std::optional<double> next_alarm() const;

  /// Forgets the alarm of a node that is being removed.
  void remove(EventNode node);
  /// Forgets removed nodes.
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

  Execution& execution_;
  std::vector<EventNode> running_, looking_;
  std::vector<Alarm> alarms_;  // heap, earliest first
  std::size_t live_alarms_ = 0;
  std::uint32_t alarm_number_ = 0;
};

}  // namespace gs::vrml
