#include "render/collection/nodes/collect_nodes.h"

#include "base/finite.h"
#include "vrml/event_model/behaviour.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gs::render {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;

constexpr std::size_t kMaxText = 1024;              // maximum bytes; USE can multiply a long text
constexpr std::size_t kMaxBackgroundColors = 1024;  // maximum rings of a Background; more than the rows of a screen
constexpr std::size_t kMaxNavigationTypes = 16;
constexpr float kHalfPi = std::numbers::pi_v<float> / 2;
constexpr double kTiny = 1e-12;

float within(float value, float lowest, float highest, float otherwise) {
  return std::isnan(value) ? otherwise : std::clamp(value, lowest, highest);
}

float number(const NodeView& view, int field, float lowest, float highest, float otherwise) {
  return within(view.get(field, otherwise), lowest, highest, otherwise);
}

glm::vec3 color(const vrml::Color& c, const glm::vec3& otherwise) {
  return {within(c.r, 0, 1, otherwise.r), within(c.g, 0, 1, otherwise.g), within(c.b, 0, 1, otherwise.b)};
}

glm::vec3 color(const NodeView& view, int field, const glm::vec3& otherwise) {
  const auto* value = view.find<vrml::SFColor>(field);
  return value ? color(*value, otherwise) : otherwise;
}

glm::vec3 vector(const NodeView& view, int field, const glm::vec3& otherwise) {
  const auto* value = view.find<vrml::SFVec3f>(field);
  return value && finite(*value) ? *value : otherwise;
}

std::string bounded_text(std::string_view text) {
  if (text.size() <= kMaxText) return std::string(text);
  std::size_t end = kMaxText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // not inside of a character
  return std::string(text.substr(0, end));
}

/// Reads ring colours and their angles, which must not decrease. The field does not contain the angle of the first
/// colour.
void rings(const NodeView& view, int color_field, int angle_field, float largest_angle, std::vector<glm::vec3>& colors,
           std::vector<float>& angles) {
  colors.clear();
  angles.clear();
  const auto* given_colors = view.find<vrml::MFColor>(color_field);
  const auto* given_angles = view.find<vrml::MFFloat>(angle_field);
  if (!given_colors || given_colors->empty()) return;
  colors.push_back(color(given_colors->front(), glm::vec3(0)));
  const std::size_t count =
      std::min({given_colors->size() - 1, given_angles ? given_angles->size() : 0, kMaxBackgroundColors - 1});
  float previous = 0;
  for (std::size_t i = 0; i < count; ++i) {
    previous = within((*given_angles)[i], previous, std::max(previous, largest_angle), previous);
    angles.push_back(previous);
    colors.push_back(color((*given_colors)[i + 1], glm::vec3(0)));
  }
}

}  // namespace

dmat3 rotation_part(const dmat4& matrix) {
  dvec3 x(matrix[0]), y(matrix[1]), z(matrix[2]);
  const auto usable = [](double length) { return length > kTiny * kTiny && std::isfinite(length); };
  const double x_length = glm::length(x);
  if (!usable(x_length)) return dmat3(1);
  x /= x_length;
  const double y_length = glm::length(y);
  if (!usable(y_length)) return dmat3(1);
  y /= y_length;
  y -= x * glm::dot(x, y);
  if (glm::length(y) < kTiny) return dmat3(1);
  y = glm::normalize(y);
  z = glm::cross(x, y);
  return {x, y, z};
}

dmat4 transform_matrix(const NodeView& view) {
  using F = TransformFields;
  return vrml::transform_matrix(vector(view, F::translation, glm::vec3(0)), vector(view, F::center, glm::vec3(0)),
                                view.get(F::rotation, vrml::Rotation{}), vector(view, F::scale, glm::vec3(1)),
                                view.get(F::scale_orientation, vrml::Rotation{}));
}

dmat4 billboard_matrix(const NodeView& billboard, const dvec3& viewer, const dvec3& up) {
  return vrml::billboard_matrix(vector(billboard, BillboardFields::axis_of_rotation, glm::vec3(0, 1, 0)), viewer, up);
}

