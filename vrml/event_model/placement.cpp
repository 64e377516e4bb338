#include "vrml/event_model/placement.h"

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>

#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kMaxChanges = 4096;  // number of changed or moved nodes above which a list does not pay

}  // namespace

void Placement::forget() {
  known_ = false;
  changed_.clear();
  moved_.tops.clear();
  moved_.all = true;
}

void Placement::children_changed(const SceneGraph& scene, NodeId node) {
  if (!known_) return;
  if (!changed_.empty() && changed_.back().scene == &scene && changed_.back().node == node) return;
  if (changed_.size() >= kMaxChanges) return forget();
  changed_.push_back({&scene, node});
}

void Placement::remove(const SceneGraph& scene, NodeId node) {
  paths_.erase(&scene.node(node));
  if (!known_ || !index_.remove(scene, node)) return;
  ++version_;
  moved_.all = true;
}

Placement::Moved Placement::take_moved() {
  refresh();
  return std::exchange(moved_, {});
}

void Placement::refresh() {
  if (!known_) {
    known_ = true;
    ++version_;
    index_.build();
    return;
  }
  if (changed_.empty()) return;
  for (const NodePlace& place : changed_)
    if (place.scene->contains(place.node) && index_.update(*place.scene, place.node, moved_.tops)) ++version_;
  changed_.clear();
  if (moved_.tops.size() <= kMaxChanges) return;
  moved_.tops.clear();
  moved_.all = true;
}

std::span<const Placement::Path> Placement::paths_of(const SceneGraph& scene, NodeId node) {
  refresh();
  Paths& known = paths_[&scene.node(node)];
  if (std::exchange(known.version, version_) != version_)
    known.whole = index_.find_paths(scene, node, kMaxPlaces, known.paths);
  whole_ = known.whole;
  return known.paths;
}

std::span<const glm::dmat4> Placement::places_of(const SceneGraph& scene, NodeId node,
                                                 const std::optional<glm::dmat4>& viewer) {
  places_.clear();
  below_billboard_ = false;
  for (const Path& path : paths_of(scene, node)) {
    glm::dmat4 matrix(1);
    for (const NodePlace& mover : path) {
      const Node& moving = mover.scene->node(mover.node);
      const Behaviour& behaviour = *moving.type->behaviour;
      if (behaviour.parent_from_local) {
        matrix *= behaviour.parent_from_local(*mover.scene, moving);
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
