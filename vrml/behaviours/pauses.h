#pragma once

#include "vrml/event_model/states.h"
#include "vrml/events/execution.h"

#include <optional>

// Pauses of time-dependent nodes (X3D 8.2.4). Nodes of VRML97 have no pauses.
namespace gs::vrml {

/// Interfaces for pauses, as indices of Behaviour::events.
struct PauseEvents {
  int start_time, pause_time, resume_time, is_paused, elapsed_time;
};

/// Reports whether the node's type has pauses.
[[nodiscard]] bool has_pauses(Execution& execution, EventNode node, const PauseEvents& events);
/// Forgets all pauses, because the node becomes active at the time `now`.
void begin_pauses(PauseState& state, double now);
/// Pauses an active node if pauseTime is reached. `last` is the time of the node's last outputs. Returns the time at
/// which the pause begins; nullopt if no pause begins. Sends isPaused.
std::optional<double> begin_pause(Execution& execution, EventNode node, const PauseEvents& events, PauseState& state,
                                  double last);
/// Ends the pause of a node if resumeTime is reached. Sends isPaused.
void resume(Execution& execution, EventNode node, const PauseEvents& events, PauseState& state);
/// Returns the time at which a paused node resumes; infinity if none is set.
[[nodiscard]] double next_resume(Execution& execution, EventNode node, const PauseEvents& events);
/// Returns the time at which an active node pauses; infinity if none is set.
[[nodiscard]] double next_pause(Execution& execution, EventNode node, const PauseEvents& events);
/// Ends the pause of a node that becomes inactive. Sends isPaused FALSE if the node is paused.
void end_pauses(Execution& execution, EventNode node, const PauseEvents& events, PauseState& state);
/// Sends elapsedTime of a node that is not paused: seconds since the activation, without pauses.
void send_elapsed(Execution& execution, EventNode node, const PauseEvents& events, const PauseState& state, double at);

}  // namespace gs::vrml
