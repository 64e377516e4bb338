#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include "base/finite.h"
#include "qnv/base/description.h"
#include "qnv/codecs/outlines/grouping/outline_parts.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace gs::qnv::outline {
namespace {

std::optional<OutlineError> problem_of(const PolygonModel& model) {
  constexpr std::size_t kMax = 0xfffffff0u;
  const auto error = [](const std::string& what, std::size_t is, std::size_t expected) {
    return OutlineError{what + ": " + std::to_string(is) + ", expected " + std::to_string(expected)};
  };
  if (model.corners.size() > kMax) return error("too many corners", model.corners.size(), kMax);
  if (model.positions.size() > kMax) return error("too many positions", model.positions.size(), kMax);
  if (!model.appearances.empty() && model.appearances.size() != model.ends.size())
    return error("appearances", model.appearances.size(), model.ends.size());
  if (!model.texture_coordinates.empty() && model.texture_coordinates.size() != model.corners.size())
    return error("texture coordinates", model.texture_coordinates.size(), model.corners.size());
  if (!model.bent.empty() && model.bent.size() != model.ends.size())
    return error("marks of bent polygons", model.bent.size(), model.ends.size());
  if (!std::is_sorted(model.ends.begin(), model.ends.end()))
    return OutlineError{"the ends of polygons are not ascending"};
  if (!model.ends.empty() && model.ends.back() > model.corners.size())
    return error("the last polygon exceeds the corners", model.ends.back(), model.corners.size());
  return std::nullopt;
}

// NaN compares false and becomes 0.
double positive(double x) { return x > 0 ? x : 0; }

OutlineOptions sane(OutlineOptions options) {
  for (double* value :
       {&options.tolerance, &options.angle, &options.merge_tolerance, &options.merge_angle, &options.outline_tolerance})
    *value = positive(*value);
  return options;
}

// Regions that become one polygon each, because their boundary rings are simple. All other faces stay unchanged.
struct Merged {
  std::vector<std::vector<Ring>> rings;  // rings by region; empty if its faces stay unchanged
  std::vector<glm::dvec3> normals;  // normals by region, if it has rings
  std::size_t faces = 0;  // number of faces that merging saves
};

glm::dvec3 normal_of(const Mesh& mesh, std::span<const std::uint32_t> faces) {
  glm::dvec3 sum(0);
  for (const std::uint32_t face : faces) sum += mesh.normals[face] * mesh.areas[face];
  if (glm::length(sum) > 0) return glm::normalize(sum);
  const std::uint32_t largest =
      *std::max_element(faces.begin(), faces.end(), [&](auto a, auto b) { return mesh.areas[a] < mesh.areas[b]; });
  const std::uint32_t begin = mesh.begins[largest];
  sum = ring_area(mesh.begins[largest + 1] - begin,
                  [&](std::size_t i) { return mesh.position(begin + static_cast<std::uint32_t>(i)); });
  return glm::length(sum) > 0 ? glm::normalize(sum) : glm::dvec3(0, 0, 1);
}

// Reports whether a face contains a bridge to a hole. Its ring visits both sides of a bridge.
bool bridged(const Mesh& mesh, std::uint32_t face) {
  for (std::uint32_t h = mesh.begins[face]; h < mesh.begins[face + 1]; ++h)
    if (mesh.mates[h] != kNone && mesh.faces[mesh.mates[h]] == face) return true;
  return false;
}

Merged merge_regions(const Mesh& mesh, const Labels& regions, const FaceLists& lists,
                     std::vector<std::uint8_t>& visited, unsigned threads) {
  Merged merged;
  merged.rings.resize(regions.count);
  merged.normals.resize(regions.count);
  std::atomic<std::size_t> fewer{0};
  for_ranges(regions.count, 256, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto faces = lists[static_cast<std::uint32_t>(i)];
      if (faces.size() == 1 && (mesh.thin[faces[0]] || !bridged(mesh, faces[0]))) continue;
      double area = 0;
      for (const std::uint32_t face : faces) area += mesh.areas[face];
      auto rings = boundary_rings(mesh, regions.of, faces, visited, 1);
      const glm::dvec3 normal = normal_of(mesh, faces);
      if (!bounds_surface(mesh, rings, normal, area)) continue;
      merged.rings[i] = std::move(rings);
      merged.normals[i] = normal;
      fewer.fetch_add(faces.size() - 1, std::memory_order_relaxed);
    }
  });
  merged.faces = fewer;
  return merged;
}

