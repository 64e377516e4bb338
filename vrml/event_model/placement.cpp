#include "vrml/event_model/placement.h"

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/transformation.h"

#include <glm/glm.hpp>

namespace gs::vrml {
namespace {

constexpr std::size_t kDeepest = 100'000;

}  // namespace

// Searches all children, even hidden ones: hidden children of a Switch or LOD continue to send events (6.26, 6.46).
void Placement::search() {
  known_ = true;
  for (auto& [node, paths] : paths_) paths.clear();
  struct Open {
    const SceneGraph* scene;
    std::vector<bool>* on_path;
    NodeId node;        // open node; null for the roots of a scene
    int slot;           // slot of its children field
    std::size_t child;  // index of the next child
    bool mover;
  };
  std::unordered_map<const SceneGraph*, std::vector<bool>> on_paths;
  const auto on_path_of = [&](const SceneGraph& scene) {
    std::vector<bool>& flags = on_paths[&scene];
    flags.resize(scene.nodes().count() + 1);
    return &flags;
  };
  Path movers;
  std::vector<Open> path{{&root_, on_path_of(root_), {}, 0, 0, false}};
  std::size_t visits = 0;
  while (!path.empty() && visits <= root_.limits().visits) {
    Open& top = path.back();
    const MFNode* children = nullptr;
    if (!top.node) {
      children = top.slot == 0 ? &top.scene->roots() : nullptr;
    } else {
      const Node& node = top.scene->node(top.node);
      const auto slots = static_cast<int>(node.type->defaults.size());
      while (top.slot < slots && !std::holds_alternative<MFNode>(node.values[top.slot])) ++top.slot;
      if (top.slot < slots) children = std::get_if<MFNode>(&node.values[top.slot]);
    }
    if (!children) {
      if (top.node) (*top.on_path)[top.node.index] = false;
      if (top.mover) movers.pop_back();
      path.pop_back();
      continue;
    }
    if (top.child >= children->size()) {
      ++top.slot;
      top.child = 0;
      continue;
    }
    ++visits;
    const SceneGraph& scene = *top.scene;
    const NodeId id = scene.resolve((*children)[top.child++]);
    if (!id || (*top.on_path)[id.index] || path.size() >= kDeepest) continue;
    const Node& node = scene.node(id);
    if (const auto wanted = paths_.find(&node); wanted != paths_.end() && wanted->second.size() < kMaxPlaces)
      wanted->second.push_back(movers);
    if (!has(node.type->role, Role::grouping)) continue;
    const Behaviour* behaviour = node.type->behaviour;
    const bool mover = behaviour && (behaviour->parent_from_local || behaviour->parent_from_facing);
    if (mover) movers.push_back({&scene, id});
    std::vector<bool>* const on_path = top.on_path;
    (*on_path)[id.index] = true;
    path.push_back({&scene, on_path, id, 0, 0, mover});
    if (const SceneGraph* inlined = scene.inlines().of(id))
      path.push_back({inlined, on_path_of(*inlined), {}, 0, 0, false});
  }
  visits_ = visits;
  whole_ = path.empty();
}

std::span<const glm::dmat4> Placement::places_of(const SceneGraph& scene, NodeId node,
                                                 const std::optional<glm::dmat4>& viewer) {
  const auto [paths, fresh] = paths_.try_emplace(&scene.node(node));
  if (fresh || !known_) search();
  places_.clear();
  below_billboard_ = false;
  for (const Path& path : paths->second) {
    glm::dmat4 matrix(1);
    for (const NodePlace& mover : path) {
      const Node& moving = mover.scene->node(mover.node);
      const Behaviour& behaviour = *moving.type->behaviour;
      if (behaviour.parent_from_local) {
        matrix *= behaviour.parent_from_local(moving);
        continue;
      }
      below_billboard_ = true;
      if (viewer)
        matrix *= behaviour.parent_from_facing(moving, viewer_in_local(glm::dvec3((*viewer)[3]), matrix),
                                               direction_in_local(glm::dvec3((*viewer)[1]), matrix));
    }
    places_.push_back(matrix);
  }
  return places_;
}

}  // namespace gs::vrml
