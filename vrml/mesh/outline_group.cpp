#include "vrml/mesh/face_set.h"
#include "vrml/mesh/tessellators.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <unordered_map>
#include <vector>

// OutlineGroup (docs/formats.md): polygons of which each stands alone, and outlines that stand for them until they have
// come. Which of the two a group shows is decided here.
namespace gs::vrml {
namespace {

/// Calls each(polygon, first, last) for every polygon of an index list: places of its corners.
template <class Each>
void for_each_polygon(const MFInt32& index, const Each& each) {
  std::size_t polygon = 0;
  for (std::size_t first = 0; first < index.size(); ++polygon) {
    std::size_t last = first;
    while (last < index.size() && index[last] >= 0) ++last;
    each(polygon, first, last);
    first = last + 1;
  }
}

std::int32_t at(const MFInt32& list, std::size_t i, std::int32_t otherwise) {
  return i < list.size() ? list[i] : otherwise;
}

/// What has come of the groups of a node and of the one that refines it.
class Groups {
 public:
  Groups(const SceneGraph& scene, NodeId base, NodeId refiner)
      : sizes_(scene.get<MFInt32>(base, "groupSize")), outline_group_(scene.get<MFInt32>(base, "outlineGroup")) {
    present_.resize(sizes_.size());
    outlined_.resize(sizes_.size());
    count(scene, base);
    if (refiner && refiner != base) count(scene, refiner);
    for_each_polygon(scene.get<MFInt32>(base, "outlineIndex"), [&](std::size_t polygon, std::size_t, std::size_t) {
      if (const auto group = group_of_outline(polygon); knows(group)) outlined_[static_cast<std::size_t>(group)] = true;
    });
  }

  [[nodiscard]] bool shows_polygon(std::int32_t group) const {
    return !knows(group) || done(group) || !outlined_[static_cast<std::size_t>(group)];
  }
  [[nodiscard]] bool shows_outline(std::size_t polygon) const {
    const std::int32_t group = group_of_outline(polygon);
    return !knows(group) || !done(group);
  }

 private:
  void count(const SceneGraph& scene, NodeId node) {
    complete_ = complete_ || scene.get<SFBool>(node, "complete");
    const auto& group = scene.get<MFInt32>(node, "group");
    for_each_polygon(scene.get<MFInt32>(node, "coordIndex"), [&](std::size_t polygon, std::size_t, std::size_t) {
      if (const auto of = at(group, polygon, -1); knows(of)) ++present_[static_cast<std::size_t>(of)];
    });
  }
  [[nodiscard]] std::int32_t group_of_outline(std::size_t polygon) const {
    return at(outline_group_, polygon,
              outline_group_.empty() ? static_cast<std::int32_t>(std::min<std::size_t>(polygon, 0x7fffffff)) : -1);
  }
  [[nodiscard]] bool knows(std::int32_t group) const {
    return group >= 0 && static_cast<std::size_t>(group) < sizes_.size();
  }
  /// All polygons of a group are there; or those are that will ever come, so that one that was lost costs itself only.
  [[nodiscard]] bool done(std::int32_t group) const {
    const auto i = static_cast<std::size_t>(group);
    return sizes_[i] > 0 && present_[i] > 0 && (complete_ || present_[i] >= static_cast<std::uint32_t>(sizes_[i]));
  }

  MFInt32 sizes_, outline_group_;
  std::vector<std::uint32_t> present_;
  std::vector<bool> outlined_;
  bool complete_ = false;
};

/// Positions that are equal get one number, so that polygons that stand alone shade smoothly where they meet.
class PositionWelder {
 public:
  explicit PositionWelder(const MFVec3f& points) : points_(points) { first_.reserve(points.size()); }
  [[nodiscard]] std::int32_t operator()(std::int32_t point) {
    if (static_cast<std::size_t>(point) >= points_.size()) return point;
    const glm::vec3 p = points_[static_cast<std::size_t>(point)] + 0.0f;  // of both zeros the same one
    return first_
        .try_emplace(
            {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y), std::bit_cast<std::uint32_t>(p.z)},
            point)
        .first->second;
  }

