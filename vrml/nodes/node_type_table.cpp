#include "vrml/nodes/families.h"
#include "vrml/nodes/vrml97_equivalents.h"
#include "vrml/nodes/x3d/components.h"
#include "vrml/scene/imported_use.h"
#include "vrml/scene/node_type.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <cassert>
#include <initializer_list>
#include <map>
#include <string>
#include <unordered_map>

namespace gs::vrml {
namespace {

// Reads the range of a field from the comment after its declaration, in the notation of the standard.
void read_ranges(std::string_view text, NodeType& type) {
  std::size_t declaration = 0;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    const std::size_t comment = line.find("# ");
    if (comment != std::string_view::npos) type.interfaces[declaration].range = line.substr(comment + 2);
    ++declaration;
  }
  if (!has(type.role, Role::geometry)) return;
  for (const InterfaceDeclaration& declared : type.interfaces) {
    const bool length = declared.type == FieldType::SFFloat || declared.type == FieldType::SFVec3f;
    if (declared.access == AccessType::field && length && declared.range == "(0,inf)")
      type.measures.push_back(declared.slot);
  }
}

std::unique_ptr<NodeType> type_of_row(const NodeRow& row) {
  auto type = std::make_unique<NodeType>();
  type->name = row.name;
  type->clause = row.clause;
  type->role = row.role;
  type->read_as = row.read_as;
  type->tessellator = row.tessellator;
  type->behaviour = row.behaviour;
  type->url_content = row.url_content;
  const bool good = parse_interface(row.interface_text, *type);
  assert(good && "a row of the node table does not parse");
  (void)good;
  if (has(row.role, Role::script)) type->kind = NodeType::Kind::script;
  type->is_programmable = type->kind == NodeType::Kind::script;
  read_ranges(row.interface_text, *type);
  const std::size_t standard = type->interfaces.size();
  const bool good_events = parse_interface(row.other_events, *type);
  assert(good_events && "other events of a row do not parse");
  (void)good_events;
  for (std::size_t i = standard; i < type->interfaces.size(); ++i) type->interfaces[i].of_other_browsers = true;
  return type;
}

/// Interface that has another name in X3D 4 than in VRML97 or X3D 3.
struct Renamed {
  std::string_view node, name, x3d_name;  // x3d_name: the other name
};
constexpr Renamed kRenamed[] = {
    {"Collision", "collide", "enabled"},
    {"ComposedCubeMapTexture", "back", "backTexture"},
    {"ComposedCubeMapTexture", "bottom", "bottomTexture"},
    {"ComposedCubeMapTexture", "front", "frontTexture"},
    {"ComposedCubeMapTexture", "left", "leftTexture"},
    {"ComposedCubeMapTexture", "right", "rightTexture"},
    {"ComposedCubeMapTexture", "top", "topTexture"},
    {"LOD", "level", "children"},
    {"Layer", "isPickable", "pickable"},
    {"LayoutLayer", "isPickable", "pickable"},
    {"LoadSensor", "watchList", "children"},
    {"ParticleSystem", "colorRamp", "color"},
    {"ParticleSystem", "texCoordRamp", "texCoord"},
    {"Switch", "choice", "children"},
};

/// Interface that has another name in X3D 3 than in X3D 4.
constexpr Renamed kFormerNames[] = {
    {"ParticleSystem", "color", "colorRamp"},
    {"ParticleSystem", "texCoord", "texCoordRamp"},
};

void rename_interfaces(NodeType& type) {
  for (const Renamed& renamed : kRenamed)
    if (renamed.node == type.name)
      for (InterfaceDeclaration& each : type.interfaces)
        if (each.name == renamed.name) each.x3d_name = renamed.x3d_name;
  for (const Renamed& renamed : kFormerNames)
    if (renamed.node == type.name)
      for (InterfaceDeclaration& each : type.interfaces)
        if (each.name == renamed.name) each.former_name = renamed.x3d_name;
}

/// Field of a grouping node with nodes that stand elsewhere in the hierarchy, or outside of it.
struct ListField {
  std::string_view node, field;
};
constexpr ListField kListFields[] = {{"HAnimHumanoid", "joints"},     {"HAnimHumanoid", "motions"},
                                     {"HAnimHumanoid", "segments"},   {"HAnimHumanoid", "sites"},
                                     {"HAnimHumanoid", "viewpoints"}, {"HAnimJoint", "displacers"},
                                     {"HAnimSegment", "displacers"}};

// Adds an interface of X3D to a type that may have it from VRML97. Of two access types, the one that allows more wins.
void add_x3d_interface(NodeType& type, const InterfaceDeclaration& added) {
  const auto own = std::find_if(type.interfaces.begin(), type.interfaces.end(), [&](const InterfaceDeclaration& each) {
    return each.name == added.name || each.x3d_name == added.name;
  });
  if (own == type.interfaces.end()) {
    type.declare(added);
    type.interfaces.back().range = added.range;
    return;
  }
  assert(own->type == added.type && "X3D and VRML97 give one interface different types");
  if (added.slot < 0) return;
  if (added.access == AccessType::exposedField) own->access = added.access;
  own->initial = type.defaults[static_cast<std::size_t>(own->slot)] = added.initial;
  if (!added.range.empty()) own->range = added.range;
}

std::unique_ptr<NodeType> type_of_x3d_row(const X3DRow& row, const NodeRow* vrml97) {
  NodeRow columns{row.name, "", row.role, row.read_as, vrml97 ? vrml97->interface_text : ""};
  columns.tessellator = row.tessellator;
  columns.behaviour = row.behaviour;
  columns.url_content = row.url_content;
  if (vrml97) {
    columns.clause = vrml97->clause;
    columns.role = columns.role | vrml97->role;
    if (columns.read_as == NodeKind::other) columns.read_as = vrml97->read_as;
    if (!columns.tessellator.tessellate) columns.tessellator = vrml97->tessellator;
    if (!columns.behaviour) columns.behaviour = vrml97->behaviour;
    if (columns.url_content == UrlContent::none) columns.url_content = vrml97->url_content;
  }
  auto type = type_of_row(columns);
  type->language = Language::x3d;
  type->component = row.component;
  type->level = row.level;
  type->container_field = row.container_field;
  type->bases = row.bases;
  type->is_programmable |= type->bases.find("X3DProgrammableShaderObject") != std::string::npos;
  type->ignored = row.ignored;
  rename_interfaces(*type);
  NodeType own;
  const bool good =
      parse_interface(row.interface_text, own) && parse_interface("exposedField SFNode metadata NULL", own);
  assert(good && "a row of the X3D node table does not parse");
  (void)good;
  read_ranges(row.interface_text, own);
  for (const InterfaceDeclaration& each : own.interfaces) add_x3d_interface(*type, each);
  for (const ListField& list : kListFields)
    if (list.node == row.name)
      for (InterfaceDeclaration& each : type->interfaces)
        if (each.name == list.field) each.lists = true;
  rename_interfaces(*type);
  type->equivalent = vrml97_equivalent(*type);
  return type;
}

// Returns the row of the VRML97 node that an X3D node of this name extends. Amendment 1 and X3D give some nodes of one
// name different interfaces.
const NodeRow* extended_row(std::string_view name) {
  for (const auto rows : {appearance_rows, bindables_rows, common_rows, geometric_properties_rows, geometry_rows,
                          grouping_rows, interpolators_rows, lights_rows, sensors_rows})
    for (const NodeRow& row : rows())
      if (row.name == name) return is_extension(row.clause) ? nullptr : &row;
  return nullptr;
}

/// Function that returns the rows of one file in x3d/.
using X3DRows = std::span<const X3DRow> (*)();
std::initializer_list<X3DRows> x3d_rows() {
  static constexpr std::initializer_list<X3DRows> kRows = {x3d_animation_rows,
                                                           x3d_cad_rows,
                                                           x3d_core_rows,
                                                           x3d_dis_rows,
                                                           x3d_environment_rows,
                                                           x3d_geometry_rows,
                                                           x3d_geospatial_rows,
                                                           x3d_h_anim_rows,
                                                           x3d_navigation_rows,
                                                           x3d_nurbs_rows,
                                                           x3d_particle_systems_rows,
                                                           x3d_rendering_rows,
                                                           x3d_rigid_body_rows,
                                                           x3d_sensors_rows,
                                                           x3d_shaders_rows,
                                                           x3d_shape_rows,
                                                           x3d_sound_rows,
                                                           x3d_sound_processing_rows,
                                                           x3d_texturing_rows,
                                                           x3d_volume_rendering_rows};
  return kRows;
}

struct Table {
  std::vector<std::unique_ptr<NodeType>> types;
  std::unordered_map<std::string_view, const NodeType*> by_name;
  std::map<NodeKind, const NodeType*> by_kind;

