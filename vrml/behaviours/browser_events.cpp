#include "vrml/behaviours/browser_events.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <cmath>

namespace gs::vrml {

bool collide(Execution& execution, std::span<const PathStep> path, Meeting meeting) {
  for (const Meeting met : {Meeting::none, meeting}) {
    for (const PathStep& step : path) {
      const bool known = step.scene && step.scene->contains(step.node);
      const Behaviour* behaviour = known ? step.scene->node(step.node).type->behaviour : nullptr;
      if (!behaviour || !behaviour->on_collision) continue;
      const EventNode node = execution.scenes().event_node(*step.scene, step.node);
      if (node != 0 && !behaviour->on_collision(execution, node, met)) return false;
    }
  }
  execution.cascade().drain();
  return true;
}

void report_transition(Execution& execution) {
  const EventNode node = execution.stacks().top_of(built_in_node_type(NodeKind::navigation_info));
  if (node == 0) return;
  execution.send(node, kTransitionComplete, SFBool{true});
  execution.cascade().drain();
}

bool report_progress(Execution& execution, const SceneGraph& scene, NodeId id, double fraction) {
  constexpr float kMinStep = 0.00999f;  // 1/100, minus a margin for rounding
  if (std::isnan(fraction) || !scene.contains(id)) return true;
  const NodeType& type = *scene.node(id).type;
  const InterfaceDeclaration* progress = type.find("progress_changed");
  const InterfaceDeclaration* load_time = type.find("loadTime");
  const auto is = [](const InterfaceDeclaration* event, FieldType of) {
    return event && event->access == AccessType::eventOut && event->type == of;
  };
  const bool tells = is(progress, FieldType::SFFloat), tells_time = is(load_time, FieldType::SFTime);
  const EventNode node = tells || tells_time ? execution.scenes().event_node(scene, id) : 0;
  if (node == 0) return true;
  EventNodes& nodes = execution.nodes();
  EventCascade& cascade = execution.cascade();
  const auto value = static_cast<float>(std::clamp(fraction, 0.0, 1.0));
  bool all = true;
  if (tells) {
    const std::uint32_t place = nodes.schema_of(node).find(*progress);
    auto& last = std::get<SFFloat>(nodes.own_value(node, place));
    if (std::abs(value - last) >= kMinStep || (value == 1 && last != 1)) {
      if (!cascade.has_sent_own(node, place)) {
        last = value;
        cascade.queue(node, place);
      } else {
        all = false;
      }
    }
  }
  std::uint32_t& complete = nodes.state_of(node);
  if (value == 0) complete = 0;
  if (tells_time && value == 1 && complete == 0) {
    const std::uint32_t place = nodes.schema_of(node).find(*load_time);
    if (all && !cascade.has_sent_own(node, place)) {
      std::get<SFTime>(nodes.own_value(node, place)) = execution.now();
      complete = 1;
      cascade.queue(node, place);
    } else {
      all = false;
    }
  }
  cascade.drain();
  return all;
}

bool report_media(Execution& execution, const SceneGraph& scene, NodeId id, double duration) {
  const EventNode node = execution.scenes().event_node(scene, id);
  const Behaviour* const behaviour = node == 0 ? nullptr : execution.nodes().schema_of(node).behaviour;
  if (!behaviour || !behaviour->media_came) return true;
  const bool sent = behaviour->media_came(execution, node, duration);
  execution.cascade().drain();
  return sent;
}

std::optional<MediaPlay> media_play(Execution& execution, const SceneGraph& scene, NodeId id) {
  const EventNode node = execution.scenes().event_node(scene, id);
  const Behaviour* const behaviour = node == 0 ? nullptr : execution.nodes().schema_of(node).behaviour;
  if (!behaviour || !behaviour->media_play) return std::nullopt;
  return behaviour->media_play(execution, node);
}

}  // namespace gs::vrml
