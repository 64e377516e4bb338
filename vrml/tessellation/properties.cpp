#include "vrml/tessellation/properties.h"

#include "vrml/scene/coordinates/geospatial.h"

#include "vrml/scene/coordinates/texture_coordinate_nodes.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace gs::vrml {
namespace {

CoordinateSet set_of(const MFVec2f& points) {
  CoordinateSet set;
  glm::vec4* to = set.prepare(points.size());
  for (const glm::vec2& point : points) *to++ = glm::vec4(point, 0, 1);
  set.commit(points.size());
  return set;
}

CoordinateSet set_of(const MFVec3f& points) {
  CoordinateSet set;
  glm::vec4* to = set.prepare(points.size());
  for (const glm::vec3& point : points) *to++ = glm::vec4(point, 1);
  set.commit(points.size());
  return set;
}

// Returns the coordinates of one node; an empty set for a generator.
CoordinateSet set_of(const SceneGraph& scene, NodeId id) {
  switch (scene.node(id).type->read_as) {
    case NodeKind::texture_coordinate:
      return set_of(scene.get<MFVec2f>(id, "point"));
    case NodeKind::texture_coordinate_3d:
      return set_of(scene.get<MFVec3f>(id, "point"));
    case NodeKind::texture_coordinate_4d:
      return scene.get<MFVec4f>(id, "point");
    default:
      return {};
  }
}

MFVec2f first_two(const CoordinateSet& set) {
  MFVec2f points;
  glm::vec2* to = points.prepare(set.size());
  for (const glm::vec4& point : set) *to++ = glm::vec2(point);
  points.commit(set.size());
  return points;
}

/// Returns the node in a field of a geometry, or the node that represents it. Null if there is none.
NodeId property_node(const SceneGraph& scene, NodeId geometry, const char* field) {
  return scene.resolve(meant_node(scene, field_or(scene, geometry, field, SFNode{}), Role::geometric_property));
}

}  // namespace

TextureCoordinates texture_coordinate_sets_of(const SceneGraph& scene, NodeId geometry) {
  TextureCoordinates result;
  const std::vector<NodeId> nodes = texture_coordinate_nodes(scene, geometry);
  if (nodes.empty()) return result;
  if (nodes.size() == 1 && scene.node(nodes[0]).type->read_as == NodeKind::texture_coordinate) {
    result.first = scene.get<MFVec2f>(nodes[0], "point");
    return result;
  }
  for (const NodeId node : nodes) {
    if (result.sets.size() == kMaxCoordinateSets) break;
    result.sets.push_back(set_of(scene, node));
  }
  const auto filled =
      std::find_if(result.sets.begin(), result.sets.end(), [](const auto& set) { return !set.empty(); });
  if (filled == result.sets.end()) {
    result.sets.clear();
    return result;
  }
  // The sets share one index field, so they need one length.
  std::size_t count = 0;
  for (const CoordinateSet& set : result.sets) count = std::max(count, set.size());
  for (CoordinateSet& set : result.sets) {
    const std::size_t had = set.size();
    set.resize(count);
    glm::vec4* const all = set.mutable_data();
    for (std::size_t i = had; i < count; ++i) all[i] = glm::vec4(0, 0, 0, 1);
  }
  result.first = first_two(*filled);
  return result;
}

void set_texture_coordinates(FaceSet& faces, const SceneGraph& scene, NodeId geometry, MFInt32 index) {
  TextureCoordinates given = texture_coordinate_sets_of(scene, geometry);
  faces.texture_coordinate = {std::move(given.first), true, std::move(index)};
  faces.coordinate_sets = std::move(given.sets);
}

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
  if (kind == NodeKind::geo_coordinate) {
    const GeoFrame frame = GeoFrame::of(scene, scene.node(node));
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& point : scene.get<MFVec3d>(node, "point")) points.push_back(frame.position(point));
    return relative_points(points);
  }
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