// Sorts polygons by area, largest first.
void largest_first(OutlinePolygons& polygons) {
  if (std::is_sorted(polygons.areas.rbegin(), polygons.areas.rend())) return;
  std::vector<std::uint32_t> order(polygons.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return polygons.areas[a] > polygons.areas[b]; });
  OutlinePolygons sorted;
  sorted.positions.reserve(polygons.positions.size());
  sorted.texture_coordinates.reserve(polygons.texture_coordinates.size());
  sorted.ring_ends.reserve(polygons.ring_ends.size());
  sorted.polygon_ends.reserve(polygons.size());
  sorted.areas.reserve(polygons.size());
  for (const std::uint32_t i : order) {
    const OutlinePolygon polygon = polygons[i];
    const auto first = static_cast<std::uint32_t>(sorted.positions.size());
    sorted.positions.insert(sorted.positions.end(), polygon.positions.begin(), polygon.positions.end());
    sorted.texture_coordinates.insert(sorted.texture_coordinates.end(), polygon.texture_coordinates.begin(),
                                      polygon.texture_coordinates.end());
    for (const std::uint32_t end : polygon.ring_ends) sorted.ring_ends.push_back(end - polygon.first + first);
    sorted.polygon_ends.push_back(static_cast<std::uint32_t>(sorted.ring_ends.size()));
    sorted.areas.push_back(polygon.area);
  }
  polygons = std::move(sorted);
}

// Builder of the groups from the labels of faces.
class Assembly {
 public:
  Assembly(const PolygonModel& model, const Mesh& mesh, const Labels& regions, const Labels& groups,
           const OutlineOptions& options)
      : model_(model),
        mesh_(mesh),
        regions_(regions),
        groups_(groups),
        region_faces_(regions),
        group_faces_(groups),
        options_(options),
        visited_(mesh.vertices.size()),
        merged_(merge_regions(mesh, regions, region_faces_, visited_, options.threads)) {
    const auto kept = [&](const Labels& labels, double tolerance, bool faces_apart) {
      std::vector<std::uint8_t> boundary(mesh.vertices.size());
      for (std::uint32_t h = 0; h < boundary.size(); ++h) {
        const std::uint32_t face = mesh.faces[h], mate = mesh.mates[h];
        boundary[h] = mate == kNone || labels.of[mesh.faces[mate]] != labels.of[face] ||
                      (faces_apart && merged_.rings[regions.of[face]].empty());
      }
      return kept_vertices(mesh, boundary, tolerance);
    };
    exact_ = kept(regions, merge_limits(mesh, options).line, true);
    if (options.outline_tolerance > 0) coarse_ = kept(groups, options.outline_tolerance, false);
  }

  std::vector<OutlineGroup> run(Progress* progress) {
    std::vector<OutlineGroup> made(groups_.count);
    for_ranges(
        groups_.count, 64, options_.threads,
        [&](std::size_t first, std::size_t last) {
          for (std::size_t i = first; i < last; ++i) made[i] = make(static_cast<std::uint32_t>(i));
        },
        progress);
    return made;
  }

  [[nodiscard]] std::size_t merged() const { return merged_.faces; }

 private:
  OutlineGroup make(std::uint32_t label) {
    const auto faces = group_faces_[label];
    OutlineGroup group;
    group.appearance = mesh_.appearances[faces[0]];
    group.polygons = static_cast<std::uint32_t>(faces.size());
    for (const std::uint32_t face : faces) group.area += mesh_.areas[face];
    if (!(group.area > 0)) return group;
    const glm::dvec3 normal = normal_of(mesh_, faces);
    group.normal = glm::vec3(normal);
    measure(faces, normal, group);
    const bool one = add_inner(faces, group.inner);
    if (one && coarse_.empty()) {
      std::swap(group.outline, group.inner);
      return group;
    }
    const PolygonMaker maker(model_, mesh_, coarse_.empty() ? exact_ : coarse_);
    maker.add(boundary_rings(mesh_, groups_.of, faces, visited_, 2), normal, false, group.outline);
    if (one && group.outline.positions == group.inner.positions && group.outline.ring_ends == group.inner.ring_ends)
      group.outline = std::exchange(group.inner, {});
    return group;
  }

