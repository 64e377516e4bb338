#pragma once

#include "qnv/codecs/outlines/grouping/outline_groups.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Polygon model that is prepared for outline grouping: welded, cleaned and with adjacency. Internal to
/// group_outlines().
namespace gs::qnv::outline {

constexpr std::uint32_t kNone = 0xffffffffu;

/// Half-edge mesh: half-edge h runs from vertices[h] to vertices[next(h)], with its face to the left.
struct Mesh {
  std::vector<glm::vec3> positions;  // without duplicates
  std::vector<std::uint32_t> vertices;     // start vertex of each half-edge
  std::vector<std::uint32_t> corners;  // corner of the model per half-edge; empty without texture coordinates
  std::vector<std::uint32_t> faces;  // face of each half-edge
  std::vector<std::uint32_t> mates;        // opposite half-edge of the same appearance, or kNone
  std::vector<std::uint32_t> begins;       // first half-edge of each face, and one more at the end
  std::vector<std::uint32_t> sources;  // for each face: index of the model's polygon
  std::vector<std::uint32_t> appearances;  // appearance of each face
  std::vector<glm::dvec3> normals;         // unit normal per face; zero for faces without area
  std::vector<double> areas;  // area of each face
  std::vector<std::uint8_t> thin;  // per face: so thin that rounding may turn its normal in any direction
  double rounding = 0;  // maximum error of coordinates that float32 causes

  [[nodiscard]] std::size_t face_count() const { return sources.size(); }
  [[nodiscard]] std::uint32_t next(std::uint32_t h) const {
    return h + 1 == begins[faces[h] + 1] ? begins[faces[h]] : h + 1;
  }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return vertices[next(h)]; }
  [[nodiscard]] glm::dvec3 position(std::uint32_t h) const { return {positions[vertices[h]]}; }
};

/// Welds equal positions, drops invalid and duplicate polygons, and finds mates. If more than two faces meet at an
/// edge, the faces with the closest normals become mates.
[[nodiscard]] Mesh make_mesh(const PolygonModel& model, unsigned threads, OutlineCounts& counts);

/// Calls work(begin, end) for ranges that together cover 0..count, on several threads.
template <typename Work>
bool for_ranges(std::size_t count, std::size_t range, unsigned threads, const Work& work,
                Progress* progress = nullptr) {
  if (count == 0) return true;
  return parallel_for((count - 1) / range + 1,
                      [&](std::size_t i) { work(i * range, std::min(count, (i + 1) * range)); }, threads, progress);
}

/// Returns twice the vector area of a ring of positions: the sum of cross products around its first position.
template <typename Position>
glm::dvec3 ring_area(std::size_t size, const Position& position) {
  glm::dvec3 sum(0);
  if (size < 3) return sum;
  const glm::dvec3 origin = position(0);
  glm::dvec3 before = position(1) - origin;
  for (std::size_t i = 2; i < size; ++i) {
    const glm::dvec3 here = position(i) - origin;
    sum += glm::dvec3(before.y * here.z - before.z * here.y, before.z * here.x - before.x * here.z,
                      before.x * here.y - before.y * here.x);
    before = here;
  }
  return sum;
}

/// Two axes in the plane of a normal. They preserve orientation: counter-clockwise seen from the front.
struct PlaneAxes {
  explicit PlaneAxes(const glm::dvec3& normal) {
    const glm::dvec3 size(std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z));
    const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                             : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                  : glm::dvec3(0, 0, 1);
    x = glm::normalize(glm::cross(other, normal));
    y = glm::cross(normal, x);
  }
  [[nodiscard]] glm::dvec2 operator()(const glm::dvec3& p) const { return {glm::dot(x, p), glm::dot(y, p)}; }
  glm::dvec3 x{0}, y{0};
};

/// Returns twice the signed area of a triangle; positive if counter-clockwise.
inline double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

}  // namespace gs::qnv::outline
