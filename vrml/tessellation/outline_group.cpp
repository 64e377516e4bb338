#include "vrml/mesh/face_set.h"
#include "vrml/tessellation/tessellators.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string_view>
#include <unordered_map>
#include <vector>

// OutlineGroup (docs/formats.md) has independent polygons, and outlines that represent them until they are received.
// This file selects which of the two is drawn for each group.
namespace gs::vrml {
namespace {

/// Calls each(polygon, first, last) for every polygon of an index list, with the range of its corners.
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

/// Received parts of the groups of a node and of the node that refines it.
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
  /// Reports whether a group is complete: all its polygons are received, or no more will be. Thus a lost polygon
  /// affects only itself.
  [[nodiscard]] bool done(std::int32_t group) const {
    const auto i = static_cast<std::size_t>(group);
    return sizes_[i] > 0 && present_[i] > 0 && (complete_ || present_[i] >= static_cast<std::uint32_t>(sizes_[i]));
  }

  MFInt32 sizes_, outline_group_;
  std::vector<std::uint32_t> present_;
  std::vector<bool> outlined_;
  bool complete_ = false;
};

/// Map from equal positions to one index, so that independent polygons have smooth shading where they meet.
class PositionWelder {
 public:
  explicit PositionWelder(const MFVec3f& points) : points_(points) { first_.reserve(points.size()); }
  [[nodiscard]] std::int32_t operator()(std::int32_t point) {
    if (static_cast<std::size_t>(point) >= points_.size()) return point;
    const glm::vec3 p = points_[static_cast<std::size_t>(point)] + 0.0f;  // turns -0 into +0
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

/// Builder that collects the drawn parts of several nodes.
class Gatherer {
 public:
  Gatherer(const SceneGraph& scene, const Groups& groups) : scene_(scene), groups_(groups) {}

  void add_polygons(NodeId node) {
    const auto& group = scene_.get<MFInt32>(node, "group");
    add(node, "point", "coordIndex", "texCoord",
        [&](std::size_t polygon) { return groups_.shows_polygon(at(group, polygon, -1)); });
  }
  void add_outlines(NodeId node) {
    add(node, "outline", "outlineIndex", "outlineTexCoord",
        [&](std::size_t polygon) { return groups_.shows_outline(polygon); });
  }
  /// Returns the positions, polygons and texture coordinates. The caller sets the other members.
  [[nodiscard]] FaceSet take(float crease_angle, bool textured) {
    faces_.crease_angle = crease_angle;
    const MFInt32 own_index = faces_.coord_index;
    if (crease_angle > 0) {
      PositionWelder weld(faces_.points);
      std::int32_t* const index = faces_.coord_index.mutable_data();
      for (std::size_t i = 0; i < faces_.coord_index.size(); ++i)
        if (index[i] >= 0) index[i] = weld(index[i]);
    }
    if (textured && any_coordinates_) faces_.texture_coordinate = {std::move(coordinates_), true, own_index};
    return std::move(faces_);
  }

 private:
  template <class Shows>
  void add(NodeId node, std::string_view point_field, std::string_view index_field, std::string_view coordinate_field,
           const Shows& shows) {
    const auto& points = scene_.get<MFVec3f>(node, point_field);
    const auto& index = scene_.get<MFInt32>(node, index_field);
    const auto& coordinates = scene_.get<MFVec2f>(node, coordinate_field);
    const std::size_t before = faces_.points.size();
    bool any = false, all = true;
    for_each_polygon(index, [&](std::size_t polygon, std::size_t first, std::size_t last) {
      if (!shows(polygon)) {
        all = false;
        return;
      }
      any = true;
      for (std::size_t i = first; i < last; ++i)
        faces_.coord_index.push_back(static_cast<std::int32_t>(
            std::min<std::int64_t>(static_cast<std::int64_t>(before) + index[i], 0x7fffffff)));
      faces_.coord_index.push_back(-1);
    });
    if (!any) return;
    // If the whole first list is drawn, it is shared instead of copied.
    if (before == 0) {
      faces_.points = points;
      if (all && faces_.coord_index.size() == index.size()) faces_.coord_index = index;
    } else {
      faces_.points.append(points.span());
    }
    any_coordinates_ = any_coordinates_ || !coordinates.empty();
    coordinates_.append(coordinates.span().first(std::min(coordinates.size(), points.size())));
    coordinates_.resize(faces_.points.size());
  }

  const SceneGraph& scene_;
  const Groups& groups_;
  FaceSet faces_;
  MFVec2f coordinates_;
  bool any_coordinates_ = false;
};

}  // namespace

Mesh tessellate_outline_group(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  // A node that refines another one is drawn with that node, so that both are shaded as one surface.
  if (scene.resolve_as(scene.get<SFNode>(geometry, "refines"), NodeKind::outline_group)) return {};
  const Groups groups(scene, geometry, options.refiner);
  const auto entries = [&](NodeId node) {
    return !node ? std::uint64_t{0}
                 : scene.get<MFInt32>(node, "coordIndex").size() + scene.get<MFInt32>(node, "outlineIndex").size() +
                       scene.get<MFVec3f>(node, "point").size() + scene.get<MFVec3f>(node, "outline").size();
  };
  constexpr std::uint64_t kBytesOfEntry = 48;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow((entries(geometry) + entries(options.refiner)) * kBytesOfEntry)) {
    Mesh nothing;
    nothing.limited = true;
    return nothing;
  }
  Gatherer gatherer(scene, groups);
  gatherer.add_polygons(geometry);
  if (options.refiner && options.refiner != geometry) gatherer.add_polygons(options.refiner);
  gatherer.add_outlines(geometry);
  FaceSet faces = gatherer.take(scene.get<SFFloat>(geometry, "creaseAngle"), options.texture_coordinates);
  faces.default_texture_coordinates = options.texture_coordinates;
  faces.convex = false;
  faces.budget = scene.budget();
  faces.solid = scene.get<SFBool>(geometry, "solid");
  return make_mesh(std::move(faces));
}

}  // namespace gs::vrml
