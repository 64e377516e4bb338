#include "vrml/mesh/attribute.h"
#include "vrml/mesh/vertices.h"
#include "vrml/mesh/welder.h"
#include "vrml/tessellation/line_set.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::vrml {
namespace {

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
  const std::size_t count_of_points = lines.points.size();
  if (lines.color.binding != Binding::none) lines.color.fit(count_of_points, lines.color.values.back());
  fit_values(lines.opacities, count_of_points);
  mesh.positions = lines.points;
  mesh.colors = lines.color.values;
  mesh.opacities = lines.opacities;
  mesh.fog_depths = lines.fog_depths;
  mesh.normals = lines.normals;
  return mesh;
}

/// Sets the arrays of a mesh from the parts of its vertices.
void set_vertices(Mesh& mesh, const LineSet& lines, std::span<const VertexParts> vertices) {
  mesh.positions = gather(lines.points, vertices, &VertexParts::position, glm::vec3(0));
  if (!lines.color.values.empty())
    mesh.colors = gather(lines.color.values, vertices, &VertexParts::color, Color{1, 1, 1});
  if (!lines.opacities.empty()) mesh.opacities = gather(lines.opacities, vertices, &VertexParts::color, 1.0f);
  if (!lines.fog_depths.empty()) mesh.fog_depths = gather(lines.fog_depths, vertices, &VertexParts::position, 0.0f);
  if (!lines.normals.empty())
    mesh.normals = gather(lines.normals, vertices, &VertexParts::position, glm::vec3(0, 0, 1));
}

/// Builds the lines with own vertices for each polyline, so that each vertex has a length from the start of its
/// polyline.
[[nodiscard]] Mesh measure_lines(const LineSet& lines, std::span<const std::int32_t> index,
                                 const UsableVertices& vertices) {
  Mesh mesh;
  std::vector<VertexParts> made;
  std::size_t previous = SIZE_MAX;
  double length = 0;
  for_each_segment(index, vertices, [&](std::size_t corner, std::size_t polyline) {
    const auto add = [&](std::size_t end) {
      VertexParts parts;
      parts.position = static_cast<std::uint32_t>(index[end]);
      parts.color = lines.color.find_or_nearest(end, parts.position, polyline);
      made.push_back(parts);
      mesh.texture_coordinates.push_back({static_cast<float>(length), 0});
    };
    if (previous != corner - 1) {
      length = 0;
      add(corner - 1);
    }
    const auto at = [&](std::size_t end) { return lines.points[static_cast<std::size_t>(index[end])]; };
    length += glm::distance(glm::dvec3(at(corner - 1)), glm::dvec3(at(corner)));
    add(corner);
    mesh.indices.push_back(static_cast<std::uint32_t>(made.size() - 2));
    mesh.indices.push_back(static_cast<std::uint32_t>(made.size() - 1));
    previous = corner;
  });
  if (mesh.indices.empty()) return {};
  set_vertices(mesh, lines, made);
  mesh.bounds = bounds_of(mesh.positions.span());
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
  set_vertices(mesh, lines, welder.vertices());
  mesh.bounds = bounds_of(mesh.positions.span());
  return mesh;
}

/// Fits normals to the points and normalises them. Removes all normals if one has no direction.
void fit_normals(MFVec3f& normals, std::size_t points) {
  if (normals.size() < points || points == 0) return normals.clear();
  if (normals.size() > points) normals = MFVec3f(normals.span().first(points));
  glm::vec3* normal = normals.mutable_data();
  for (std::size_t i = 0; i < points; ++i) {
    const float square = glm::dot(normal[i], normal[i]);
    if (!(square > 0) || !std::isfinite(square)) return normals.clear();
    normal[i] /= std::sqrt(square);
  }
}

[[nodiscard]] Mesh build_lines(LineSet lines) {
  if (lines.coord_index.empty() || lines.points.empty()) return {};
  fit_normals(lines.normals, lines.points.size());
  fit_values(lines.fog_depths, lines.points.size());
  lines.color.simplify(lines.coord_index.span());
  if (needs_compaction(lines.points.size(), readable(lines.coord_index).size())) {
    Compaction compaction = compact(readable(lines.coord_index), lines.points.size());
    const auto keep = [&](auto& values) {
      if (!values.empty()) values = gather(values, compaction.kept, values.back());
    };
    if (lines.color.binding == Binding::by_vertex) {
      keep(lines.color.values);
      keep(lines.opacities);
    }
    keep(lines.fog_depths);
    keep(lines.normals);
    lines.points = gather(lines.points, compaction.kept, glm::vec3(0));
    lines.coord_index = std::move(compaction.index);
    if (lines.points.empty()) return {};
  }
  const std::span<const std::int32_t> index = readable(lines.coord_index);
  const UsableVertices vertices(lines.points.span());
  const bool shared = lines.color.binding == Binding::by_vertex || lines.color.binding == Binding::none;
  return lines.lengths ? measure_lines(lines, index, vertices)
         : shared      ? share_lines(lines, index, vertices)
                       : weld_lines(lines, index, vertices);
}

