#include "vrml/tessellation/properties.h"

#include "vrml/scene/texture_coordinate_nodes.h"

#include <algorithm>
#include <cmath>

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

}  // namespace gs::vrml