int lod_level(const NodeView& lod, const dvec3& viewer) {
  const auto* levels = lod.find<vrml::MFNode>(LodFields::level);
  const auto* ranges = lod.find<vrml::MFFloat>(LodFields::range);
  if (!levels || levels->empty()) return -1;
  std::size_t level = 0;
  if (ranges) {
    const double distance = glm::length(viewer - dvec3(vector(lod, LodFields::center, glm::vec3(0))));
    while (level < ranges->size() && level + 1 < levels->size() && distance >= (*ranges)[level]) ++level;
  }
  return static_cast<int>(std::min<std::size_t>(level, 0x7FFFFFFF));
}

Light world_light(const NodeView& view, const dmat4& world_from_node) {
  using F = LightFields;
  Light light;
  light.kind = view.kind() == NodeKind::directional_light ? Light::Kind::directional
               : view.kind() == NodeKind::point_light     ? Light::Kind::point
                                                          : Light::Kind::spot;
  light.color = color(view, F::color, glm::vec3(1));
  // X3D permits any intensity.
  const bool x3d = view.node->type->language == vrml::Language::x3d;
  light.intensity = number(view, F::intensity, 0, x3d ? std::numeric_limits<float>::max() : 1, 1);
  if (const auto* global = view.find<vrml::SFBool>(F::global)) light.global = *global;
  light.ambient_intensity = number(view, F::ambient_intensity, 0, 1, 0);
  const dvec3 direction = dmat3(world_from_node) * dvec3(vector(view, F::direction, glm::vec3(0, 0, -1)));
  const double length = glm::length(direction);
  light.direction = length > 0 && std::isfinite(length) ? glm::vec3(direction / length) : glm::vec3(0, 0, -1);
  if (light.kind == Light::Kind::directional) return light;

  const double determinant = std::abs(glm::determinant(dmat3(world_from_node)));
  const double scale = determinant > 0 && std::isfinite(determinant) ? std::cbrt(determinant) : 1.0;
  light.location = dvec3(world_from_node * glm::dvec4(vector(view, F::location, glm::vec3(0)), 1));
  const float largest = std::numeric_limits<float>::max();
  light.radius = static_cast<float>(std::min(number(view, F::radius, 0, largest, 100) * scale, double{largest}));
  const glm::vec3 attenuation = glm::max(vector(view, F::attenuation, glm::vec3(1, 0, 0)), glm::vec3(0));
  light.attenuation = glm::vec3(dvec3(attenuation) / dvec3(1, scale, scale * scale));
  light.beam_width = number(view, F::beam_width, 0, kHalfPi, kHalfPi);
  light.cut_off_angle = number(view, F::cut_off_angle, 0, kHalfPi, 0.785398f);
  return light;
}