/// Reads the nodes in the fields of a line set or point set, except colours.
void read_properties(LineSet& lines, const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  Coordinates coordinates = coordinates_of(scene, geometry);
  lines.points = std::move(coordinates.points);
  lines.origin = coordinates.origin;
  lines.fog_depths = fog_depths_of(scene, geometry);
  lines.normals = normals_of(scene, geometry);
  lines.lengths = options.line_lengths;
}

}  // namespace

Mesh make_lines(LineSet lines, const std::shared_ptr<Budget>& budget) {
  constexpr std::uint64_t kBytesOfEntry = 60, kBytesOfPoint = 25;
  const glm::dvec3 origin = lines.origin;
  Share share(budget, Resource::meshes);
  const bool allowed = share.grow(lines.coord_index.size() * kBytesOfEntry + lines.points.size() * kBytesOfPoint);
  Mesh mesh = allowed ? build_lines(std::move(lines)) : Mesh{};
  mesh.limited = !allowed;
  mesh.primitive = Mesh::Primitive::lines;
  mesh.solid = false;
  mesh.lit = !mesh.normals.empty();
  mesh.translucent = is_translucent(mesh.opacities.span());
  mesh.origin = origin;
  return mesh;
}

Mesh tessellate_indexed_line_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  LineSet lines;
  read_properties(lines, scene, geometry, options);
  lines.coord_index = scene.get<MFInt32>(geometry, "coordIndex");
  Colors colors = colors_of(scene, geometry);
  lines.color = {std::move(colors.colors), scene.get<SFBool>(geometry, "colorPerVertex"),
                 scene.get<MFInt32>(geometry, "colorIndex")};
  lines.opacities = std::move(colors.opacities);
  return make_lines(std::move(lines), scene.budget());
}

Mesh tessellate_line_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  LineSet lines;
  read_properties(lines, scene, geometry, options);
  Colors colors = colors_of(scene, geometry);
  lines.color = {std::move(colors.colors), true, {}};
  lines.opacities = std::move(colors.opacities);
  std::size_t next = 0;
  const std::size_t points = std::min(lines.points.size(), kMaximumCorners / 2);
  for (const std::int32_t given : scene.get<MFInt32>(geometry, "vertexCount")) {
    const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(std::max(given, 0)), points - next);
    for (std::size_t i = 0; i < count; ++i) lines.coord_index.push_back(static_cast<std::int32_t>(next + i));
    if (count > 0) lines.coord_index.push_back(-1);
    next += count;
    if (next == points) break;
  }
  return make_lines(std::move(lines), scene.budget());
}

Mesh make_points(PointCloud cloud, const std::shared_ptr<Budget>& budget) {
  Mesh mesh;
  mesh.primitive = Mesh::Primitive::points;
  mesh.solid = false;
  mesh.lit = false;
  const std::size_t size = cloud.points.size();
  if (size == 0 || size > kMaximumCorners) return mesh;
  constexpr std::uint64_t kBytesOfOne = 17;
  Share share(budget, Resource::meshes);
  if (!share.grow(size * kBytesOfOne)) {
    mesh.limited = true;
    return mesh;
  }
  const UsableVertices vertices(cloud.points.span());
  std::uint32_t* next = mesh.indices.prepare(size);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < size; ++i)
    if (vertices.contains(i)) {
      next[count++] = i;
      mesh.bounds.add(cloud.points[i]);
    }
  mesh.indices.commit(count);
  if (count == 0) {
    mesh.indices.clear();
    return mesh;
  }
  Attribute<Color> color(std::move(cloud.colors), true, {});
  if (color.binding != Binding::none) color.fit(size, color.values.back());
  fit_values(cloud.opacities, size);
  fit_values(cloud.fog_depths, size);
  fit_normals(cloud.normals, size);
  mesh.positions = std::move(cloud.points);
  mesh.colors = std::move(color.values);
  mesh.opacities = std::move(cloud.opacities);
  mesh.fog_depths = std::move(cloud.fog_depths);
  mesh.normals = std::move(cloud.normals);
  mesh.lit = !mesh.normals.empty();
  mesh.translucent = is_translucent(mesh.opacities.span());
  mesh.origin = cloud.origin;
  return mesh;
}

Mesh tessellate_point_set(const SceneGraph& scene, NodeId geometry, const MeshOptions&) {
  Coordinates coordinates = coordinates_of(scene, geometry);
  Colors colors = colors_of(scene, geometry);
  return make_points({std::move(coordinates.points), std::move(colors.colors), std::move(colors.opacities),
                      fog_depths_of(scene, geometry), normals_of(scene, geometry), coordinates.origin},
                     scene.budget());
}

}  // namespace gs::vrml