  explicit Table(Language language) {
    language == Language::x3d ? add_x3d_types() : add_vrml97_types();
    std::sort(types.begin(), types.end(), [](const auto& a, const auto& b) { return a->name < b->name; });
    for (const auto& type : types) {
      by_name[type->name] = type.get();
      by_kind.emplace(type->read_as, type.get());
    }
  }

 private:
  void add_vrml97_types() {
    for (const auto rows : {appearance_rows, bindables_rows, common_rows, geometric_properties_rows, geometry_rows,
                            grouping_rows, interpolators_rows, lights_rows, sensors_rows})
      for (const NodeRow& row : rows()) types.push_back(type_of_row(row));
  }
  void add_x3d_types() {
    for (const auto rows : x3d_rows())
      for (const X3DRow& row : rows()) types.push_back(type_of_x3d_row(row, extended_row(row.name)));
  }
};

const Table& table(Language language = Language::vrml97) {
  static const Table vrml97(Language::vrml97);
  if (language == Language::vrml97) return vrml97;
  static const Table x3d(Language::x3d);
  return x3d;
}

}  // namespace

std::span<const std::unique_ptr<NodeType>> built_in_node_types(Language language) { return table(language).types; }

const NodeType& browser_node_type() {
  static const std::unique_ptr<NodeType> the_type = type_of_row(browser_rows()[0]);
  return *the_type;
}

