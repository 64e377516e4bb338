#include "vrml/scene/meant_node.h"

#include <string_view>

namespace gs::vrml {
namespace {

// Returns the value of a field that holds one node; null if the type has no such field.
NodeId node_in(const Node& node, std::string_view field) {
  const InterfaceDeclaration* declaration = node.type->find_field(field);
  const auto* value = declaration ? std::get_if<SFNode>(&node.values[declaration->slot]) : nullptr;
  return value ? *value : NodeId{};
}

// Returns a child of a grouping node; null if it has no such child.
NodeId child_of(const Node& node, std::string_view field, std::int64_t index) {
  const InterfaceDeclaration* declaration = node.type->find_field(field);
  const auto* children = declaration ? std::get_if<MFNode>(&node.values[declaration->slot]) : nullptr;
  return children && index >= 0 && index < static_cast<std::int64_t>(children->size())
             ? (*children)[static_cast<std::size_t>(index)]
             : NodeId{};
}

// Returns the node inside `id` in which to look for a node with the role.
NodeId inside(const SceneGraph& scene, NodeId id, Role wanted) {
  const Node& node = scene.node(id);
  switch (node.type->read_as) {
    case NodeKind::switch_node:
      return child_of(node, "choice", scene.get<SFInt32>(id, "whichChoice"));
    case NodeKind::group:
      return child_of(node, "children", 0);
    case NodeKind::shape:
      return node_in(node, has(wanted, Role::geometry) ? "geometry" : "appearance");
    case NodeKind::appearance:
      return node_in(node, has(wanted, Role::material)  ? "material"
                           : has(wanted, Role::texture) ? "texture"
                                                        : "textureTransform");
    default:
      return {};
  }
}

}  // namespace

NodeId meant_node(const SceneGraph& scene, NodeId id, Role wanted) {
  constexpr int kMaxSteps = 64;
  for (int step = 0; step < kMaxSteps; ++step) {
    id = scene.resolve(id);
    if (!id || has(scene.node(id).type->role, wanted)) return id;
    id = inside(scene, id, wanted);
  }
  return {};
}

ShapeParts parts_of_appearance(const SceneGraph& scene, NodeId given) {
  ShapeParts parts;
  parts.appearance = meant_node(scene, given, Role::appearance);
  const NodeId from = parts.appearance ? parts.appearance : given;
  parts.material = meant_node(scene, from, Role::material);
  parts.texture = meant_node(scene, from, Role::texture);
  parts.texture_transform = meant_node(scene, from, Role::texture_transform);
  return parts;
}

}  // namespace gs::vrml
