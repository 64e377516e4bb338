#pragma once

#include "base/diagnostic.h"
#include "base/noncopyable.h"
#include "vrml/scene/values/field_value.h"
#include "vrml/scene/x3d/language.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

class SceneGraph;
struct Behaviour;
struct MadeNode;
struct Mesh;
struct MeshOptions;
struct NodeType;
struct Prototype;

/// Access type of an interface (VRML97 4.7).
enum class AccessType : std::uint8_t { eventIn, eventOut, field, exposedField };
[[nodiscard]] std::string_view name_of(AccessType access, Language language = Language::vrml97);

/// Declaration of one interface of a node type.
struct InterfaceDeclaration {
  AccessType access = AccessType::field;
  FieldType type = FieldType::SFBool;
  std::string name;
  FieldValue initial;              // initial value; only for fields and exposedFields
  std::string range;               // "[0,1]" as the standard writes it; only for built-in nodes. For nodes: accepts()
  std::string x3d_name{};          // name in X3D, if it differs: Switch.choice is `children` in X3D
  std::string former_name{};       // name before X3D 4, which files may still use
  bool lists = false;              // nodes that stand elsewhere in the hierarchy: HAnimHumanoid.joints
  int slot = -1;                   // index of the stored value in a node; -1 for eventIns and eventOuts
  bool of_other_browsers = false;  // event of a built-in node that the standard does not have (NodeRow::other_events)
};

/// Returns the name of an interface in a language.
[[nodiscard]] inline const std::string& name_in(Language language, const InterfaceDeclaration& declaration) {
  return language == Language::x3d && !declaration.x3d_name.empty() ? declaration.x3d_name : declaration.name;
}

