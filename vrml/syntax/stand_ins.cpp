#include "vrml/syntax/stand_ins.h"

#include "base/diagnostic.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>

namespace gs::vrml {
namespace {

// Stand-ins: interfaces and bodies of PROTOs. All other fields and events of these nodes are ignored
// (NodeType::stands_in).
constexpr std::string_view kGroup = R"( [
  exposedField MFNode children []
  eventIn MFNode addChildren
  eventIn MFNode removeChildren
] {
  Group { children IS children addChildren IS addChildren removeChildren IS removeChildren }
})";
// Children that are fixed to the viewer, in the viewer's coordinate system.
constexpr std::string_view kOverlay = R"( [
  exposedField MFNode children []
  eventIn MFNode addChildren
  eventIn MFNode removeChildren
] {
  Group {
    children [
      DEF Viewer ProximitySensor { size 1e9 1e9 1e9 }
      DEF Frame Transform { children IS children addChildren IS addChildren removeChildren IS removeChildren }
    ]
  }
  ROUTE Viewer.position_changed TO Frame.set_translation
  ROUTE Viewer.orientation_changed TO Frame.set_rotation
})";
// Nodes for shared worlds and devices, which are not visible.
constexpr std::string_view kNothing = " [ ] { WorldInfo { } }";

// Inline that other browsers may leave unloaded; this browser always loads it.
constexpr std::string_view kInline = R"( [
  exposedField MFString url []
  field SFVec3f bboxCenter 0 0 0
  field SFVec3f bboxSize -1 -1 -1
] {
  Inline { url IS url bboxCenter IS bboxCenter bboxSize IS bboxSize }
})";
constexpr std::string_view kNavigationInfo = R"( [
  eventIn SFBool set_bind
  exposedField MFFloat avatarSize [ 0.25 1.6 0.75 ]
  exposedField SFBool headlight TRUE
  exposedField SFFloat speed 1
  exposedField MFString type [ "WALK" "ANY" ]
  exposedField SFFloat visibilityLimit 0
  eventOut SFBool isBound
] {
  NavigationInfo {
    set_bind IS set_bind avatarSize IS avatarSize headlight IS headlight speed IS speed type IS type
    visibilityLimit IS visibilityLimit isBound IS isBound
  }
})";
constexpr std::string_view kMaterial = R"( [
  exposedField SFFloat ambientIntensity 0.2
  exposedField SFColor diffuseColor 0.8 0.8 0.8
  exposedField SFColor emissiveColor 0 0 0
  exposedField SFFloat shininess 0.2
  exposedField SFColor specularColor 0 0 0
  exposedField SFFloat transparency 0
] {
  Material {
    ambientIntensity IS ambientIntensity diffuseColor IS diffuseColor emissiveColor IS emissiveColor
    shininess IS shininess specularColor IS specularColor transparency IS transparency
  }
})";

// Geometry nodes of other standards, which are not visible.
constexpr std::string_view kNoGeometry = " [ ] { PointSet { } }";

// Coordinates that another browser computes.
constexpr std::string_view kNoCoordinates = " [ ] { TextureCoordinate { } }";

// Metadata with the name of a draft of X3D.
constexpr std::string_view kMetadataBool = R"( [
  exposedField SFString name ""
  exposedField SFString reference ""
  exposedField MFBool value []
] {
  MetadataBoolean { name IS name reference IS reference value IS value }
})";

// Surface with contours (Amendment 1), which are not cut out; see meant_node().
constexpr std::string_view kTrimmedSurface = R"( [
  eventIn MFNode addTrimmingContour
  eventIn MFNode removeTrimmingContour
  exposedField MFNode trimmingContour []
  exposedField SFNode surface NULL
] {
  Shape { geometry IS surface }
})";

