#include "vrml/event_model/script_host.h"
#include "vrml/event_model/states.h"

#include <cstddef>
#include <utility>

namespace gs::vrml {
namespace {

struct Script {
  enum : int { url };
};

// Work elements per call of a program. They end the cascade if programs send each other events forever.
constexpr std::size_t kCall = 2048;

ScriptState& state_of_script(Execution& execution, EventNode node) {
  std::uint32_t& place = execution.nodes().state_of(node);
  if (place == 0) place = execution.states().scripts.take();
  return execution.states().scripts[place];
}

// Delivers queued events in order, as long as programs have time. Events that the programs send follow later. Calls
// eventsProcessed() at most once per cascade (4.12.4).
void run_kept(Execution& execution, EventNode node, ScriptHost& host) {
  ScriptState& state = state_of_script(execution, node);
  while (!state.kept.empty() && host.has_time()) {
    const ScriptState::Kept one = std::move(state.kept.front());
    state.kept.pop_front();
    state.owes_processed = host.deliver(node, one.interface, one.value, one.time) || state.owes_processed;
  }
  if (!state.kept.empty()) execution.timers().call_at(node, execution.now());
}

bool script_event(Execution& execution, EventNode node, int, const FieldValue&) {
  state_of_script(execution, node).begins = true;
  execution.timers().look_again(node);
  return true;
}

void script_own_event(Execution& execution, EventNode node, std::uint32_t interface, const FieldValue& value) {
  ScriptHost* const host = execution.scripts().host();
  if (!host) return;
  ScriptState& state = state_of_script(execution, node);
  if (state.kept.empty() && !state.begins && !host->waits(node) && host->has_time()) {
    if (execution.budget().spend(kCall)) execution.scripts().deliver(node, interface, value);
    return;
  }
  if (state.kept.size() >= ScriptState::kMaxKept || !execution.budget().spend(ScriptState::kKeptCost)) return;
  state.kept.push_back({interface, value, execution.now()});
  execution.timers().look_again(node);
}

void script_time(Execution& execution, EventNode node) {
  ScriptHost* const host = execution.scripts().host();
  if (!host) return;
  ScriptState& state = state_of_script(execution, node);
  if (state.begins || !state.kept.empty()) execution.scripts().flush();
  if (std::exchange(state.begins, false)) (void)host->begin(node);
  if (host->waits(node)) return;
  if (!state.kept.empty()) run_kept(execution, node, *host);
  if (!state.owes_processed) return;
  if (state.processed_at == execution.now()) return execution.timers().call_at(node, execution.now());
  state.owes_processed = false;
  state.processed_at = execution.now();
  execution.scripts().call_processed(node);
}

}  // namespace

const Behaviour kScriptBehaviour = {
    .events = {"url"},
    .initialize = [](Execution& execution, EventNode node) { execution.scripts().add(node); },
    .on_event = script_event,
    .on_time = script_time,
    .on_own_event = script_own_event,
    .before_removal =
        [](Execution& execution, EventNode node) {
          if (ScriptHost* const host = execution.scripts().host()) host->end(node);
        },
    .on_remove =
        [](Execution& execution, EventNode node) {
          execution.states().scripts.give_back(std::exchange(execution.nodes().state_of(node), 0));
          if (ScriptHost* const host = execution.scripts().host()) host->forget(node);
        },
};

}  // namespace gs::vrml