ViewpointState world_viewpoint(const vrml::SceneGraph& scene, const NodeView& view, const dmat4& given_world) {
  using F = ViewpointFields;
  ViewpointState state;
  if (const auto* description = view.find<vrml::SFString>(F::description))
    state.description = bounded_text(description->view());
  state.name = bounded_text(view.node->name);
  state.jump = view.get(F::jump, true);
  // The position of a GeoViewpoint is geospatial; its camera stands in the origin of the axes at that position.
  const bool is_geo =
      !view.find<vrml::SFVec3f>(F::position) && view.node->type->behaviour == &vrml::kGeoViewpointBehaviour;
  const dmat4 world_from_node = is_geo ? given_world * vrml::geo_viewpoint_axes(scene, *view.node) : given_world;
  const dvec3 position(world_from_node *
                       glm::dvec4(vector(view, F::position, is_geo ? glm::vec3(0) : glm::vec3(0, 0, 10)), 1));
  const dmat3 rotation =
      rotation_part(world_from_node) * vrml::rotation_matrix(view.get(F::orientation, vrml::Rotation{}));
  state.world_from_camera = dmat4(rotation);
  if (finite(position)) state.world_from_camera[3] = glm::dvec4(position, 1);
  state.up = rotation_part(world_from_node)[1];
  const double volume = std::abs(glm::determinant(dmat3(world_from_node)));
  if (volume > 0 && std::isfinite(volume)) state.scale = std::cbrt(volume);
  const float angle = view.get(F::field_of_view, state.field_of_view);
  if (angle > 0 && angle < std::numbers::pi_v<float>) state.field_of_view = angle;
  if (const auto* edges = view.find<vrml::MFFloat>(F::field_of_view)) {
    // OrthoViewpoint (X3D 23.4.5). The view axis passes through the middle of the rectangle.
    glm::dvec2 lower(-1), upper(1);
    constexpr std::size_t kEdges = 4;
    if (edges->size() >= kEdges) {
      lower = {(*edges)[0], (*edges)[1]};
      upper = {(*edges)[2], (*edges)[3]};
    }
    if (!(upper.x > lower.x) || !(upper.y > lower.y) || !finite(glm::vec2(lower + upper)))
      lower = -(upper = glm::dvec2(1));
    state.extent = (upper - lower) * state.scale;
    state.world_from_camera[3] += glm::dvec4(rotation * dvec3((lower + upper) / 2.0 * state.scale, 0), 0);
  }
  if (const auto* center = view.find<vrml::SFVec3f>(F::center_of_rotation)) {
    const dvec3 place(world_from_node * glm::dvec4(*center, 1));
    if (finite(place)) state.center_of_rotation = place;
  }
  if (is_geo) {
    state.ground = vrml::geo_ground(scene, *view.node, given_world);
    if (const auto center = vrml::geo_viewpoint_center(scene, *view.node))
      state.center_of_rotation = dvec3(given_world * glm::dvec4(*center, 1));
  }
  const auto distance = [&](int field) {
    const auto given = static_cast<float>(view.get(field, -1.0F) * state.scale);
    return given > 0 && finite(given) ? given : 0;
  };
  state.near_distance = distance(F::near_distance);
  state.far_distance = distance(F::far_distance);
  if (state.far_distance <= state.near_distance) state.far_distance = 0;
  state.view_all = view.get(F::view_all, false);
  state.retains_offset = view.get(F::retain_offsets, false);
  return state;
}

void take_distances(RenderList& list, const vrml::Node* bound) {
  const auto of_bound = [&](const ViewpointState& one) { return &one.scene->node(one.node) == bound; };
  const auto viewpoint =
      bound ? std::find_if(list.viewpoints.begin(), list.viewpoints.end(), of_bound) : list.viewpoints.begin();
  const bool found = viewpoint != list.viewpoints.end();
  list.near_distance = found ? viewpoint->near_distance : 0;
  list.far_distance = found ? viewpoint->far_distance : 0;
}

void add_group(ViewpointState& state, const NodeView& group, const dmat4& world_from_group) {
  using F = ViewpointGroupFields;
  constexpr std::size_t kMaxPrefix = 256, kMaxRegions = 4;
  state.listed = state.listed && group.get(F::displayed, true);
  state.group_retains_offset = state.group_retains_offset || group.get(F::retain_offsets, false);
  const auto* const description = group.find<vrml::SFString>(F::description);
  if (description && !description->empty() && state.group.size() < kMaxPrefix)
    state.group += bounded_text(description->view()) + ": ";
  const dvec3 size(group.get(F::size, vrml::SFVec3f(0)));
  if (size.x > 0 && size.y > 0 && size.z > 0 && state.regions.size() < kMaxRegions)
    state.regions.push_back(
        {glm::inverse(world_from_group), dvec3(group.get(F::center, vrml::SFVec3f(0))), size / 2.0});
}

void take_group(ViewpointState& viewpoint, const ViewpointState& other) {
  viewpoint.listed = other.listed;
  viewpoint.group = other.group;
  viewpoint.regions = other.regions;
  viewpoint.group_retains_offset = other.group_retains_offset;
  viewpoint.retains_offset |= other.group_retains_offset;
}