struct Row {
  std::string_view name, text;
  bool overlay = false;
  Role role = Role::none;  // role, if not that of the first node of the body
};
constexpr Row kRows[] = {
    {"BlaxxunZone", kNothing},
    {"BspGroup", kGroup},
    {"ColorSetInterpolator", kNothing},
    {"CullGroup", kGroup},
    {"DeviceSensor", kNothing},
    {"HUD", kOverlay, true},
    {"IndexedPolygons", kNoGeometry},
    {"InlineLoadControl", kInline},
    {"KambiInline", kInline},
    {"KambiNavigationInfo", kNavigationInfo},
    {"Layer2D", kGroup},
    {"Layer3D", kGroup},
    {"Logger", kNothing},
    {"MenuSensor", kNothing},
    {"MetadataBool", kMetadataBool},
    {"MouseSensor", kNothing},
    {"Occlusion", kGroup},
    {"Particles", kNothing},
    {"Polygon", kNoGeometry},
    {"ProjectedTextureCoordinate", kNoCoordinates},
    {"RefractiveMaterial", kMaterial},
    {"Selection", kGroup},
    {"SharedEvent", kNothing},
    {"SharedObject", kNothing},
    {"SimpleBackground", kNothing},
    {"SpaceSensor", kNothing},
    {"Teapot", kNoGeometry},
    {"Text2D", kNoGeometry},
    {"TrimmedSurface", kTrimmedSurface, false, Role::geometry},
};

const NodeType* make(SceneGraph& scene, std::string_view name, std::string_view text, Role role = Role::none) {
  auto library = std::make_unique<SceneGraph>("stand-in for " + std::string(name), scene.budget());
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nPROTO " + std::string(name) + std::string(text), *library, diagnostics);
  if (!find_prototype(*library, name)) return nullptr;  // the budget is exhausted
  library->types().front()->stands_in = true;
  if (role != Role::none) library->types().front()->role = role;
  return find_prototype(scene.texts().writing().attach_library(std::move(library)), name);
}

// Makes a PROTO that is a built-in node with another name.
const NodeType* make_built_in(SceneGraph& scene, const NodeType& type) {
  std::string text = " [\n" + print_interface(type) + "] {\n  " + type.name + " {";
  for (const InterfaceDeclaration& one : type.interfaces) text += ' ' + one.name + " IS " + one.name;
  return make(scene, type.name, text + " }\n}");
}

// Returns the text after `:node:` in the URN of a node type. Returns an empty text if the URL is not such a URN.
std::string_view node_of_urn(std::string_view url) {
  constexpr std::string_view kScheme = "urn:", kNode = ":node:";
  const std::size_t at = url.rfind(kNode);
  if (at == url.npos || !url.starts_with(kScheme)) return {};
  return url.substr(at + kNode.size());
}

}  // namespace

const NodeType* stand_in(SceneGraph& scene, std::string_view name) {
  for (const Row& row : kRows)
    if (row.name == name) return make(scene, row.name, row.text, row.role);
  return nullptr;
}

bool is_overlay(const NodeType& type) {
  return type.stands_in && std::any_of(std::begin(kRows), std::end(kRows),
                                       [&](const Row& row) { return row.overlay && row.name == type.name; });
}

const NodeType* built_in_node_of_urn(const MFString& urls) {
  for (const String& url : urls)
    if (const NodeType* type = built_in_node_type(Language::x3d, node_of_urn(url.view()));
        type && type->kind == NodeType::Kind::built_in)
      return type;
  return nullptr;
}

const NodeType* stand_in_for(SceneGraph& scene, const NodeType& external) {
  if (const NodeType* of_table = stand_in(scene, external.name)) return of_table;
  if (const NodeType* named = built_in_node_of_urn(external.url)) return make_built_in(scene, *named);
  for (const String& url : external.url)
    if (const NodeType* of_table = stand_in(scene, node_of_urn(url.view()))) return of_table;
  const InterfaceDeclaration* children = external.find_field("children");
  return children && children->type == FieldType::MFNode ? make(scene, "Group", kGroup) : nullptr;
}

}  // namespace gs::vrml
