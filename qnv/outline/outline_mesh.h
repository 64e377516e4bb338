#pragma once

#include "qnv/outline/outline_groups.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

/// A polygon model as outline groups need it: welded, cleaned, and who is beside whom. Only for them.
namespace gs::qnv::outline {

constexpr std::uint32_t kNone = 0xffffffffu;

/// Faces in half-edges: the half-edge h runs from vertices[h] to vertices[next(h)] with its face to the left.
struct Mesh {
  std::vector<glm::vec3> positions;        // no two are equal
  std::vector<std::uint32_t> vertices;     // where each half-edge begins
  std::vector<std::uint32_t> corners;      // of the model, a half-edge each; empty without texture coordinates
  std::vector<std::uint32_t> faces;        // of each half-edge
  std::vector<std::uint32_t> mates;        // the half-edge back along the same edge, of the same appearance; or kNone
  std::vector<std::uint32_t> begins;       // of each face, in half-edges; one more at the end
  std::vector<std::uint32_t> sources;      // of each face: the polygon of the model
  std::vector<std::uint32_t> appearances;  // of each face
  std::vector<glm::dvec3> normals;         // of each face, unit; 0 where it has no area
  std::vector<double> areas;               // of each face
  std::vector<std::uint8_t> thin;          // of each face: so thin that rounding may have turned its normal anywhere
  double rounding = 0;                     // how far coordinates may be off for being 32 bit floats

  [[nodiscard]] std::size_t face_count() const { return sources.size(); }
  [[nodiscard]] std::uint32_t next(std::uint32_t h) const {
    return h + 1 == begins[faces[h] + 1] ? begins[faces[h]] : h + 1;
  }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return vertices[next(h)]; }
  [[nodiscard]] glm::dvec3 position(std::uint32_t h) const { return {positions[vertices[h]]}; }
};

/// Welds equal positions, drops what is no polygon or there twice, and finds the mates. Where more than two faces meet
/// at an edge, those whose normals agree best are mates.
[[nodiscard]] Mesh make_mesh(const PolygonModel& model, unsigned threads, OutlineCounts& counts);

/// Calls work(begin, end) for ranges that make up 0..count, as parallel_for.
template <typename Work>
bool for_ranges(std::size_t count, std::size_t range, unsigned threads, const Work& work,
                Progress* progress = nullptr) {
  if (count == 0) return true;
  return parallel_for((count - 1) / range + 1,
                      [&](std::size_t i) { work(i * range, std::min(count, (i + 1) * range)); }, threads, progress);
}

/// Twice the vector area of a ring of positions: the cross products around its first.
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

//// Two axes in the plane of a normal, so that counter-clockwise seen from its front is so in them.
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

/// Twice the area of a triangle; positive: counter-clockwise.
inline double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

}  // namespace gs::qnv::outline
