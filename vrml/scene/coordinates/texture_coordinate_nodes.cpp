#include "vrml/scene/coordinates/texture_coordinate_nodes.h"

#include "vrml/scene/meant_node.h"

namespace gs::vrml {

std::vector<NodeId> texture_coordinate_nodes(const SceneGraph& scene, NodeId geometry) {
  constexpr std::size_t kMaxNodes = 64;
  std::vector<NodeId> nodes;
  geometry = scene.resolve(geometry);
  if (!geometry) return nodes;
  const Node& node = scene.node(geometry);
  const InterfaceDeclaration* const field = node.type->find_field("texCoord");
  const auto* const given = field ? std::get_if<SFNode>(&node.values[field->slot]) : nullptr;
  const NodeId id = given ? meant_node(scene, *given, Role::geometric_property) : NodeId{};
  if (!id) return nodes;
  if (scene.node(id).type->read_as != NodeKind::multi_texture_coordinate) return {id};
  for (const NodeId one : scene.get<MFNode>(id, "texCoord")) {
    const NodeId meant = meant_node(scene, one, Role::geometric_property);
    if (meant && nodes.size() < kMaxNodes) nodes.push_back(meant);
  }
  return nodes;
}

}  // namespace gs::vrml
