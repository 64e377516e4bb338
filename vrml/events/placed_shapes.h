#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/mesh/mesh.h"
#include "vrml/scene/scene_graph.h"

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Node of the transformation hierarchy at one instance: a grouping node, a Shape or a sensor.
struct PlacedNode {
  const SceneGraph* scene = nullptr;
  NodeId node;
  std::uint32_t parent = 0;             // index of the grouping node above; the node itself at the top
  glm::dmat4 world_from_parent{1.0};    // coordinate system of the node
  glm::dmat4 world_from_inside{1.0};    // coordinate system of the children
  bool shape = false, pickable = true;  // pickable: no PickableGroup above forbids it
  std::uint32_t types = 0;              // index of the PickableGroup with the object types; 0 means none
};

/// Shapes of a world with their positions, for sensors of moving objects (X3D 22.4.2, clause 38). Visits the whole
/// hierarchy, up to kMaxNodes, only after changes and only if the world has such a sensor. Part of Execution.
class PlacedShapes {
 public:
  static constexpr std::size_t kMaxNodes = std::size_t{1} << 16;

  explicit PlacedShapes(Execution& execution) : execution_(execution) {}

  /// Adds a sensor. Its behaviour's on_time is called in the step after each change of positions or geometries.
  void add(EventNode sensor);
  void remove(EventNode sensor);
  /// Reports that a field of a node has changed, or the content of the world if `node` is null.
  void note_change(const Node* node);
  /// Discards everything that refers to nodes, because a node is removed.
  void forget();

  /// Returns all nodes in the order of the hierarchy. The first one is no node. Valid until the next change.
  [[nodiscard]] std::span<const PlacedNode> nodes();
  /// Reports whether the node at an index is `of`, or is below it.
  [[nodiscard]] bool is_below(std::size_t index, const SceneGraph& scene, NodeId of) const;
  /// Returns the index of the first instance of a node; 0 if there is none.
  [[nodiscard]] std::size_t find(const SceneGraph& scene, NodeId node);
  /// Returns the mesh of a geometry; empty if there is none.
  [[nodiscard]] std::shared_ptr<const Mesh> mesh_of(const SceneGraph& scene, NodeId geometry);

 private:
  void forget_meshes(const Node* changed);
  void collect();
  void visit(const SceneGraph& scene, const MFNode& children, std::uint32_t parent, const glm::dmat4& world, int depth);
  void visit_node(const SceneGraph& scene, NodeId id, std::uint32_t parent, const glm::dmat4& world, int depth);

  Execution& execution_;
  std::vector<EventNode> sensors_;
  std::vector<PlacedNode> nodes_;
  struct Made {
    const SceneGraph* scene = nullptr;  // scene of the geometry
    std::shared_ptr<const Mesh> mesh;
  };
  std::unordered_map<const Node*, Made> meshes_;  // by geometry
  std::size_t mesh_bytes_ = 0;
  bool known_ = false;    // nodes_ is up to date
  bool alarmed_ = false;  // the sensors are called in the next step
};

/// Returns the geometry of a Shape; null if it has none.
[[nodiscard]] NodeId geometry_in(const SceneGraph& scene, NodeId shape);

}  // namespace gs::vrml
