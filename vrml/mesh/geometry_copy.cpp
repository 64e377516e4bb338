#include "vrml/mesh/geometry_copy.h"

#include <span>
#include <utility>
#include <variant>

namespace gs::vrml {
namespace {

std::size_t elements_of(const Node& node) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i) sum += element_count(node.values[i]);
  return sum;
}

/// Copies a node, and the nodes in its fields, `depth` levels deep. Meshes depend on no other nodes.
NodeId copy_node(const SceneGraph& from, NodeId id, SceneGraph& to, int depth) {
  const Node& node = from.node(id);
  const NodeId copy = to.create(*node.type, node.location);
  if (!copy) return {};
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
    FieldValue& value = to.node(copy).values[i];
    const auto* part = std::get_if<SFNode>(&node.values[i]);
    const auto* parts = std::get_if<MFNode>(&node.values[i]);
    if (!part && !parts) {
      value = node.values[i];
      continue;
    }
    value = part ? FieldValue(SFNode{}) : FieldValue(MFNode{});
    MFNode copies;
    for (const NodeId one : part ? std::span<const NodeId>(part, 1) : parts->span()) {
      const NodeId resolved = depth > 0 ? from.resolve(one) : NodeId{};
      if (!resolved) continue;
      const NodeId copied = copy_node(from, resolved, to, depth - 1);
      if (!copied) return {};
      copies.push_back(copied);
    }
    if (copies.empty()) continue;
    to.node(copy).values[i] = part ? FieldValue(copies[0]) : FieldValue(std::move(copies));
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
  constexpr int kDepth = 2;  // coordinates in a MultiTextureCoordinate
  copy.geometry = copy_node(scene, resolved, *made, kDepth);
  if (refiner) copy.refiner = copy_node(scene, refiner, *made, kDepth);
  if (copy.geometry && (copy.refiner || !refiner)) copy.scene = std::move(made);
  return copy;
}

}  // namespace gs::vrml
