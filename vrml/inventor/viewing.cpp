#include "vrml/inventor/converter.h"
#include "vrml/inventor/item_types.h"
#include "vrml/syntax/numbers/number.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

// Cameras, lights, the environment, and Info nodes with hints for the viewer.
namespace gs::vrml::inventor {
namespace {

void add_viewpoint(Converter& converter, const Item& item, SFVec3f position, float field_of_view) {
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const NodeId viewpoint = output.begin("Viewpoint", *target, item.location, item.name);
  if (!viewpoint) return;
  output.set(viewpoint, "position", position);
  output.set(viewpoint, "orientation", item.get<SFRotation>("orientation"));
  output.set(viewpoint, "fieldOfView", field_of_view);
  if (!item.name.empty()) output.set(viewpoint, "description", SFString(item.name));
  output.end(viewpoint);
}

void apply_perspective(Converter& converter, const Item& item) {
  float angle = item.get<SFFloat>("heightAngle");
  if (!(angle > 0) || angle >= 3.1F) angle = 0.785398F;
  const SFVec3f position = item.get<SFVec3f>("position");
  const glm::dvec4 world = converter.output().world_matrix() * glm::dvec4(position, 1);
  converter.set_camera({glm::dvec3(world), angle, 0});
  add_viewpoint(converter, item, position, angle);
}

// Becomes an OrthoViewpoint of X3D. Its rectangle is a square, because the window determines the width.
void apply_orthographic(Converter& converter, const Item& item) {
  float height = item.get<SFFloat>("height");
  if (!(height > 0)) height = 2;
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const SFVec3f position = item.get<SFVec3f>("position");
  const glm::dvec4 world = output.world_matrix() * glm::dvec4(position, 1);
  converter.set_camera({glm::dvec3(world), 0, height});
  const NodeId viewpoint = output.begin_x3d("OrthoViewpoint", *target, item.location, item.name);
  if (!viewpoint) return;
  output.set(viewpoint, "position", position);
  output.set(viewpoint, "orientation", item.get<SFRotation>("orientation"));
  output.set(viewpoint, "fieldOfView", MFFloat{-height / 2, -height / 2, height / 2, height / 2});
  if (!item.name.empty()) output.set(viewpoint, "description", SFString(item.name));
  output.end(viewpoint);
}

// Becomes a ClipPlane of X3D, which clips the later nodes of its group.
void apply_clip_plane(Converter& converter, const Item& item) {
  const MFFloat& plane = item.get<MFFloat>("plane");
  if (!item.get<SFBool>("on") || plane.size() < 4) return;
  Output& output = converter.output();
  output.split_group(item.location);
  const auto target = output.group_target();
  if (!target) return;
  const glm::dmat4 matrix = output.inner_matrix();
  if (glm::determinant(matrix) == 0) return;
  const NodeId node = output.begin_x3d("ClipPlane", *target, item.location);
  if (!node) return;
  // The file has the normal and its distance from the origin; X3D has the coefficients of the equation.
  const glm::dvec4 inside = glm::transpose(glm::inverse(matrix)) * glm::dvec4(plane[0], plane[1], plane[2], -plane[3]);
  output.set(node, "plane", SFVec4f(inside));
  output.end(node);
}

void set_light(Output& output, NodeId light, const Item& item) {
  output.set(light, "on", item.get<SFBool>("on"));
  output.set(light, "intensity", item.get<SFFloat>("intensity"));
  output.set(light, "color", item.get<SFColor>("color"));
}

// A DirectionalLight lights the later nodes of its group: they get a group of their own if there are earlier ones.
void apply_directional_light(Converter& converter, const Item& item) {
  if (!item.get<SFBool>("on")) return;
  Output& output = converter.output();
  output.split_group(item.location);
  const auto target = output.group_target();
  if (!target) return;
  const NodeId light = output.begin("DirectionalLight", *target, item.location, item.name);
  if (!light) return;
  set_light(output, light, item);
  glm::dvec3 direction = glm::dmat3(output.inner_matrix()) * glm::dvec3(item.get<SFVec3f>("direction"));
  if (const double length = glm::length(direction); length > 0) direction /= length;
  output.set(light, "direction", SFVec3f(direction));
  output.end(light);
}

template <bool spot>
void apply_local_light(Converter& converter, const Item& item) {
  constexpr float kFar = 1e9F;  // without attenuation, lights of Inventor reach everything
  if (!item.get<SFBool>("on")) return;
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const NodeId light = output.begin(spot ? "SpotLight" : "PointLight", *target, item.location, item.name);
  if (!light) return;
  set_light(output, light, item);
  output.set(light, "location", item.get<SFVec3f>("location"));
  output.set(light, "radius", kFar);
  // The environment gives the square factor first; VRML97 gives the constant factor first.
  const SFVec3f& squares = converter.attenuation();
  if (squares != SFVec3f(0, 0, 1)) output.set(light, "attenuation", SFVec3f{squares.z, squares.y, squares.x});
  if constexpr (spot) {
    const float cut_off = item.get<SFFloat>("cutOffAngle"), drop = item.get<SFFloat>("dropOffRate");
    output.set(light, "direction", item.get<SFVec3f>("direction"));
    output.set(light, "cutOffAngle", std::clamp(cut_off, 0.001F, 1.570796F));
    // The light falls with a power of the cosine; VRML97 has a beam of full intensity instead.
    output.set(light, "beamWidth",
               drop > 0 ? std::clamp(cut_off * (1 - std::min(drop, 1.0F)), 0.001F, 1.570796F) : 1.570796F);
  }
  output.end(light);
}

void apply_environment(Converter& converter, const Item& item) {
  converter.set_attenuation(item.get<SFVec3f>("attenuation"));
  const std::string_view type = item.word("fogType");
  if (type == "NONE" || type.empty()) return;
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const NodeId fog = output.begin("Fog", *target, item.location, item.name);
  if (!fog) return;
  const float visibility = item.get<SFFloat>("fogVisibility");
  if (visibility <= 0)
    converter.warn_once(item.location, "fog that ends at the far plane is not supported; drawn without fog");
  output.set(fog, "color", item.get<SFColor>("fogColor"));
  output.set(fog, "fogType", SFString(type == "HAZE" ? "LINEAR" : "EXPONENTIAL"));
  output.set(fog, "visibilityRange", std::max(visibility, 0.0F));
  output.end(fog);
}

std::optional<SFColor> color_in(std::string_view text) {
  float numbers[3];
  const std::string ended = std::string(text) + ' ';
  const NumberRun run = parse_floats(ended.data(), ended.data() + ended.size(), numbers, 3);
  if (run.count != 3) return std::nullopt;
  return SFColor{numbers[0], numbers[1], numbers[2]};
}

// Info nodes with certain names are hints for the viewer (VRML 1.0, "Extensions" of browsers).
void apply_info(Converter& converter, const Item& item) {
  Output& output = converter.output();
  const String& text = item.get<SFString>("string");
  const auto target = output.group_target();
  if (!target || text.empty()) return;
  const bool background = item.name == "BackgroundColor" || item.name == "backgroundColor";
  if (const auto color = background ? color_in(text.view()) : std::nullopt) {
    const NodeId node = output.begin("Background", *target, item.location);
    if (!node) return;
    output.set(node, "skyColor", MFColor{*color});
    return output.end(node);
  }
  if (item.name == "Viewer" || item.name == "viewer") {
    const std::string_view name = text.view();
    const auto is = [&](std::string_view word) { return name.find(word) != std::string_view::npos; };
    const NodeId node = output.begin("NavigationInfo", *target, item.location);
    if (!node) return;
    output.set(node, "type",
               MFString{is("walk") || is("Walk")                ? "WALK"
                        : is("fly") || is("Fly") || is("plane") ? "FLY"
                                                                : "EXAMINE",
                        "ANY"});
    return output.end(node);
  }
  const NodeId node = output.begin("WorldInfo", *target, item.location);
  if (!node) return;
  const bool title = item.name == "Title" || item.name == "title";
  if (title)
    output.set(node, "title", text);
  else
    output.set(node, "info", MFString{text});
  output.end(node);
}

// Copies a VRML97 node, which some programs write into VRML 1.0 files.
void apply_vrml97(Converter& converter, const Item& item) {
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const NodeId node = output.begin(item.type->name, *target, item.location, item.name);
  if (!node) return;
  Node& made = output.scene().node(node);
  for (const ItemField& field : item.fields) {
    const InterfaceDeclaration* const declaration = made.type->find_field(field.row->name);
    if (declaration && made.values[declaration->slot].index() == field.value.index())
      made.values[declaration->slot] = field.value;
  }
  output.end(node);
}

constexpr std::string_view kDirectionalFields =
    "SFBool on TRUE SFFloat intensity 1 SFColor color 1 1 1 SFVec3f direction 0 0 -1";
constexpr std::string_view kPointFields =
    "SFBool on TRUE SFFloat intensity 1 SFColor color 1 1 1 SFVec3f location 0 0 1";
constexpr std::string_view kSpotFields = R"(
  SFBool on TRUE
  SFFloat intensity 1
  SFColor color 1 1 1
  SFVec3f location 0 0 1
  SFVec3f direction 0 0 -1
  SFFloat dropOffRate 0
  SFFloat cutOffAngle 0.785398)";
constexpr std::string_view kHandles = "its handles are not shown";
constexpr std::string_view kForeign = "a VRML97 node in a VRML 1.0 or Inventor file; accepted";

constexpr ItemRow kViewingRows[] = {
    {"PerspectiveCamera", ItemClass::plain, false, apply_perspective, R"(
  SFEnum viewportMapping ADJUST_CAMERA
  SFVec3f position 0 0 1
  SFRotation orientation 0 0 1 0
  SFFloat aspectRatio 1
  SFFloat nearDistance 1
  SFFloat farDistance 10
  SFFloat focalDistance 5
  SFFloat heightAngle 0.785398)"},
    {"OrthographicCamera", ItemClass::plain, false, apply_orthographic, R"(
  SFEnum viewportMapping ADJUST_CAMERA
  SFVec3f position 0 0 1
  SFRotation orientation 0 0 1 0
  SFFloat aspectRatio 1
  SFFloat nearDistance 1
  SFFloat farDistance 10
  SFFloat focalDistance 5
  SFFloat height 2)"},
    {"ClipPlane", ItemClass::plain, false, apply_clip_plane, "SFPlane plane 1 0 0 0 SFBool on TRUE"},
    {"ClipPlaneManip", ItemClass::kit, false, apply_clip_plane, "SFPlane plane 1 0 0 0 SFBool on TRUE", kHandles},
    {"DirectionalLight", ItemClass::plain, false, apply_directional_light, kDirectionalFields},
    {"PointLight", ItemClass::plain, false, apply_local_light<false>, kPointFields},
    {"SpotLight", ItemClass::plain, false, apply_local_light<true>, kSpotFields},
    {"DirectionalLightManip ShadowDirectionalLight", ItemClass::kit, false, apply_directional_light, kDirectionalFields,
     kHandles},
    {"PointLightManip", ItemClass::kit, false, apply_local_light<false>, kPointFields, kHandles},
    {"SpotLightManip ShadowSpotLight", ItemClass::kit, false, apply_local_light<true>, kSpotFields, kHandles},
    {"Environment", ItemClass::plain, false, apply_environment, R"(
  SFFloat ambientIntensity 0.2
  SFColor ambientColor 1 1 1
  SFVec3f attenuation 0 0 1
  SFEnum fogType NONE
  SFColor fogColor 1 1 1
  SFFloat fogVisibility 0
  SFFloat fogStart 0)"},
    {"Info", ItemClass::plain, false, apply_info, "SFString string \"<Undefined info>\""},
    {"Background", ItemClass::plain, false, apply_vrml97, R"(
  MFFloat groundAngle []
  MFColor groundColor []
  MFString backUrl []
  MFString bottomUrl []
  MFString frontUrl []
  MFString leftUrl []
  MFString rightUrl []
  MFString topUrl []
  MFFloat skyAngle []
  MFColor skyColor 0 0 0)",
     kForeign},
    {"NavigationInfo", ItemClass::plain, false, apply_vrml97, R"(
  MFFloat avatarSize []
  SFBool headlight TRUE
  SFFloat speed 1
  MFString type []
  SFFloat visibilityLimit 0)",
     kForeign},
    {"Fog", ItemClass::plain, false, apply_vrml97,
     "SFColor color 1 1 1 SFString fogType LINEAR SFFloat visibilityRange 0", kForeign},
    {"WorldInfo", ItemClass::plain, false, apply_vrml97, "MFString info [] SFString title \"\"", kForeign},
    {"Viewpoint", ItemClass::plain, false, apply_vrml97, R"(
  SFFloat fieldOfView 0.785398
  SFBool jump TRUE
  SFRotation orientation 0 0 1 0
  SFVec3f position 0 0 10
  SFString description "")",
     kForeign},
};

}  // namespace

std::span<const ItemRow> viewing_rows() { return kViewingRows; }

}  // namespace gs::vrml::inventor