NavigationState navigation_state(const NodeView& view) {
  using F = NavigationFields;
  NavigationState state;
  if (const auto* types = view.find<vrml::MFString>(F::type)) {
    state.types.clear();
    for (std::size_t i = 0; i < std::min(types->size(), kMaxNavigationTypes); ++i)
      state.types.push_back(bounded_text((*types)[i].view()));
  }
  const float largest = std::numeric_limits<float>::max();
  if (const auto* size = view.find<vrml::MFFloat>(F::avatar_size))
    for (std::size_t i = 0; i < std::min(size->size(), state.avatar_size.size()); ++i)
      state.avatar_size[i] = within((*size)[i], 0, largest, state.avatar_size[i]);
  state.speed = number(view, F::speed, 0, largest, 1);
  state.visibility_limit = number(view, F::visibility_limit, 0, largest, 0);
  state.headlight = view.get(F::headlight, true);
  if (const auto* seconds = view.find<vrml::SFTime>(F::transition_time))
    state.transition_seconds = static_cast<float>(within(static_cast<float>(*seconds), 0, largest, 1));
  if (const auto* types = view.find<vrml::MFString>(F::transition_type))
    state.teleports = !types->empty() && (*types)[0].view() == "TELEPORT";
  return state;
}

Background world_background(const NodeView& view, const dmat4& world_from_node, const Images& images) {
  using F = BackgroundFields;
  Background background;
  rings(view, F::sky_color, F::sky_angle, std::numbers::pi_v<float>, background.sky_colors, background.sky_angles);
  rings(view, F::ground_color, F::ground_angle, kHalfPi, background.ground_colors, background.ground_angles);
  if (background.sky_colors.empty()) background.sky_colors.emplace_back(0.0f);
  for (std::size_t face = 0; face < Background::kFaces; ++face) {
    const auto found = images.find({view.node, face});
    if (found != images.end() && found->second && !found->second->empty()) background.panorama[face] = found->second;
  }
  background.transparency = number(view, F::transparency, 0, 1, 0);
  background.world_from_background = glm::mat3(rotation_part(world_from_node));
  return background;
}

Fog world_fog(const NodeView& view, const dmat4& world_from_node) {
  using F = FogFields;
  Fog fog;
  fog.color = color(view, F::color, fog.color);
  if (const auto* type = view.find<vrml::SFString>(F::fog_type)) fog.exponential = type->view() == "EXPONENTIAL";
  fog.visibility_range = number(view, F::visibility_range, 0, std::numeric_limits<float>::max(), 0);
  const dmat3 matrix(world_from_node), inverse = glm::inverse(matrix);
  fog.fog_from_world = glm::mat3(inverse);
  for (int i = 0; i < 3; ++i)
    if (!finite(fog.fog_from_world[i])) return {};
  return fog;
}

glm::dvec4 world_clip_plane(const NodeView& view, const dmat4& world_from_node) {
  constexpr glm::dvec4 kNothing(0, 0, 0, 1);
  const auto* given = view.find<vrml::SFVec4f>(ClipPlaneFields::plane);
  const glm::dvec4 plane = given ? glm::dvec4(*given) : glm::dvec4(0, 1, 0, 0);
  const glm::dvec4 world = glm::transpose(glm::inverse(world_from_node)) * plane;
  const double length = glm::length(dvec3(world));
  return length > 0 && std::isfinite(length) && std::isfinite(world.w) ? world / length : kNothing;
}

