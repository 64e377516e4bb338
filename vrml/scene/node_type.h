#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/field_value.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

class SceneGraph;
struct Behaviour;
struct Mesh;
struct MeshOptions;
struct Prototype;

/// VRML97 4.7: how an interface may be used.
enum class AccessType : std::uint8_t { eventIn, eventOut, field, exposedField };
[[nodiscard]] std::string_view name_of(AccessType access);

/// One line of a node's interface.
struct InterfaceDeclaration {
  AccessType access = AccessType::field;
  FieldType type = FieldType::SFBool;
  std::string name;
  FieldValue initial;  // fields and exposedFields only
  std::string range;   // "[0,1]" as the standard writes it; built-in nodes only
  int slot = -1;       // place of the stored value in a node; -1 for eventIn and eventOut
};

/// What a node is for; a set of bits. From it follow where a node may stand and who looks at it.
enum class Role : std::uint32_t {
  none = 0,
  child = 1 << 0,               // may stand in `children` and at top level (VRML97 4.6.5)
  grouping = 1 << 1,            // has children and a transformation hierarchy (4.6.5)
  geometry = 1 << 2,            // Shape.geometry (4.6.3)
  geometric_property = 1 << 3,  // Color, Coordinate, Normal, TextureCoordinate (4.6.3.2)
  appearance = 1 << 4,
  material = 1 << 5,
  texture = 1 << 6,
  texture_transform = 1 << 7,
  font_style = 1 << 8,
  light = 1 << 9,            // 4.6.6
  bindable = 1 << 10,        // 4.6.10
  sensor = 1 << 11,          // 4.6.7
  interpolator = 1 << 12,    // 4.6.8
  time_dependent = 1 << 13,  // 4.6.9
  sound_source = 1 << 14,
  script = 1 << 15,
  viewer_dependent = 1 << 16,  // what it shows depends on where the viewer is
};
[[nodiscard]] constexpr Role operator|(Role a, Role b) {
  return static_cast<Role>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
[[nodiscard]] constexpr bool has(Role set, Role bit) {
  return (static_cast<std::uint32_t>(set) & static_cast<std::uint32_t>(bit)) != 0;
}

/// How the program reads a node of this type where it does so field by field: the nodes of one kind have the fields
/// that the kind is read by, of the same types. Of kinds that it makes nodes of, there is one type. `other`: the
/// program knows of the node what the other columns say.
enum class NodeKind : std::uint8_t {
  other,
  shape,
  group,
  collision,
  transform,
  billboard,
  switch_node,
  lod,
  inline_node,
  directional_light,
  point_light,
  spot_light,
  viewpoint,
  navigation_info,
  background,
  fog,
  appearance,
  material,
  image_texture,
  movie_texture,
  pixel_texture,
  texture_transform,
  font_style,
  coordinate,
  normal,
  color,
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
};

/// What the file holds that a node's `url` names, and so what is fetched for it.
enum class UrlContent : std::uint8_t { none, scene, image, vectors, outlines, sound, movie };

/// Makes the mesh of a geometry node. `geometry` is a node of `scene` of the row's own type.
using Tessellate = Mesh (*)(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);

/// How much larger the node is than one with the default measures of its type, along each axis.
using MeasuredScale = glm::vec3 (*)(const SceneGraph& scene, NodeId geometry);
/// About how much work the mesh is, in elements of the lists of an IndexedFaceSet (vrml/mesh/geometry_copy.h).
using TessellationCost = std::size_t (*)(const SceneGraph& scene, NodeId geometry);
/// What makes the mesh of a geometry node; where all of its nodes are one mesh at different scales, the scale; and where
/// the work is not in proportion to the lists of the node, the work.
struct Tessellator {
  Tessellate tessellate = nullptr;
  MeasuredScale scale = nullptr;
  TessellationCost cost = nullptr;

  constexpr Tessellator(Tessellate function = nullptr, MeasuredScale measured = nullptr,
                        TessellationCost measured_cost = nullptr)
      : tessellate(function), scale(measured), cost(measured_cost) {}
};

/// The clause of the nodes that are our own (docs/formats.md), and of those of the standard's amendment.
inline constexpr std::string_view kOwnClause = "GhostSpace", kAmendmentClause = "VRML97 Amendment 1";
/// Whether browsers need not know the node: files may bring a PROTO or EXTERNPROTO of its name along.
[[nodiscard]] constexpr bool is_extension(std::string_view clause) {
  return clause == kOwnClause || clause == kAmendmentClause;
}

/// One built-in node type, as the standard prints it: the row from which everything else (parsing,
/// defaults, IS and ROUTE checks, printing, documentation) is derived.
struct NodeRow {
  std::string_view name;
  std::string_view clause;  // "6.7"; kOwnClause for our own nodes
  Role role;
  NodeKind read_as;
  std::string_view interface_text;       // one declaration a line, the range in a comment behind it
  Tessellator tessellator{};             // geometry only
  const Behaviour* behaviour = nullptr;  // where events and time do more than set fields (vrml/events/behaviour.h)
  UrlContent url_content = UrlContent::none;
};

/// The type of a node: built in, declared by PROTO or EXTERNPROTO, or one Script's own.
/// Immutable once the first node of it exists, so any thread may read it.
struct NodeType {
  enum class Kind : std::uint8_t { built_in, script, prototype, external_prototype };

  std::string name;
  std::string clause;  // built-in only
  Kind kind = Kind::built_in;
  Role role = Role::none;
  NodeKind read_as = NodeKind::other;           // built in and Scripts; `other` of PROTOs
  std::deque<InterfaceDeclaration> interfaces;  // in declaration order; places never move
  std::vector<FieldValue> defaults;             // by slot
  Tessellator tessellator;
  const Behaviour* behaviour = nullptr;
  UrlContent url_content = UrlContent::none;
  bool stands_in = false;     // for a type of other browsers (vrml/syntax/stand_ins.h), of which it has a part
  std::vector<int> measures;  // slots of a built-in geometry's lengths: fields whose range is (0,inf)
  std::unique_ptr<Prototype> prototype;    // body of a PROTO
  MFString url;                            // of an EXTERNPROTO
  bool asked_for = false;                  // of an EXTERNPROTO of a text read at run time: the body is being fetched
  SourceLocation location;                 // of the name in a PROTO or EXTERNPROTO
  std::vector<SourceLocation> url_places;  // of a Script: where the strings of its url begin in its text

  NodeType();
  ~NodeType();
  NodeType(const NodeType&) = delete;
  NodeType& operator=(const NodeType&) = delete;

  /// Adds a declaration, giving it a slot if it stores a value.
  void declare(InterfaceDeclaration declaration);
  /// The MFString fields that name files: `url`, or those whose names end with `Url` (VRML97 6.5), as they are
  /// declared.
  [[nodiscard]] std::vector<const InterfaceDeclaration*> url_fields() const;
  /// The declaration of exactly this name, or null.
  [[nodiscard]] const InterfaceDeclaration* find(std::string_view name) const;
  /// The field or exposedField of this name, or null.
  [[nodiscard]] const InterfaceDeclaration* find_field(std::string_view name) const;
  /// The source of a ROUTE: an eventOut or exposedField `name`, or an exposedField x of `x_changed` (4.7).
  [[nodiscard]] const InterfaceDeclaration* find_event_out(std::string_view name) const;
  /// The target of a ROUTE: an eventIn or exposedField `name`, or an exposedField x of `set_x` (4.7).
  [[nodiscard]] const InterfaceDeclaration* find_event_in(std::string_view name) const;

 private:
  std::vector<std::uint32_t> keys_;  // a short digest of each name, so that a search rarely compares text
};

/// The table of built-in node types. Built once, thread-safe, then constant.
[[nodiscard]] std::span<const std::unique_ptr<NodeType>> built_in_node_types();
/// The built-in type of this name, or null.
[[nodiscard]] const NodeType* built_in_node_type(std::string_view name);
/// The built-in type of this kind, the first one by name where there are several.
[[nodiscard]] const NodeType& built_in_node_type(NodeKind kind);
/// The extension that a PROTO or EXTERNPROTO stands for in browsers that do not know it: of the same name, with no
/// other interface than the node's, and made of its fields alone. Null for any other.
[[nodiscard]] const NodeType* stood_for(const NodeType& prototype);

}  // namespace gs::vrml
