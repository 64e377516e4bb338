#include "vrml/event_model/behaviour.h"
#include "vrml/events/execution.h"

#include <algorithm>

namespace gs::vrml {
namespace {

// Indices of the events of a LoadSensor (ISO/IEC 19775-1 9.4.3).
enum Event { enabled, time_out, watch_list, is_active, is_loaded, load_time, progress };

void begin(Execution& execution, EventNode node) {
  StatePool<LoadSensorState>& states = execution.states().loads;
  if (!states.has_spare() && !execution.budget().afford(sizeof(LoadSensorState))) return;
  execution.nodes().state_of(node) = states.take();
  execution.loads().add_sensor(node);
  execution.timers().call_at(node, execution.now());
}

void end(Execution& execution, EventNode node) {
  execution.loads().remove_sensor(node);
  execution.states().loads.give_back(execution.nodes().state_of(node));
}

// Ends a period of loading.
void send_end(Execution& execution, EventNode node, LoadSensorState& state, bool loaded) {
  if (state.active) execution.send(node, is_active, SFBool{false});
  execution.send(node, is_loaded, SFBool{loaded});
  if (loaded) execution.send(node, load_time, SFTime{execution.now()});
  state.active = false;
  state.told = true;
}

// Compares the state of the watched nodes with the last one, and sends the differences.
void look(Execution& execution, EventNode node) {
  if (execution.nodes().state_of(node) == 0) return;
  LoadSensorState& state = execution.states().loads[execution.nodes().state_of(node)];
  if (!execution.get<SFBool>(node, enabled)) {
    if (state.active) execution.send(node, is_active, SFBool{false});
    state = {};
    return;
  }
  const auto again = [&](double time) { execution.timers().call_at(node, time); };
  if (execution.has_sent(node, is_active) || execution.has_sent(node, is_loaded) || execution.has_sent(node, progress))
    return again(execution.now());
  const NodePlace at = execution.nodes().place_of(node);
  const UrlLoads::Counts counts = execution.loads().count(*at.scene, execution.get<MFNode>(node, watch_list));
  if (counts.all() == 0) return;
  if (counts.pending > 0 && !state.active && !state.timed_out) {
    state = {};
    state.active = true;
    state.began = execution.now();
    execution.send(node, is_active, SFBool{true});
  }
  const float fraction = static_cast<float>(counts.loaded) / static_cast<float>(counts.all());
  if (counts.pending == 0) {
    state.timed_out = false;
    if (state.told && !state.active) return;
    execution.send(node, progress, SFFloat{fraction});
    return send_end(execution, node, state, counts.failed == 0);
  }
  if (!state.active) return;
  state.told = false;
  if (fraction != state.fraction) {
    state.fraction = fraction;
    execution.send(node, progress, SFFloat{fraction});
  }
  const SFTime limit = execution.get<SFTime>(node, time_out);
  if (!(limit > 0)) return;
  if (execution.now() < state.began + limit) return again(state.began + limit);
  // An event of this timestamp has begun the period.
  if (execution.has_sent(node, is_active)) return again(execution.now());
  send_end(execution, node, state, false);
  state.timed_out = true;
  state.told = false;  // success may follow
}

bool note_change(Execution& execution, EventNode node, int, const FieldValue&) {
  execution.timers().look_again(node);
  if (execution.nodes().state_of(node) != 0) {
    LoadSensorState& state = execution.states().loads[execution.nodes().state_of(node)];
    state.told = state.timed_out = false;
  }
  return true;
}

}  // namespace

const Behaviour kLoadSensorBehaviour = {
    .events = {"enabled", "timeOut", "watchList", "isActive", "isLoaded", "loadTime", "progress"},
    .initialize = begin,
    .on_event = note_change,
    .on_time = look,
    .on_remove = end,
};

}  // namespace gs::vrml
