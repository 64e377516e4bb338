#include "vrml/behaviours/pauses.h"

#include <limits>

namespace gs::vrml {
namespace {

constexpr double kNoPause = std::numeric_limits<double>::infinity();

}  // namespace

bool has_pauses(Execution& execution, EventNode node, const PauseEvents& events) {
  return execution.nodes().has_event(node, events.is_paused);
}

void begin_pauses(PauseState& state, double now) {
  state = {};
  state.activated = now;
}

// A pauseTime before startTime belongs to an earlier activity. A pauseTime before resumeTime belongs to a pause that is
// over.
double next_pause(Execution& execution, EventNode node, const PauseEvents& events) {
  const double pause = execution.get<SFTime>(node, events.pause_time);
  const bool counts = pause > execution.get<SFTime>(node, events.resume_time) &&
                      pause >= execution.get<SFTime>(node, events.start_time);
  return counts ? pause : kNoPause;
}

std::optional<double> begin_pause(Execution& execution, EventNode node, const PauseEvents& events, PauseState& state,
                                  double last) {
  const double pause = next_pause(execution, node, events), now = execution.now();
  if (state.paused || !(pause <= now) || execution.has_sent(node, events.is_paused)) return std::nullopt;
  state.paused = true;
  state.since = pause > last ? pause : now;
  execution.send(node, events.is_paused, SFBool{true});
  return state.since;
}

double next_resume(Execution& execution, EventNode node, const PauseEvents& events) {
  const double resume = execution.get<SFTime>(node, events.resume_time);
  return resume > execution.get<SFTime>(node, events.pause_time) ? resume : kNoPause;
}

void resume(Execution& execution, EventNode node, const PauseEvents& events, PauseState& state) {
  const double time = next_resume(execution, node, events), now = execution.now();
  if (!state.paused || !(time <= now) || execution.has_sent(node, events.is_paused)) return;
  state.paused = false;
  state.total += (time > execution.cascade().previous() && time > state.since ? time : now) - state.since;
  execution.send(node, events.is_paused, SFBool{false});
}

void end_pauses(Execution& execution, EventNode node, const PauseEvents& events, PauseState& state) {
  if (state.paused) execution.send(node, events.is_paused, SFBool{false});
  state = {};
}

void send_elapsed(Execution& execution, EventNode node, const PauseEvents& events, const PauseState& state, double at) {
  if (has_pauses(execution, node, events))
    execution.send(node, events.elapsed_time, SFTime{at - state.activated - state.total});
}

}  // namespace gs::vrml
