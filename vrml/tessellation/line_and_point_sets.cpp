#include "vrml/mesh/attribute.h"
#include "vrml/mesh/vertices.h"
#include "vrml/mesh/welder.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <utility>

namespace gs::vrml {
namespace {

struct LineSet {
  MFInt32 coord_index;
  MFVec3f points;
  Attribute<Color> color;
};

/// Calls segment(corner, polyline) for the segment between the corners `corner - 1` and `corner` of each polyline.
/// Skips segments with an unusable corner, and segments of length 0.
template <class Segment>
void for_each_segment(std::span<const std::int32_t> index, const UsableVertices& vertices, const Segment& segment) {
  std::size_t polyline = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] < 0) {
      ++polyline;
    } else if (i > 0 && index[i - 1] >= 0 && index[i - 1] != index[i] &&
               vertices.contains(static_cast<std::uint32_t>(index[i - 1])) &&
               vertices.contains(static_cast<std::uint32_t>(index[i]))) {
      segment(i, polyline);
    }
  }
}

/// Builds the lines without copying arrays. Works if colours are by vertex or absent.
[[nodiscard]] Mesh share_lines(LineSet& lines, std::span<const std::int32_t> index, const UsableVertices& vertices) {
  Mesh mesh;
  std::vector<std::uint8_t> used(lines.points.size(), 0);
  std::uint32_t* next = mesh.indices.prepare(2 * index.size());
  std::size_t count = 0;
  for_each_segment(index, vertices, [&](std::size_t corner, std::size_t) {
    const auto a = static_cast<std::uint32_t>(index[corner - 1]), b = static_cast<std::uint32_t>(index[corner]);
    used[a] = used[b] = 1;
    next[count++] = a;
    next[count++] = b;
  });
  mesh.indices.commit(count);
  if (count == 0) return {};
  mesh.indices.shrink_to_fit();
  mesh.bounds = bounds_of(lines.points.span(), used);
  if (lines.color.binding != Binding::none) lines.color.fit(lines.points.size(), lines.color.values.back());
  mesh.positions = lines.points;
  mesh.colors = lines.color.values;
  return mesh;
}

[[nodiscard]] Mesh weld_lines(const LineSet& lines, std::span<const std::int32_t> index,
                              const UsableVertices& vertices) {
  Mesh mesh;
  Welder welder(lines.points.size());
  for_each_segment(index, vertices, [&](std::size_t corner, std::size_t polyline) {
    for (const std::size_t end : {corner - 1, corner}) {
      VertexParts parts;
      parts.position = static_cast<std::uint32_t>(index[end]);
      parts.color = lines.color.find_or_nearest(end, parts.position, polyline);
      mesh.indices.push_back(welder.add(parts, parts.position));
    }
  });
  if (mesh.indices.empty()) return mesh;
  mesh.positions = gather(lines.points, welder.vertices(), &VertexParts::position, glm::vec3(0));
  mesh.colors = gather(lines.color.values, welder.vertices(), &VertexParts::color, Color{1, 1, 1});
  mesh.bounds = bounds_of(mesh.positions.span());
  return mesh;
}

[[nodiscard]] Mesh make_lines(LineSet lines) {
  if (lines.coord_index.empty() || lines.points.empty()) return {};
  lines.color.simplify(lines.coord_index.span());
  if (needs_compaction(lines.points.size(), readable(lines.coord_index).size())) {
    Compaction compaction = compact(readable(lines.coord_index), lines.points.size());
    if (lines.color.binding == Binding::by_vertex)
      lines.color.values = gather(lines.color.values, compaction.kept, lines.color.values.back());
    lines.points = gather(lines.points, compaction.kept, glm::vec3(0));
    lines.coord_index = std::move(compaction.index);
    if (lines.points.empty()) return {};
  }
  const std::span<const std::int32_t> index = readable(lines.coord_index);
  const UsableVertices vertices(lines.points.span());
  const bool shared = lines.color.binding == Binding::by_vertex || lines.color.binding == Binding::none;
  return shared ? share_lines(lines, index, vertices) : weld_lines(lines, index, vertices);
}

}  // namespace

Mesh tessellate_indexed_line_set(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  LineSet lines;
  lines.coord_index = scene.get<MFInt32>(geometry, "coordIndex");
  lines.points = coordinates_of(scene, geometry);
  lines.color = {colors_of(scene, geometry), scene.get<SFBool>(geometry, "colorPerVertex"),
                 scene.get<MFInt32>(geometry, "colorIndex")};
  constexpr std::uint64_t kBytesOfEntry = 60, kBytesOfPoint = 25;
  Share share(scene.budget(), Resource::meshes);
  const bool allowed = share.grow(lines.coord_index.size() * kBytesOfEntry + lines.points.size() * kBytesOfPoint);
  Mesh mesh = allowed ? make_lines(std::move(lines)) : Mesh{};
  mesh.limited = !allowed;
  mesh.primitive = Mesh::Primitive::lines;
  mesh.solid = false;
  mesh.lit = false;
  return mesh;
}

Mesh tessellate_point_set(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  Mesh mesh;
  mesh.primitive = Mesh::Primitive::points;
  mesh.solid = false;
  mesh.lit = false;
  const MFVec3f points = coordinates_of(scene, geometry);
  if (points.empty() || points.size() > kMaximumCorners) return mesh;
  constexpr std::uint64_t kBytesOfOne = 17;
  Share share(scene.budget(), Resource::meshes);
  if (!share.grow(points.size() * kBytesOfOne)) {
    mesh.limited = true;
    return mesh;
  }
  const UsableVertices vertices(points.span());
  std::uint32_t* next = mesh.indices.prepare(points.size());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (vertices.contains(i)) {
      next[count++] = i;
      mesh.bounds.add(points[i]);
    }
  mesh.indices.commit(count);
  if (count == 0) {
    mesh.indices.clear();
    return mesh;
  }
  Attribute<Color> color(colors_of(scene, geometry), true, {});
  if (color.binding != Binding::none) color.fit(points.size(), color.values.back());
  mesh.positions = points;
  mesh.colors = color.values;
  return mesh;
}

}  // namespace gs::vrml
