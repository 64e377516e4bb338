#include "vrml/events/change_list.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {

NodeChange& ChangeList::change_of(EventNode node) {
  EventMember& at = execution_.nodes()[node];
  if (at.change == 0) {
    changes_.push_back({at.scene, at.id, 0});
    changed_.push_back(node);
    at.change = static_cast<std::uint32_t>(changes_.size());
  }
  return changes_[at.change - 1];
}

void ChangeList::mark(EventNode node, std::int32_t slot) {
  constexpr int kLastBit = 63;
  const EventMember& at = execution_.nodes()[node];
  const FieldValue& value = at.node->values[slot];
  if (std::holds_alternative<MFNode>(value)) {
    execution_.placement().children_changed(*at.scene, at.id);
    execution_.pointing().note_children_changed();
  }
  execution_.shapes().note_change(at.node);
  const Behaviour* const behaviour = at.node->type->behaviour;
  if (behaviour && behaviour->parent_from_local) execution_.viewer().idle().node_moved(*at.node);
  if (holds_nodes(type_of(value))) execution_.lifetime().note_referring(node);
  change_of(node).slots |= std::uint64_t{1} << std::min(slot, kLastBit);
}

void ChangeList::mark_content(SceneGraph& scene, NodeId id) {
  execution_.placement().forget();
  execution_.pointing().forget();
  execution_.shapes().note_change(nullptr);
  constexpr std::uint64_t kNoField = std::uint64_t{1} << 63;
  if (const EventNode node = execution_.scenes().event_node(scene, id)) change_of(node).slots |= kNoField;
}

std::span<const NodeChange> ChangeList::take() {
  for (const EventNode node : changed_) execution_.nodes()[node].change = 0;
  changed_.clear();
  std::swap(changes_, taken_);
  changes_.clear();
  return taken_;
}

void ChangeList::forget_removed() {
  execution_.shapes().forget();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < changed_.size(); ++i) {
    if (execution_.nodes().is_removed(changed_[i])) continue;
    changed_[kept] = changed_[i];
    changes_[kept] = changes_[i];
    ++kept;
    execution_.nodes()[changed_[kept - 1]].change = static_cast<std::uint32_t>(kept);
  }
  changed_.resize(kept);
  changes_.resize(kept);
}

}  // namespace gs::vrml