 private:
  using Key = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 0x9e3779b97f4a7c15;
      for (const std::uint32_t part : key) h = (h ^ part) * 0xbf58476d1ce4e5b9, h ^= h >> 29;
      return static_cast<std::size_t>(h);
    }
  };
  const MFVec3f& points_;
  std::unordered_map<Key, std::int32_t, Hash> first_;
};

/// Appends the corners of a list, and what is missing for one a position.
void append_coordinates(MFVec2f& to, const MFVec2f& from, std::size_t count) {
  to.append(from.span().first(std::min(from.size(), count)));
  to.resize(to.size() + count - std::min(from.size(), count));
}

}  // namespace

Mesh tessellate_outline_group(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const NodeId refined = scene.resolve_as(scene.get<SFNode>(geometry, "refines"), "OutlineGroup");
  const Groups groups(scene, refined ? refined : geometry, refined ? geometry : options.refiner);
  const auto& points = scene.get<MFVec3f>(geometry, "point");
  const auto& outline = scene.get<MFVec3f>(geometry, "outline");
  const auto& group = scene.get<MFInt32>(geometry, "group");

  FaceSet faces;
  const auto& coord_index = scene.get<MFInt32>(geometry, "coordIndex");
  bool all = true;
  for_each_polygon(coord_index, [&](std::size_t polygon, std::size_t first, std::size_t last) {
    if (groups.shows_polygon(at(group, polygon, -1)))
      faces.coord_index.append(coord_index.span().subspan(first, std::min(last + 1, coord_index.size()) - first));
    else
      all = false;
  });
  if (!faces.coord_index.empty() && faces.coord_index.back() >= 0) faces.coord_index.push_back(-1);
  if (all && faces.coord_index.size() == coord_index.size()) faces.coord_index = coord_index;

  const auto& outline_index = scene.get<MFInt32>(geometry, "outlineIndex");
  const auto behind = static_cast<std::int64_t>(points.size());
  bool outlines = false;
  for_each_polygon(outline_index, [&](std::size_t polygon, std::size_t first, std::size_t last) {
    if (!groups.shows_outline(polygon)) return;
    outlines = true;
    for (std::size_t i = first; i < last; ++i)
      faces.coord_index.push_back(
          static_cast<std::int32_t>(std::min<std::int64_t>(behind + outline_index[i], 0x7fffffff)));
    faces.coord_index.push_back(-1);
  });
  faces.points = points;
  if (outlines) faces.points.append(outline.span());

  const auto& coordinates = scene.get<MFVec2f>(geometry, "texCoord");
  const auto& outline_coordinates = scene.get<MFVec2f>(geometry, "outlineTexCoord");
  const bool textured = options.texture_coordinates && !(coordinates.empty() && outline_coordinates.empty());
  faces.crease_angle = scene.get<SFFloat>(geometry, "creaseAngle");
  const MFInt32 own_index = faces.coord_index;
  if (faces.crease_angle > 0) {
    PositionWelder weld(faces.points);
    std::int32_t* const index = faces.coord_index.mutable_data();
    for (std::size_t i = 0; i < faces.coord_index.size(); ++i)
      if (index[i] >= 0) index[i] = weld(index[i]);
  }
  if (textured) {
    MFVec2f values;
    append_coordinates(values, coordinates, points.size());
    append_coordinates(values, outline_coordinates, faces.points.size() - points.size());
    faces.texture_coordinate = {std::move(values), true, own_index};
  }
  faces.default_texture_coordinates = options.texture_coordinates;
  faces.convex = false;
  faces.solid = scene.get<SFBool>(geometry, "solid");
  return make_mesh(std::move(faces));
}

}  // namespace gs::vrml
