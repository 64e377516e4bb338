#include "vrml/events/execution.h"

namespace gs::vrml {

Execution::Execution(SceneGraph& root)
    : budget_(root),
      scenes_(*this, root),
      nodes_(*this),
      routes_(*this),
      cascade_(*this),
      changes_(*this),
      stacks_(*this),
      timers_(*this),
      lifetime_(*this),
      scripts_(*this),
      placement_(root),
      viewer_(*this),
      pointing_(*this),
      browser_(*this),
      loads_(*this),
      keys_(*this),
      shapes_(*this) {
  scenes_.attach();
}

void Execution::start(double now) {
  cascade_.begin(now, true);
  browser_.begin(cascade_.now());
  stacks_.bind_first(scenes_.states().front());
  scripts_.begin_world();
  cascade_.drain();
}

void Execution::step(double now) {
  if (budget_.is_halted()) return;
  cascade_.begin(now);
  browser_.send_changes();
  if (ScriptHost* const host = scripts_.host()) host->prepare_events();
  timers_.begin_step(cascade_.now());
  pointing_.go_on();
  cascade_.drain();
}

std::optional<double> Execution::next_time() const {
  if (budget_.is_halted()) return std::nullopt;
  if (scripts_.host() && scripts_.host()->prepares_events()) return now();
  if (timers_.has_running() || pointing_.waits() || lifetime_.waits() || scripts_.waits() || browser_.waits())
    return now();
  return timers_.next_alarm();
}

bool Execution::has_sent(EventNode node, int event) const {
  return nodes_.has_event(node, event) &&
         cascade_.has_sent_own(node, nodes_.schema_of(node).events[static_cast<std::size_t>(event)]);
}

}  // namespace gs::vrml
