#include "qnv/codecs/outlines/grouping/outline_parts.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace gs::qnv::outline {
namespace {

// Maximum angle in radians between normals of exact merging. Shading changes with its sine: by 1/4000 of an 8-bit step.
// Hardly any pixel in 20 pictures changes.
constexpr double kExactAngle = 1e-6;
constexpr double kTextureTolerance = 1e-5;  // maximum error relative to the texture's width

struct RegionPlane {
  glm::dvec3 normal{0}, origin{0};
  double offset = 0;  // distance of the plane from the origin

  [[nodiscard]] double distance(const glm::dvec3& p) const { return glm::dot(normal, p - origin) - offset; }
};

// Texture coordinates as an affine map of the positions.
struct TextureMap {
  glm::dvec3 origin{0}, along_s{0}, along_t{0};
  glm::dvec2 at_origin{0};

  [[nodiscard]] glm::dvec2 operator()(const glm::dvec3& p) const {
    return at_origin + glm::dvec2(glm::dot(along_s, p - origin), glm::dot(along_t, p - origin));
  }
};

class RegionGrower {
 public:
  RegionGrower(const PolygonModel& model, const Mesh& mesh, const MergeLimits& limits)
      : model_(model),
        mesh_(mesh),
        limits_(limits),
        stamps_(mesh.face_count(), kNone),
        budget_(256 * std::uint64_t{mesh.vertices.size()} + 4096) {
    labels_.of.assign(mesh.face_count(), kNone);
  }

  Labels run(unsigned threads) {
    for (const std::uint32_t seed : seeds(threads))
      if (labels_.of[seed] == kNone && work_ < budget_) grow(seed);
    for (std::uint32_t& label : labels_.of)
      if (label == kNone) label = labels_.count++;
    labels_.renumber();
    return std::move(labels_);
  }