  void measure(std::span<const std::uint32_t> faces, const glm::dvec3& normal, OutlineGroup& group) const {
    double low = INFINITY, high = -INFINITY;
    for (const std::uint32_t face : faces)
      for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) {
        const double distance = glm::dot(normal, mesh_.position(h));
        low = std::min(low, distance);
        high = std::max(high, distance);
      }
    group.offset = low + (high - low) / 2;
    group.deviation = (high - low) / 2;
  }

  // Adds inner polygons for `faces`. Returns true if the result is a single polygon with the same boundary as the
  // group.
  bool add_inner(std::span<const std::uint32_t> faces, OutlinePolygons& inner) const {
    const PolygonMaker maker(model_, mesh_, exact_);
    for (const std::uint32_t face : faces) {
      const std::uint32_t region = regions_.of[face];
      if (merged_.rings[region].empty()) {
        if (mesh_.areas[face] > 0) maker.add_face(face, inner);
      } else if (region_faces_[region][0] == face) {
        maker.add(merged_.rings[region], merged_.normals[region], !mesh_.corners.empty(), inner);
      }
    }
    const bool one = inner.size() == 1;
    largest_first(inner);
    return one;
  }

  const PolygonModel& model_;
  const Mesh& mesh_;
  const Labels &regions_, &groups_;
  FaceLists region_faces_, group_faces_;
  const OutlineOptions& options_;
  std::vector<std::uint8_t> visited_;  // per half-edge: bit 1 for regions, bit 2 for groups
  Merged merged_;
  std::vector<std::uint8_t> exact_, coarse_;  // per vertex: kept in polygons; kept in outlines (if
                                              // empty, same as exact_)
};

// Sorts the groups, and sets the group of each polygon of the model.
void finish(const Mesh& mesh, const Labels& labels, std::vector<OutlineGroup> made, OutlineGroups& result) {
  std::vector<std::uint32_t> order(made.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return made[a].area > made[b].area; });
  std::vector<std::uint32_t> place(made.size(), OutlineGroups::kNoGroup);
  for (const std::uint32_t i : order) {
    if (!(made[i].area > 0)) {
      result.counts.degenerate += made[i].polygons;
      continue;
    }
    place[i] = static_cast<std::uint32_t>(result.groups.size());
    result.groups.push_back(std::move(made[i]));
  }
  result.group_of.assign(result.counts.polygons, OutlineGroups::kNoGroup);
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    result.group_of[mesh.sources[face]] = place[labels.of[face]];
}

}  // namespace
}  // namespace gs::qnv::outline

namespace gs::qnv {

OutlinePolygon OutlinePolygons::operator[](std::size_t polygon) const {
  const std::size_t ring = polygon == 0 ? 0 : polygon_ends[polygon - 1], end = polygon_ends[polygon];
  const std::size_t first = ring == 0 ? 0 : ring_ends[ring - 1], last = ring_ends[end - 1];
  OutlinePolygon view;
  view.positions = std::span(positions).subspan(first, last - first);
  if (!texture_coordinates.empty())
    view.texture_coordinates = std::span(texture_coordinates).subspan(first, last - first);
  view.ring_ends = std::span(ring_ends).subspan(ring, end - ring);
  view.first = static_cast<std::uint32_t>(first);
  view.area = areas[polygon];
  return view;
}

std::variant<OutlineGroups, OutlineError> group_outlines(const PolygonModel& model, const OutlineOptions& asked,
                                                         Progress* progress) {
  if (auto problem = outline::problem_of(model)) return std::move(*problem);
  const OutlineOptions options = outline::sane(asked);
  const auto enter = [&](const char* stage, std::size_t total) {
    if (!progress) return true;
    progress->stage = stage;
    progress->done = 0;
    progress->total = total;
    return !progress->cancelled;
  };
  const OutlineError cancelled{"cancelled"};
  OutlineGroups result;
  if (!enter("welding", 1)) return cancelled;
  const outline::Mesh mesh = outline::make_mesh(model, options.threads, result.counts);
  if (!enter("merging", 1)) return cancelled;
  const auto limits = outline::merge_limits(mesh, options);
  const outline::Labels regions = outline::coplanar_regions(model, mesh, limits, options.threads);
  if (!enter("grouping", mesh.face_count())) return cancelled;
  const outline::Labels groups =
      options.tolerance > 0 ? outline::cluster_regions(mesh, regions, options, progress) : regions;
  if (!enter("outlines", groups.count / 64 + 1)) return cancelled;
  outline::Assembly assembly(model, mesh, regions, groups, options);
  auto made = assembly.run(progress);
  if (progress && progress->cancelled) return cancelled;
  result.counts.merged = assembly.merged();
  outline::finish(mesh, groups, std::move(made), result);
  return result;
}

double model_diagonal(const PolygonModel& model) {
  glm::dvec3 lower(INFINITY), upper(-INFINITY);
  for (const glm::vec3& p : model.positions) {
    if (!finite(p)) continue;
    lower = {std::min<double>(lower.x, p.x), std::min<double>(lower.y, p.y), std::min<double>(lower.z, p.z)};
    upper = {std::max<double>(upper.x, p.x), std::max<double>(upper.y, p.y), std::max<double>(upper.z, p.z)};
  }
  return lower.x <= upper.x ? glm::length(upper - lower) : 0;
}

}  // namespace gs::qnv
