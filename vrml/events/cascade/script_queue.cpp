#include "vrml/events/script_queue.h"

#include "vrml/event_model/states.h"
#include "vrml/events/execution.h"

#include <utility>

namespace gs::vrml {

void ScriptQueue::add(EventNode node) {
  has_scripts_ = true;
  new_.push_back(node);
}

void ScriptQueue::begin_world() {
  started_ = starting_ = true;
  begin_new();
  starting_ = false;
}

// Starts new Scripts before they receive any event (4.12.3). A program may create Scripts, and their programs may
// create more. In a running world, at most 64 Scripts start per timestamp.
void ScriptQueue::begin_new() {
  constexpr std::size_t kBegin = std::size_t{1} << 20;  // work elements of a start
  if (!started_) return;
  if (!host_) return new_.clear();
  if (!new_.empty()) flush();
  std::size_t begun = 0;
  for (; begun < new_.size() && (starting_ || execution_.budget().has_room_for(kBegin)); ++begun) {
    if (!starting_) (void)execution_.budget().spend(kBegin);
    const EventNode node = new_[begun];
    (void)host_->begin(node);
    if (!starting_) execution_.timers().look_again(node);  // delivers the events that were queued before
  }
  new_.erase(new_.begin(), new_.begin() + static_cast<std::ptrdiff_t>(begun));
}

// ---- Calls of programs

// An observer must see the events between the calls as they happen. A Script that sends events to itself may change
// the value of an event while it is delivered.
bool ScriptQueue::may_wait(EventNode node) const {
  const EventCascade& cascade = execution_.cascade();
  return !cascade.is_observed() && cascade.source() != node && host_->may_wait(node);
}

void ScriptQueue::wait(ScriptCall call) {
  constexpr std::size_t kMostWaiting = 1024;
  execution_.nodes()[call.script].waits = true;
  waiting_.push_back(std::move(call));
  if (waiting_.size() >= kMostWaiting) flush();
}

void ScriptQueue::deliver(EventNode node, std::uint32_t interface, const FieldValue& value) {
  if (may_wait(node)) return wait({node, interface, value, execution_.now()});
  flush();
  if (host_->deliver(node, interface, value, execution_.now())) owe_processed(node);
}

void ScriptQueue::call_processed(EventNode node) {
  if (may_wait(node)) return wait({.script = node});
  flush();
  host_->events_processed(node);
}

void ScriptQueue::make_waiting() {
  std::vector<ScriptCall> calls = std::exchange(making_, {});
  calls.swap(waiting_);
  if (!host_) return;
  for (const ScriptCall& call : calls) execution_.nodes()[call.script].waits = false;
  std::size_t made = host_->make_calls(calls, [&](const ScriptCall& call, bool owes) {
    if (owes && call.interface != ScriptCall::kProcessed) owe_processed(call.script);
  });
  for (; made < calls.size(); ++made) keep(calls[made]);
  calls.clear();
  making_ = std::move(calls);
}

void ScriptQueue::keep(const ScriptCall& call) {
  if (call.interface == ScriptCall::kProcessed) return;
  ScriptState& state = execution_.states().scripts[execution_.nodes().state_of(call.script)];
  if (state.kept.size() >= ScriptState::kMaxKept || !execution_.budget().spend(ScriptState::kKeptCost)) return;
  state.kept.push_back({call.interface, call.value, call.time});
  execution_.timers().look_again(call.script);
}

void ScriptQueue::owe_processed(EventNode node) {
  execution_.states().scripts[execution_.nodes().state_of(node)].owes_processed = true;
  execution_.timers().look_again(node);
}

// ---- End of programs

void ScriptQueue::end(std::vector<EventNode> nodes) {
  flush();
  for (const EventNode node : nodes) {
    if (node == 0) continue;
    const Behaviour* const behaviour = execution_.nodes().schema_of(node).behaviour;
    if (behaviour && behaviour->before_removal) behaviour->before_removal(execution_, node);
  }
}

void ScriptQueue::program_came(const SceneGraph& scene, NodeId script) {
  const EventNode node = execution_.scenes().event_node(scene, script);
  if (node == 0 || !host_) return;
  execution_.timers().look_again(node);
  execution_.cascade().drain();
}

void ScriptQueue::forget_removed() {
  std::erase_if(new_, [&](EventNode node) { return execution_.nodes().is_removed(node); });
}

}  // namespace gs::vrml
