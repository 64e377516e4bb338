#include "vrml/x3d/node_place.h"

#include "vrml/scene/prototype.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <string>
#include <utility>

namespace gs::vrml::x3d {
namespace {

// Returns the type of the first node in the body of a PROTO, through nested PROTOs.
const NodeType& first_type(const NodeType& type) {
  const NodeType* found = &type;
  while (found->prototype) {
    const Prototype& prototype = *found->prototype;
    const NodeType* first = nullptr;
    for (const Statement& statement : prototype.statements) {
      if (statement.kind != Statement::Kind::node) continue;
      first = prototype.scene->node(statement.node).type;
      break;
    }
    if (!first || first == found) break;
    found = first;
  }
  return *found;
}

// Returns the default field for types of VRML97 that X3D lacks.
std::string_view container_of_role(const NodeType& type) {
  static constexpr std::pair<Role, std::string_view> kFields[] = {
      {Role::geometry, "geometry"},   {Role::appearance, "appearance"}, {Role::material, "material"},
      {Role::texture, "texture"},     {Role::font_style, "fontStyle"},  {Role::texture_transform, "textureTransform"},
      {Role::sound_source, "source"}, {Role::child, "children"}};
  for (const auto& [role, field] : kFields)
    if (has(type.role, role)) return field;
  return {};
}

const InterfaceDeclaration* node_field(const NodeType& type, std::string_view name) {
  const InterfaceDeclaration* const field = name.empty() ? nullptr : type.find_field(name);
  return field && holds_nodes(field->type) ? field : nullptr;
}

bool takes(const InterfaceDeclaration& field, const NodeType* type) { return !type || accepts(field, *type); }

// Returns the only field that is declared for nodes of the type; null if there are several.
const InterfaceDeclaration* only_field(const NodeType& parent, const NodeType& type) {
  const InterfaceDeclaration* only = nullptr;
  for (const InterfaceDeclaration& field : parent.interfaces) {
    if (field.slot < 0 || !holds_nodes(field.type) || field.range.empty() || !accepts(field, type)) continue;
    if (only) return nullptr;
    only = &field;
  }
  return only;
}

}  // namespace

std::string_view default_container(const NodeType& type) {
  const NodeType& first = first_type(type);
  return first.container_field.empty() ? container_of_role(first) : std::string_view(first.container_field);
}

const InterfaceDeclaration* place_of(const NodeType& parent, const NodeType* type, std::string_view container) {
  if (type) type = &first_type(*type);
  const InterfaceDeclaration* given = node_field(parent, container);
  // X3D 4 has renamed the six textures of ComposedCubeMapTexture.
  if (!given && !container.empty()) given = node_field(parent, std::string(container) + "Texture");
  if (given && takes(*given, type)) return given;
  const InterfaceDeclaration* const usual = type ? node_field(parent, default_container(*type)) : nullptr;
  if (usual && takes(*usual, type)) return usual;
  if (type && type->language == Language::x3d) {
    if (const InterfaceDeclaration* const only = only_field(parent, *type)) return only;
    if (type->bases.find("X3DMetadataObject") != std::string::npos) return node_field(parent, "metadata");
  }
  return given ? given : usual ? usual : node_field(parent, "children");
}

const InterfaceDeclaration* RecentPlaces::find(const NodeType& parent, const NodeType* type,
                                               std::string_view container) {
  constexpr std::size_t kMaxContainer = 32;
  if (!type || container.size() > kMaxContainer || type->kind != NodeType::Kind::built_in ||
      parent.kind != NodeType::Kind::built_in || parent.is_programmable)
    return place_of(parent, type, container);
  const auto key = reinterpret_cast<std::uintptr_t>(&parent) * 31 + reinterpret_cast<std::uintptr_t>(type);
  Place& place = places_[((key ^ key >> 9) / alignof(NodeType) + container.size()) % places_.size()];
  if (place.parent != &parent || place.type != type || place.container != container)
    place = {&parent, type, std::string(container), place_of(parent, type, container)};
  return place.field;
}

}  // namespace gs::vrml::x3d
