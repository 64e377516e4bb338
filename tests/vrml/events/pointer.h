#pragma once

#include "tests/vrml/events/trace.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::traces {

/// Finds the path from the root to the first instance of the node, through all children, PROTO instances and Inlines.
inline bool find_path(const SceneGraph& scene, const MFNode& children, NodeId wanted, const SceneGraph& of,
                      const glm::dmat4& place, std::vector<PathStep>& path) {
  for (const NodeId child : children) {
    const NodeId id = scene.resolve(child);
    if (!id) continue;
    const std::size_t before = path.size();
    if (id != child) path.push_back({&scene, child, place});
    path.push_back({&scene, id, place});
    if (&scene == &of && id == of.resolve(wanted)) return true;
    const Node& node = scene.node(id);
    glm::dmat4 inside = place;
    if (node.type->behaviour && node.type->behaviour->parent_from_local && has(node.type->role, Role::grouping))
      inside *= node.type->behaviour->parent_from_local(scene, node);
    if (const SceneGraph* inlined = scene.inlines().of(id))
      if (find_path(*inlined, inlined->roots(), wanted, of, inside, path)) return true;
    for (std::size_t slot = 0; has(node.type->role, Role::grouping) && slot < node.type->defaults.size(); ++slot)
      if (const auto* below = std::get_if<MFNode>(&node.values[slot]))
        if (find_path(scene, *below, wanted, of, inside, path)) return true;
    path.resize(before);
  }
  return false;
}

/// Pointing device that looks along -z from z = 10 at geometry in the world's plane z = 0.
class PointingDevice {
 public:
  explicit PointingDevice(World& world) : world_(world) {}

  /// Points over a Shape of the root (or of another scene) at x, y. "" points over nothing.
  void at(std::string_view shape, double x, double y) { at(shape, glm::dvec3(x, y, 0), {0, 0, -1}); }
  void at(std::string_view shape, const glm::dvec3& point, const glm::dvec3& direction) {
    pointer_.bearing = {point - direction * 10.0, direction, point, {0, 0, 2}, {0.25, 0.5}};
    path_.clear();
    if (!shape.empty()) {
      const SceneGraph& scene = world_.scene();
      REQUIRE(find_path(scene, scene.roots(), world_.node(shape), scene, glm::dmat4(1), path_));
    }
  }
  void over(const SceneGraph& scene, NodeId shape) {
    path_.clear();
    REQUIRE(find_path(world_.scene(), world_.scene().roots(), shape, scene, glm::dmat4(1), path_));
  }
  [[nodiscard]] std::vector<PathStep>& path() { return path_; }
  [[nodiscard]] Bearing& bearing() { return pointer_.bearing; }

  void tell() {
    pointer_.path = path_;
    world_.execution().pointing().point(pointer_);
  }
  void move(std::string_view shape, double x, double y) {
    at(shape, x, y);
    tell();
  }
  void press() { set(true); }
  void release() { set(false); }
  void set(bool down) {
    pointer_.down = down;
    tell();
  }
  void press(std::string_view shape, double x, double y) {
    at(shape, x, y);
    press();
  }
  void release(std::string_view shape, double x, double y) {
    at(shape, x, y);
    release();
  }

 private:
  World& world_;
  Pointer pointer_;
  std::vector<PathStep> path_;
};

}  // namespace gs::vrml::traces
