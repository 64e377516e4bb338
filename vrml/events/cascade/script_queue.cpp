#include "vrml/events/script_queue.h"

#include "vrml/events/execution.h"

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
  std::size_t begun = 0;
  for (; begun < new_.size() && (starting_ || execution_.budget().has_room_for(kBegin)); ++begun) {
    if (!starting_) (void)execution_.budget().spend(kBegin);
    const EventNode node = new_[begun];
    (void)host_->begin(node);
    if (!starting_) execution_.timers().look_again(node);  // delivers the events that were queued before
  }
  new_.erase(new_.begin(), new_.begin() + static_cast<std::ptrdiff_t>(begun));
}

void ScriptQueue::end(std::vector<EventNode> nodes) {
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
