#include "vrml/tessellation/properties.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace gs::vrml {

namespace {

/// Returns the node in a field of a geometry, or the node that represents it. Null if there is none.
NodeId property_node(const SceneGraph& scene, NodeId geometry, const char* field) {
  return scene.resolve(meant_node(scene, field_or(scene, geometry, field, SFNode{}), Role::geometric_property));
}

}  // namespace

Coordinates relative_points(std::span<const glm::dvec3> points) {
  constexpr double kFar = 8;  // distance from 0, in half extents, up to which float differences are exact enough
  glm::dvec3 lower(HUGE_VAL), upper(-HUGE_VAL);
  for (const glm::dvec3& point : points) {
    if (!std::isfinite(point.x + point.y + point.z)) continue;
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
  }
  Coordinates result;
  const glm::dvec3 center = (lower + upper) * 0.5, half = (upper - lower) * 0.5, away = glm::abs(center);
  if (std::max({away.x, away.y, away.z}) > kFar * std::max({half.x, half.y, half.z}) && lower.x <= upper.x)
    result.origin = center;
  glm::vec3* to = result.points.prepare(points.size());
  for (const glm::dvec3& point : points) *to++ = glm::vec3(point - result.origin);
  result.points.commit(points.size());
  return result;
}

Coordinates coordinates_of(const SceneGraph& scene, NodeId geometry) {
  const NodeId node = property_node(scene, geometry, "coord");
  const NodeKind kind = node ? scene.node(node).type->read_as : NodeKind::other;
  if (kind == NodeKind::coordinate) return {scene.get<MFVec3f>(node, "point")};
  if (kind == NodeKind::coordinate_double) return relative_points(scene.get<MFVec3d>(node, "point").span());
  return {};
}

Colors colors_of(const SceneGraph& scene, NodeId geometry) {
  const NodeId node = property_node(scene, geometry, "color");
  const NodeKind kind = node ? scene.node(node).type->read_as : NodeKind::other;
  if (kind == NodeKind::color) return {scene.get<MFColor>(node, "color"), {}};
  if (kind != NodeKind::color_rgba) return {};
  const MFColorRGBA given = scene.get<MFColorRGBA>(node, "color");
  Colors result;
  Color* color = result.colors.prepare(given.size());
  float* opacity = result.opacities.prepare(given.size());
  for (const ColorRGBA& each : given) {
    *color++ = {each.r, each.g, each.b};
    *opacity++ = each.a;
  }
  result.colors.commit(given.size());
  result.opacities.commit(given.size());
  return result;
}

void set_properties(FaceSet& faces, const SceneGraph& scene, NodeId geometry, MFInt32 color_index,
                    MFInt32 normal_index) {
  Colors colors = colors_of(scene, geometry);
  faces.color = {std::move(colors.colors), scene.get<SFBool>(geometry, "colorPerVertex"), std::move(color_index)};
  faces.opacities = std::move(colors.opacities);
  faces.normal = {normals_of(scene, geometry), scene.get<SFBool>(geometry, "normalPerVertex"), std::move(normal_index)};
  faces.fog_depths = fog_depths_of(scene, geometry);
}

}  // namespace gs::vrml
