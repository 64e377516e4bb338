#include "vrml/mesh/geometry_copy.h"

#include <variant>

namespace gs::vrml {
namespace {

std::size_t elements_of(const Node& node) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i) sum += element_count(node.values[i]);
  return sum;
}

/// Copies a node, and the nodes in its SFNode fields. Meshes depend on no other nodes.
NodeId copy_node(const SceneGraph& from, NodeId id, SceneGraph& to, bool with_parts) {
  const Node& node = from.node(id);
  const NodeId copy = to.create(*node.type, node.location);
  if (!copy) return {};
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
    FieldValue& value = to.node(copy).values[i];
    const auto* part = std::get_if<SFNode>(&node.values[i]);
    if (!part && !std::holds_alternative<MFNode>(node.values[i])) value = node.values[i];
    if (!part) continue;
    const NodeId resolved = with_parts ? from.resolve(*part) : NodeId{};
    value = SFNode{};
    if (!resolved) continue;
    const NodeId copied = copy_node(from, resolved, to, false);
    if (!copied) return {};
    to.node(copy).values[i] = copied;
  }
  return copy;
}

}  // namespace

std::size_t tessellation_cost(const SceneGraph& scene, NodeId geometry) {
  const NodeId id = scene.resolve(geometry);
  if (!id || !scene.node(id).type->tessellator.tessellate) return 0;
  const Node& node = scene.node(id);
  if (node.type->tessellator.cost) return node.type->tessellator.cost(scene, id);
  std::size_t sum = elements_of(node);
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i)
    if (const auto* part = std::get_if<SFNode>(&node.values[i]))
      if (const NodeId resolved = scene.resolve(*part)) sum += elements_of(scene.node(resolved));
  return sum;
}

GeometryCopy copy_geometry(const SceneGraph& scene, NodeId geometry, NodeId refiner) {
  GeometryCopy copy;
  const NodeId resolved = scene.resolve(geometry);
  if (!resolved) return copy;
  auto made = std::make_unique<SceneGraph>(scene.file_name(), scene.budget());
  copy.geometry = copy_node(scene, resolved, *made, true);
  if (refiner) copy.refiner = copy_node(scene, refiner, *made, true);
  if (copy.geometry && (copy.refiner || !refiner)) copy.scene = std::move(made);
  return copy;
}

}  // namespace gs::vrml