/// Bit set of the roles of a node. It states where the node may stand and which code handles it.
enum class Role : std::uint32_t {
  none = 0,
  child = 1 << 0,               // may stand in `children` and at the top level (VRML97 4.6.5)
  grouping = 1 << 1,            // has children and belongs to the transformation hierarchy (4.6.5)
  geometry = 1 << 2,            // may stand in Shape.geometry (4.6.3)
  geometric_property = 1 << 3,  // Color, Coordinate, Normal, TextureCoordinate (4.6.3.2)
  appearance = 1 << 4,
  material = 1 << 5,
  texture = 1 << 6,
  texture_transform = 1 << 7,
  font_style = 1 << 8,
  light = 1 << 9,            // light source (4.6.6)
  bindable = 1 << 10,        // bindable node (4.6.10)
  sensor = 1 << 11,          // sensor (4.6.7)
  interpolator = 1 << 12,    // interpolator (4.6.8)
  time_dependent = 1 << 13,  // time-dependent node (4.6.9)
  sound_source = 1 << 14,
  script = 1 << 15,
  viewer_dependent = 1 << 16,  // its drawing depends on the position of the viewer
};
[[nodiscard]] constexpr Role operator|(Role a, Role b) {
  return static_cast<Role>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
[[nodiscard]] constexpr bool has(Role set, Role bit) {
  return (static_cast<std::uint32_t>(set) & static_cast<std::uint32_t>(bit)) != 0;
}

/// Kind of a node, for code that reads its fields. All node types of one kind have the fields that this code reads,
/// with the same types. A kind of nodes that the program itself makes has exactly one type. For `other`, code uses
/// only the remaining columns of the node table.
enum class NodeKind : std::uint8_t {
  other,
  shape,
  group,
  collision,
  transform,
  humanoid,
  geo_group,
  geo_lod,
  billboard,
  switch_node,
  lod,
  inline_node,
  directional_light,
  point_light,
  spot_light,
  viewpoint,
  viewpoint_group,
  layer_set,
  layer,
  viewport,
  layout,
  layout_group,
  layout_layer,
  screen_group,
  navigation_info,
  background,
  fog,
  appearance,
  line_properties,
  fill_properties,
  point_properties,
  clip_plane,
  local_fog,
  cad_face,
  material,
  image_texture,
  movie_texture,
  pixel_texture,
  texture_transform,
  font_style,
  coordinate,
  normal,
  color,
  color_rgba,
  coordinate_double,
  geo_coordinate,
  fog_coordinate,
  texture_coordinate,
  nurbs_texture_surface,
  indexed_face_set,
  indexed_line_set,
  point_set,
  outline_group,
  qnv,
  script,
  world_info,
  sound,
  multi_texture,
  texture_properties,
  physical_material,
  unlit_material,
  two_sided_material,
  composed_cube_map_texture,
  image_cube_map_texture,
  generated_cube_map_texture,
  composed_texture_3d,
  image_texture_3d,
  pixel_texture_3d,
  texture_transform_3d,
  texture_transform_matrix_3d,
  multi_texture_transform,
  multi_texture_coordinate,
  texture_coordinate_generator,
  texture_coordinate_3d,
  texture_coordinate_4d,
  particle_system,
  point_emitter,
  cone_emitter,
  explosion_emitter,
  polyline_emitter,
  surface_emitter,
  volume_emitter,
  force_physics,
  wind_physics,
  bounded_physics,
  volume_data,
  segmented_volume,
  iso_surface_volume,
  opacity_map_style,
  boundary_style,
  edge_style,
  tone_mapped_style,
  silhouette_style,
  cartoon_style,
  shaded_style,
  composed_style,
  blended_style,
  projection_style,
};

/// Content of the file that the `url` of a node names. It selects the content handler.
enum class UrlContent : std::uint8_t { none, scene, image, vectors, outlines, sound, movie };

/// Function that tessellates a geometry node. `geometry` is a node of `scene`; it has the type of the row.
using Tessellate = Mesh (*)(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);

/// Function that returns the node's size along each axis, relative to the default measures of its type.
using MeasuredScale = glm::vec3 (*)(const SceneGraph& scene, NodeId geometry);
/// Function that estimates the work for the mesh, in elements of the lists of an IndexedFaceSet
/// (vrml/mesh/geometry_copy.h).
using TessellationCost = std::size_t (*)(const SceneGraph& scene, NodeId geometry);
/// Tessellation functions of a geometry node type. `scale` is set if all nodes of the type are one mesh at different
/// scales. `cost` is set if the work is not proportional to the lengths of the node's lists.
struct Tessellator {
  Tessellate tessellate = nullptr;
  MeasuredScale scale = nullptr;
  TessellationCost cost = nullptr;

  constexpr Tessellator(Tessellate function = nullptr, MeasuredScale measured = nullptr,
                        TessellationCost measured_cost = nullptr)
      : tessellate(function), scale(measured), cost(measured_cost) {}
};

/// Values of NodeRow's clause for GhostSpace's own nodes (docs/formats.md), and for nodes of the standard's amendment.
inline constexpr std::string_view kOwnClause = "GhostSpace", kAmendmentClause = "VRML97 Amendment 1";
/// Reports whether other browsers may lack the node. Files may then contain a PROTO or EXTERNPROTO with its name.
[[nodiscard]] constexpr bool is_extension(std::string_view clause) {
  return clause == kOwnClause || clause == kAmendmentClause;
}

/// Row of the node table: one built-in node type in the notation of the standard. Parsing, defaults, IS and ROUTE
/// checks, printing and documentation are derived from it.
struct NodeRow {
  std::string_view name;
  std::string_view clause;  // "6.7"; kOwnClause for GhostSpace's own nodes
  Role role;
  NodeKind read_as;
  std::string_view interface_text;       // one declaration per line; its range follows as a comment
  Tessellator tessellator{};             // geometry nodes only
  const Behaviour* behaviour = nullptr;  // set if events or time do more than set fields (vrml/event_model/behaviour.h)
  UrlContent url_content = UrlContent::none;
  /// eventIns and eventOuts of other browsers, for ROUTE and IS in their worlds. Lists of the node types omit them.
  std::string_view other_events{};
};

/// Node of VRML97 that is written for a node that only X3D has (vrml/nodes/vrml97_equivalents.cpp).
struct Vrml97Equivalent {
  std::string_view x3d_type, type;  // names of both types
  /// Returns the node. Null means that both types have the same fields, except those that only X3D has.
  MadeNode (*make)(const SceneGraph& scene, NodeId node, const NodeType& type) = nullptr;
  std::string_view loss = {};  // property that the equivalent lacks, as message for the user; empty if there is none
};

/// Type of a node: built in, declared by a PROTO or EXTERNPROTO, or private to one Script. It does not change after its
/// first node is created, so any thread may read it.
struct NodeType : NonCopyable {
  enum class Kind : std::uint8_t { built_in, script, prototype, external_prototype };

  std::string name;
  std::string clause;  // only for built-in types
  Kind kind = Kind::built_in;
  Role role = Role::none;
  NodeKind read_as = NodeKind::other;           // set for built-in types and Scripts; `other` for PROTOs
  std::deque<InterfaceDeclaration> interfaces;  // in declaration order; addresses are stable
  std::vector<FieldValue> defaults;             // indexed by slot
  Tessellator tessellator;
  const Behaviour* behaviour = nullptr;
  UrlContent url_content = UrlContent::none;
  Language language = Language::vrml97;  // only for built-in types
  std::string component;                 // X3D types only: component of the standard
  int level = 0;                         // X3D types only: level of the component
  std::string container_field;           // X3D types only: default field of the parent in the XML encoding
  std::string bases;                     // X3D types only: abstract types that it derives from, separated by blanks
  bool is_programmable = false;          // Script or shader: bodies of nodes may declare interfaces
  bool ignored = false;                  // X3D types only: nodes have no effect; sinks warn about them
  const Vrml97Equivalent* equivalent = nullptr;  // X3D types only: null if VRML97 has the type, or no equivalent
  bool stands_in = false;                  // partial substitute for another browser's type (vrml/syntax/stand_ins.h)
  std::vector<int> measures;               // slots of the lengths of a built-in geometry: fields with the range (0,inf)
  std::unique_ptr<Prototype> prototype;    // body of a PROTO, otherwise null
  MFString url;                            // url of an EXTERNPROTO
  bool asked_for = false;                  // EXTERNPROTO of a run-time text: its body is being loaded
  SourceLocation location;                 // location of the name in the PROTO or EXTERNPROTO
  std::vector<SourceLocation> url_places;  // for Scripts: start of each string of the url in the text

  NodeType();
  ~NodeType();

  /// Adds a declaration. Assigns a slot if the interface stores a value.
  void declare(InterfaceDeclaration declaration);
  /// Returns the MFString fields with URLs of files, in the order of declaration: `url`, or fields with names that end
  /// in `Url` (VRML97 6.5).
  [[nodiscard]] std::vector<const InterfaceDeclaration*> url_fields() const;
  /// Returns the declaration with exactly this name, or with this x3d_name; null if there is none.
  [[nodiscard]] const InterfaceDeclaration* find(std::string_view name) const;
  /// Returns the field or exposedField with this name; null if there is none.
  [[nodiscard]] const InterfaceDeclaration* find_field(std::string_view name) const;
  /// Returns the declaration that `name` means as source of a ROUTE: the eventOut or exposedField `name`, or the
  /// exposedField x for `x_changed` (4.7). Returns null if there is none.
  [[nodiscard]] const InterfaceDeclaration* find_event_out(std::string_view name) const;
  /// Returns the declaration that `name` means as target of a ROUTE: the eventIn or exposedField `name`, or the
  /// exposedField x for `set_x` (4.7). For a built-in node, `x` also means the eventIn `set_x` if no interface is
  /// called x: `bind` means `set_bind`, as in other browsers. Returns null if there is none.
  [[nodiscard]] const InterfaceDeclaration* find_event_in(std::string_view name) const;

 private:
  [[nodiscard]] const InterfaceDeclaration* search(std::string_view name) const;

  std::vector<std::uint32_t> keys_;  // short hash of each name, so that searches seldom compare texts
  std::unordered_map<std::string_view, const InterfaceDeclaration*> by_name_;  // only of types with many interfaces
};

/// Returns the table of built-in node types of VRML97 or of X3D, sorted by name. The first call builds it; it never
/// changes. Any thread.
[[nodiscard]] std::span<const std::unique_ptr<NodeType>> built_in_node_types(Language language = Language::vrml97);
/// Returns the built-in VRML97 type with this name; null if there is none.
[[nodiscard]] const NodeType* built_in_node_type(std::string_view name);
/// Returns the built-in type with this name in a text of this language: in X3D, a type of X3D, or a type that only
/// VRML97 and GhostSpace have. Null if there is none.
[[nodiscard]] const NodeType* built_in_node_type(Language language, std::string_view name);
/// Returns the type that X3D 3 has under a name, if X3D 4 gave it other fields; otherwise null.
[[nodiscard]] const NodeType* former_x3d_type(std::string_view name);
/// Returns the built-in VRML97 type of this kind. If there are several, returns the first one by name.
[[nodiscard]] const NodeType& built_in_node_type(NodeKind kind);
/// Returns the built-in X3D type of this kind. If there are several, returns the first one by name.
[[nodiscard]] const NodeType& x3d_node_type(NodeKind kind);
/// Returns the X3D type that extends a built-in type of VRML97: it has the same name, and its first slots are those of
/// the VRML97 type. Null if there is none.
[[nodiscard]] const NodeType* x3d_extension_of(const NodeType& type);
/// Reports whether a node of this type may stand in a field of an X3D node, by the types that its row lists. Returns
/// true for fields without a list, and for PROTOs, because their first node is unknown here.
[[nodiscard]] bool accepts(const InterfaceDeclaration& field, const NodeType& type);
/// Reports whether other browsers have an interface of this name in a built-in type, but the standards do not: fields
/// of Castle Game Engine, X_ITE and InstantReality. Also knows the names of its events, `set_x` and `x_changed`.
[[nodiscard]] bool is_extension_field(const NodeType& type, std::string_view name);
/// Name of the browser as a node in ROUTEs, as in worlds for Contact.
inline constexpr std::string_view kBrowserName = "Browser";
/// Returns the type of the browser as a node. Not in the table.
[[nodiscard]] const NodeType& browser_node_type();
/// Returns the type of the node that `event_changed` of the browser sends. Not in the table.
[[nodiscard]] const NodeType& browser_event_type();
/// Returns the extension node for which a PROTO or EXTERNPROTO is the fallback in other browsers. The
/// extension node has the same name and all interfaces of the PROTO. Returns null if there is none. Ignores nodes with
/// streamed vectors.
[[nodiscard]] const NodeType* stood_for(const NodeType& prototype);

}  // namespace gs::vrml