ShapeStyle style_of(const NodeView& line, const NodeView& fill, const NodeView& point) {
  constexpr float kMaxPixels = 256;
  constexpr float kLeastPoint = 2;  // points without PointProperties have this size
  ShapeStyle style;
  if (line.kind() == NodeKind::line_properties && line.get(LineFields::applied, true)) {
    style.line_width = number(line, LineFields::width, 1, kMaxPixels, 1);
    style.line_pattern = line_pattern(line.get<vrml::SFInt32>(LineFields::line_type, 1));
  }
  if (fill.kind() == NodeKind::fill_properties) {
    style.filled = fill.get(FillFields::filled, true);
    style.hatched = fill.get(FillFields::hatched, true);
    style.hatch_color = color(fill, FillFields::hatch_color, glm::vec3(1));
    style.hatch_style = fill.get<vrml::SFInt32>(FillFields::hatch_style, 1);
  }
  if (point.kind() != NodeKind::point_properties) return style;
  style.sized_points = true;
  style.point_size = number(point, PointFields::size, 1, kMaxPixels, 1);
  style.point_attenuation = glm::max(vector(point, PointFields::attenuation, {1, 0, 0}), glm::vec3(0));
  style.smallest_point = std::max(number(point, PointFields::smallest, 0, kMaxPixels, 1), kLeastPoint);
  style.largest_point = std::max(number(point, PointFields::largest, 0, kMaxPixels, 1), style.smallest_point);
  // Without attenuation, the limits do not apply: their defaults would make pointSizeScaleFactor useless.
  if (style.point_attenuation == glm::vec3(1, 0, 0) || style.point_attenuation == glm::vec3(0)) {
    style.point_attenuation = {1, 0, 0};
    style.smallest_point = kLeastPoint;
    style.largest_point = kMaxPixels;
  }
  return style;
}

Material material_of(const NodeView& view) {
  using F = MaterialFields;
  Material material;
  material.diffuse = color(view, F::diffuse_color, material.diffuse);
  material.emissive = color(view, F::emissive_color, material.emissive);
  material.specular = color(view, F::specular_color, material.specular);
  material.ambient_intensity = number(view, F::ambient_intensity, 0, 1, material.ambient_intensity);
  material.shininess = number(view, F::shininess, 0, 1, material.shininess);
  material.transparency = number(view, F::transparency, 0, 1, 0);
  material.lit = view.kind() != NodeKind::unlit_material;
  if (!material.lit) material.unlit = material.diffuse = material.emissive;
  if (view.kind() == NodeKind::physical_material) {
    // Colours of physical materials are linear.
    material.diffuse = displayed(material.diffuse);
    material.emissive = displayed(material.emissive);
  }
  return material;
}

float detail_of(const NodeView& view) {
  return view.kind() == NodeKind::qnv ? number(view, QnvFields::detail, 0.01f, 100, 1) : 1.0f;
}

glm::mat3 texture_matrix(const NodeView& view) {
  using F = TextureTransformFields;
  const auto pair = [&](int field, const glm::vec2& otherwise) {
    const auto* value = view.find<vrml::SFVec2f>(field);
    return value && std::isfinite(value->x) && std::isfinite(value->y) ? *value : otherwise;
  };
  const glm::vec2 center = pair(F::center, glm::vec2(0)), scale = pair(F::scale, glm::vec2(1)),
                  translation = pair(F::translation, glm::vec2(0));
  const float given = view.get(F::rotation, 0.0f);
  const float angle = std::isfinite(given) ? given : 0.0f;
  const float c = std::cos(angle), s = std::sin(angle);
  const glm::mat2 linear(scale.x * c, scale.y * s, scale.x * -s, scale.y * c);  // S * R, in columns
  const glm::vec2 offset = linear * (center + translation) - center;
  return {glm::vec3(linear[0], 0), glm::vec3(linear[1], 0), glm::vec3(offset, 1)};
}

Image image_of(const vrml::PixelImage& source) {
  const std::uint64_t width = source.width(), height = source.height(), components = source.components();
  const auto words = source.pixels();
  if (width == 0 || height == 0 || components < 1 || components > 4) return {};
  if (height > words.size() / width) return {};  // there are fewer words than pixels
  Image image{static_cast<std::uint32_t>(width),
              static_cast<std::uint32_t>(height),
              static_cast<std::uint32_t>(components),
              {}};
  image.pixels.resize(width * height * components);
  std::uint8_t* to = image.pixels.data();
  for (std::uint64_t row = height; row-- > 0;)
    for (std::uint64_t column = 0; column < width; ++column)
      for (std::uint64_t component = components; component-- > 0;)
        *to++ = static_cast<std::uint8_t>(words[row * width + column] >> (8 * component));
  return image;
}

}  // namespace gs::render