const NodeType& browser_event_type() {
  static const std::unique_ptr<NodeType> the_type = type_of_row(browser_rows()[1]);
  return *the_type;
}

const NodeType& imported_use_type() {
  static const std::unique_ptr<NodeType> the_type = [] {
    auto type = type_of_row(browser_rows()[2]);
    type->language = Language::x3d;
    type->component = "Networking";
    type->level = 3;
    return type;
  }();
  return *the_type;
}

const NodeType& imported_use_element() { return *built_in_node_type("Group"); }

const NodeType* stood_for(const NodeType& prototype) {
  const NodeType* native = built_in_node_type(prototype.name);
  if (!native || !is_extension(native->clause) || native->url_content == UrlContent::vectors) return nullptr;
  const bool same = std::all_of(prototype.interfaces.begin(), prototype.interfaces.end(), [&](const auto& declaration) {
    const InterfaceDeclaration* own = native->find(declaration.name);
    return own && own->type == declaration.type && own->access == declaration.access;
  });
  return same ? native : nullptr;
}

const NodeType* built_in_node_type(std::string_view name) {
  const auto found = table().by_name.find(name);
  return found == table().by_name.end() ? nullptr : found->second;
}

const NodeType* built_in_node_type(Language language, std::string_view name) {
  if (language == Language::vrml97) return built_in_node_type(name);
  const auto& names = table(language).by_name;
  const auto found = names.find(name);
  return found == names.end() ? built_in_node_type(name) : found->second;
}

const NodeType* former_x3d_type(std::string_view name) {
  static const std::vector<std::unique_ptr<NodeType>> all = [] {
    std::vector<std::unique_ptr<NodeType>> types;
    for (const X3DRow& row : x3d_former_rows()) types.push_back(type_of_x3d_row(row, nullptr));
    return types;
  }();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& type) { return type->name == name; });
  return found == all.end() ? nullptr : found->get();
}

const NodeType* x3d_extension_of(const NodeType& type) {
  if (type.kind != NodeType::Kind::built_in || type.language != Language::vrml97 || is_extension(type.clause))
    return nullptr;
  const auto& names = table(Language::x3d).by_name;
  const auto found = names.find(type.name);
  return found == names.end() || built_in_node_type(type.name) != &type ? nullptr : found->second;
}

bool accepts(const InterfaceDeclaration& field, const NodeType& type) {
  if (field.range.empty() || !holds_nodes(field.type) || type.language != Language::x3d) return true;
  std::string_view types = field.range;
  while (!types.empty()) {
    const std::string_view wanted = types.substr(0, types.find(','));
    if (is_derived(type.name, type.bases, wanted)) return true;
    types.remove_prefix(std::min(types.size(), wanted.size() + 1));
  }
  return false;
}

const NodeType& built_in_node_type(NodeKind kind) { return *table().by_kind.at(kind); }

const NodeType& x3d_node_type(NodeKind kind) { return *table(Language::x3d).by_kind.at(kind); }

}  // namespace gs::vrml