 private:
  // Returns the faces that have a neighbour in their plane; large faces first, because their planes are most precise.
  std::vector<std::uint32_t> seeds(unsigned threads) {
    std::vector<std::uint8_t> flat(mesh_.face_count());
    for_ranges(mesh_.face_count(), 1u << 14, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t face = first; face < last; ++face)
        flat[face] = has_flat_neighbour(static_cast<std::uint32_t>(face));
    });
    std::vector<std::pair<double, std::uint32_t>> order;
    for (std::uint32_t face = 0; face < flat.size(); ++face)
      if (flat[face]) order.emplace_back(-mesh_.areas[face], face);
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> faces;
    faces.reserve(order.size());
    for (const auto& entry : order) faces.push_back(entry.second);
    return faces;
  }

  [[nodiscard]] bool has_flat_neighbour(std::uint32_t face) const {
    constexpr std::size_t kMany = 64;  // skips faces with more corners: each neighbour would test them all
    if (mesh_.thin[face]) return false;
    const RegionPlane plane = plane_of(face);
    for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) {
      if (mesh_.mates[h] == kNone) continue;
      const std::uint32_t other = mesh_.faces[mesh_.mates[h]];
      if (other != face && (corners_of(other) > kMany || fits(other, plane, 4, nullptr))) return true;
    }
    return false;
  }

  [[nodiscard]] std::size_t corners_of(std::uint32_t face) const { return mesh_.begins[face + 1] - mesh_.begins[face]; }

  [[nodiscard]] RegionPlane plane_of(std::uint32_t face) const {
    glm::dvec3 center(0);
    for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) center += mesh_.position(h);
    return {mesh_.normals[face], center / static_cast<double>(corners_of(face)), 0};
  }

  [[nodiscard]] bool fits(std::uint32_t face, const RegionPlane& plane, double slack, const TextureMap* map) const {
    if (limits_.exact && !model_.bent.empty() && model_.bent[mesh_.sources[face]] != 0) return false;
    if (mesh_.areas[face] > 0 && (limits_.exact || !mesh_.thin[face])) {
      const glm::dvec3 apart = mesh_.normals[face] - plane.normal;
      if (!(glm::dot(apart, apart) <= limits_.angle * limits_.angle * slack * slack)) return false;
    }
    for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) {
      const glm::dvec3 p = mesh_.position(h);
      if (!(std::fabs(plane.distance(p)) <= limits_.distance * slack)) return false;
      if (map && !same_texture((*map)(p), model_.texture_coordinates[mesh_.corners[h]])) return false;
    }
    return true;
  }

  static bool same_texture(const glm::dvec2& a, const glm::dvec2& b) {
    return std::fabs(a.x - b.x) <= kTextureTolerance && std::fabs(a.y - b.y) <= kTextureTolerance;
  }

  // Returns the map that the largest triangle around the face's first corner defines.
  [[nodiscard]] std::optional<TextureMap> map_of(std::uint32_t face) const {
    const std::uint32_t begin = mesh_.begins[face], end = mesh_.begins[face + 1];
    const auto texture = [&](std::uint32_t h) { return glm::dvec2(model_.texture_coordinates[mesh_.corners[h]]); };
    const glm::dvec3 origin = mesh_.position(begin);
    double largest = 0;
    std::uint32_t at = 0;
    for (std::uint32_t h = begin + 1; h + 1 < end; ++h) {
      const double area = glm::length(glm::cross(mesh_.position(h) - origin, mesh_.position(h + 1) - origin));
      if (area > largest) {
        largest = area;
        at = h;
      }
    }
    if (!(largest > 0)) return std::nullopt;
    const glm::dvec3 a = mesh_.position(at) - origin, b = mesh_.position(at + 1) - origin;
    const glm::dvec3 normal = glm::cross(a, b) / largest;
    const glm::dvec3 to_a = glm::cross(b, normal) / largest, to_b = glm::cross(normal, a) / largest;  // dual basis
    const glm::dvec2 ta = texture(at) - texture(begin), tb = texture(at + 1) - texture(begin);
    return TextureMap{origin, to_a * ta.x + to_b * tb.x, to_a * ta.y + to_b * tb.y, texture(begin)};
  }

  // Collects in region_ the connected faces around `seed` that fit the plane. If `adapt`, updates the plane from these
  // faces.
  void collect(std::uint32_t seed, RegionPlane& plane, double slack, const TextureMap* map, bool adapt) {
    ++stamp_;
    region_.assign(1, seed);
    stamps_[seed] = stamp_;
    glm::dvec3 sum = mesh_.normals[seed] * mesh_.areas[seed];
    glm::dvec3 moment = (plane.origin - origin_) * mesh_.areas[seed];
    double area = mesh_.areas[seed], next = area * 1.5;
    for (std::size_t i = 0; i < region_.size(); ++i) {
      const std::uint32_t face = region_[i];
      for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) {
        if (mesh_.mates[h] == kNone) continue;
        const std::uint32_t other = mesh_.faces[mesh_.mates[h]];
        if (labels_.of[other] != kNone || stamps_[other] == stamp_) continue;
        work_ += corners_of(other);
        if (!fits(other, plane, slack, map)) continue;
        stamps_[other] = stamp_;
        region_.push_back(other);
        if (!adapt || mesh_.thin[other]) continue;
        area += mesh_.areas[other];
        sum += mesh_.normals[other] * mesh_.areas[other];
        moment += (plane_of(other).origin - origin_) * mesh_.areas[other];
        if (area < next) continue;
        next = area * 1.5;
        plane = {glm::normalize(sum), origin_ + moment / area, 0};
      }
    }
    if (adapt) plane = {glm::normalize(sum), origin_ + moment / area, 0};
  }

  // Grows a region in two rounds, because small faces give imprecise planes. The first round finds the plane of the
  // region, the second its faces.
  void grow(std::uint32_t seed) {
    const RegionPlane own = plane_of(seed);
    std::optional<TextureMap> map;
    if (!mesh_.corners.empty()) {
      map = map_of(seed);
      if (!map) return;
    }
    const TextureMap* texture = map ? &*map : nullptr;
    if (!fits(seed, own, 1, texture)) return;
    origin_ = own.origin;
    RegionPlane plane = own;
    collect(seed, plane, 2, texture, true);
    if (region_.size() == 1) return;
    double lowest = INFINITY, highest = -INFINITY;
    for (const std::uint32_t face : region_)
      for (std::uint32_t h = mesh_.begins[face]; h < mesh_.begins[face + 1]; ++h) {
        const double distance = plane.distance(mesh_.position(h));
        lowest = std::min(lowest, distance);
        highest = std::max(highest, distance);
      }
    plane.offset = (lowest + highest) / 2;
    if (!fits(seed, plane, 1, texture)) plane = own;
    collect(seed, plane, 1, texture, false);
    if (region_.size() == 1) return;
    for (const std::uint32_t face : region_) labels_.of[face] = labels_.count;
    ++labels_.count;
  }

  const PolygonModel& model_;
  const Mesh& mesh_;
  const MergeLimits& limits_;
  Labels labels_;
  std::vector<std::uint32_t> stamps_, region_;
  std::uint32_t stamp_ = 0;
  glm::dvec3 origin_{0};
  std::uint64_t work_ = 0, budget_;  // work in visited corners; the limit prevents quadratic cost
};

}  // namespace

void Labels::renumber() {
  std::vector<std::uint32_t> number(count, kNone);
  std::uint32_t next = 0;
  for (std::uint32_t& label : of) {
    if (number[label] == kNone) number[label] = next++;
    label = number[label];
  }
  count = next;
}

FaceLists::FaceLists(const Labels& labels) : begins_(std::size_t{labels.count} + 1), faces_(labels.of.size()) {
  for (const std::uint32_t label : labels.of) ++begins_[label + 1];
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  std::vector<std::uint32_t> at(begins_.begin(), begins_.end() - 1);
  for (std::uint32_t face = 0; face < labels.of.size(); ++face) faces_[at[labels.of[face]]++] = face;
}

MergeLimits merge_limits(const Mesh& mesh, const OutlineOptions& options) {
  // Drops no vertices: graphics hardware rounds corners to fractions of pixels, so that dropping a corner from a
  // straight edge changes nearby samples.
  if (!(options.merge_tolerance > 0)) return {2 * mesh.rounding, kExactAngle, -1, true};
  const double distance = std::max(options.merge_tolerance, 2 * mesh.rounding);
  // The distance between two unit vectors is twice the sine of half their angle.
  return {distance, 2 * std::sin(std::clamp(options.merge_angle, kExactAngle, 1.0) / 2), distance, false};
}

Labels coplanar_regions(const PolygonModel& model, const Mesh& mesh, const MergeLimits& limits, unsigned threads) {
  return RegionGrower(model, mesh, limits).run(threads);
}

}  // namespace gs::qnv::outline
