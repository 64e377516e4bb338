#include "vrml/behaviours/pauses.h"
#include "vrml/events/execution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::vrml {
namespace {

struct Clock {
  enum : int {
    cycle_interval,
    enabled,
    loop,
    start_time,
    stop_time,
    cycle_time,
    fraction_changed,
    is_active,
    time,
    pause_time,
    resume_time,
    is_paused,
    elapsed_time
  };
};
constexpr PauseEvents kClockPauseEvents = {Clock::start_time, Clock::pause_time, Clock::resume_time, Clock::is_paused,
                                           Clock::elapsed_time};

TimeState& state_of_sensor(Execution& execution, EventNode node) {
  return execution.states().times[execution.nodes().state_of(node)];
}

struct TimeFields {
  double interval, start, stop;
  bool loop, enabled;
};

TimeFields fields_of(const Execution& execution, EventNode node) {
  TimeFields f{execution.get<SFTime>(node, Clock::cycle_interval), execution.get<SFTime>(node, Clock::start_time),
               execution.get<SFTime>(node, Clock::stop_time), execution.get<SFBool>(node, Clock::loop),
               execution.get<SFBool>(node, Clock::enabled)};
  // Replaces intervals that the standard forbids, outside (0,inf), by the default.
  if (!(f.interval > 0) || !std::isfinite(f.interval)) f.interval = 1;
  return f;
}

// Moves the start by the pauses, so that cycles continue after them.
TimeFields fields_after_pauses(const Execution& execution, EventNode node, const TimeState& state) {
  TimeFields f = fields_of(execution, node);
  f.stop = f.stop > f.start ? f.stop : std::numeric_limits<double>::infinity();
  f.start += state.pause.total;
  return f;
}

// Period that ends at the time of the outputs. `inside_cycle`: the activity ends within a cycle. `cycle`: the activity
// ends with its last cycle.
enum class Ending : std::uint8_t { none, inside_cycle, cycle };

// Sends the outputs of an active sensor (6.50) for the time `at`. This is the time of the step, or the end of the
// activity between two steps. `ending` marks the end of the last cycle, because rounding could miss it.
void send_outputs(Execution& execution, EventNode node, TimeState& state, const TimeFields& f, double at,
                  Ending ending) {
  const double cycles = (at - f.start) / f.interval;
  double cycle = std::floor(cycles), fraction = cycles - cycle;
  if (!std::isfinite(cycles)) cycle = fraction = 0;
  const bool end_of_cycle = ending == Ending::cycle || (fraction == 0 && at > f.start);
  if (ending == Ending::none && (!state.cycle_sent || cycle != state.cycle)) {
    state.cycle_sent = true;
    state.cycle = cycle;
    execution.send(node, Clock::cycle_time, SFTime{f.start + cycle * f.interval});
  }
  execution.send(node, Clock::fraction_changed, end_of_cycle ? SFFloat{1} : static_cast<SFFloat>(fraction));
  execution.send(node, Clock::time, SFTime{at});
  send_elapsed(execution, node, kClockPauseEvents, state.pause, at);
  state.sent_at = at;
}

void start_if_due(Execution& execution, EventNode node, TimeState& state, const TimeFields& f) {
  const double now = execution.now();
  const bool delayed = std::exchange(state.delayed, false);
  if (!f.enabled) return;
  if (f.start > now) {
    execution.timers().call_at(node, f.start);
    return;
  }
  const bool stopped = f.stop > f.start && now >= f.stop, over = !f.loop && now >= f.start + f.interval;
  // A step may be longer than the whole active period. The sensor must become active nevertheless.
  const bool since_last_step = delayed || f.start > execution.cascade().previous();
  if (!(f.start <= now) || ((stopped || over) && !since_last_step)) return;
  if (execution.has_sent(node, Clock::is_active)) {
    state.delayed = true;
    execution.timers().call_at(node, now);
    return;
  }
  state.active = true;
  state.cycle_sent = false;
  state.sent_at = -std::numeric_limits<double>::infinity();
  begin_pauses(state.pause, f.start > execution.cascade().previous() ? f.start : now);
  execution.send(node, Clock::is_active, SFBool{true});
  if (over) {  // end of the only cycle
    state.cycle_sent = true;
    state.cycle = 0;
    execution.send(node, Clock::cycle_time, SFTime{f.start});
  }
  const double end = over ? f.start + f.interval : now;
  if (stopped && f.stop < end) {
    send_outputs(execution, node, state, f, f.stop, over ? Ending::inside_cycle : Ending::none);
  } else {
    send_outputs(execution, node, state, f, end, over ? Ending::cycle : Ending::none);
  }
  execution.timers().run(node, true);
}

void stop(Execution& execution, EventNode node, TimeState& state, double at, Ending ending) {
  // Timestamps increase (4.11.1). Does not send outputs again for the same time. A stopTime in the past means now
  // (6.50).
  if (at > state.sent_at && !state.pause.paused)
    send_outputs(execution, node, state, fields_after_pauses(execution, node, state), at, ending);
  end_pauses(execution, node, kClockPauseEvents, state.pause);
  execution.send(node, Clock::is_active, SFBool{false});
  state.active = false;
  execution.timers().run(node, false);
  // If the sensor must stop and start again at the same time, it stops first (4.6.9).
  if (state.new_start_at == execution.now()) {
    execution.send(node, Clock::start_time, SFTime{state.new_start});
    start_if_due(execution, node, state, fields_of(execution, node));
  }
}

// Begins and ends pauses. Returns true if the sensor is paused now and has nothing else to do.
bool pauses(Execution& execution, EventNode node, TimeState& state) {
  if (!has_pauses(execution, node, kClockPauseEvents)) return false;
  const bool before = state.pause.paused;
  const std::optional<double> begins = begin_pause(execution, node, kClockPauseEvents, state.pause, state.sent_at);
  if (begins && *begins > state.sent_at)
    send_outputs(execution, node, state, fields_after_pauses(execution, node, state), *begins, Ending::none);
  if (!begins) resume(execution, node, kClockPauseEvents, state.pause);
  if (before != state.pause.paused) execution.timers().run(node, !state.pause.paused);
  return state.pause.paused;
}

void time_sensor_time(Execution& execution, EventNode node) {
  TimeState& state = state_of_sensor(execution, node);
  if (!state.active) {
    start_if_due(execution, node, state, fields_of(execution, node));
    return;
  }
  const bool paused = pauses(execution, node, state);
  const TimeFields f = fields_after_pauses(execution, node, state);
  const double now = execution.now(), stop_time = f.stop;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double cycle_end = f.loop || paused ? kNever : f.start + (state.cycle + 1) * f.interval;
  const double end = std::min(stop_time, cycle_end);
  if (execution.has_sent(node, Clock::is_active) && (!f.enabled || now >= end)) {
    execution.timers().run(node, true);  // already started with this timestamp; stops with the next timestamp
    return;
  }
  if (now >= end) {
    stop(execution, node, state, end, cycle_end <= stop_time ? Ending::cycle : Ending::inside_cycle);
  } else if (!f.enabled) {
    stop(execution, node, state, now, Ending::inside_cycle);
  } else if (paused) {
    const double next = std::min(end, next_resume(execution, node, kClockPauseEvents));
    if (next < kNever) execution.timers().call_at(node, next);
  } else {
    send_outputs(execution, node, state, f, now, Ending::none);
  }
}

// Handles events while the sensor is active (4.6.9). Ignores set_startTime and set_cycleInterval. Ignores a
// set_stopTime that is not after startTime.
bool time_sensor_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  TimeState& state = state_of_sensor(execution, node);
  execution.timers().look_again(node);
  if (!state.active) return true;
  if (event == Clock::cycle_interval) return false;
  if (event == Clock::stop_time) return std::get<SFTime>(value) > execution.get<SFTime>(node, Clock::start_time);
  if (event == Clock::start_time) {
    state.new_start = std::get<SFTime>(value);
    state.new_start_at = execution.now();
    return false;
  }
  return true;
}

void time_sensor_begin(Execution& execution, EventNode node) {
  auto& times = execution.states().times;
  if (!times.has_spare() && !execution.budget().afford(sizeof(TimeState))) return;
  execution.nodes().state_of(node) = times.take();
  execution.timers().look_again(node);
}

}  // namespace

const Behaviour kTimeSensorBehaviour = {
    .events = {"cycleInterval", "enabled", "loop", "startTime", "stopTime", "cycleTime", "fraction_changed", "isActive",
               "time", "pauseTime", "resumeTime", "isPaused", "elapsedTime"},
    .initialize = time_sensor_begin,
    .on_event = time_sensor_event,
    .on_time = time_sensor_time,
    .on_remove = [](Execution& execution,
                    EventNode node) { execution.states().times.give_back(execution.nodes().state_of(node)); },
};

}  // namespace gs::vrml
