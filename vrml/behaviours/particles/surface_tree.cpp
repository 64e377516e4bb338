#include "vrml/behaviours/particles/surface_tree.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::vrml {
namespace {

constexpr std::uint32_t kLeaf = 4;  // maximum triangles of a leaf

Box box_around_corners(const std::array<glm::vec3, 3>& corners) {
  Box box;
  for (const glm::vec3& corner : corners) box.add(corner);
  return box;
}

glm::vec3 unit_or(const glm::vec3& vector, const glm::vec3& otherwise) {
  const float length = glm::length(vector);
  return length > 0 && std::isfinite(length) ? vector / length : otherwise;
}

// Reports whether a line passes through a box between its start and `end`.
bool passes(const Box& box, const glm::vec3& from, const glm::vec3& inverse, float end) {
  float near = 0, far = end;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = (box.lower[axis] - from[axis]) * inverse[axis], b = (box.upper[axis] - from[axis]) * inverse[axis];
    // A line inside of a flat box gives NaN, which changes nothing.
    near = std::fmax(near, std::fmin(a, b));
    far = std::fmin(far, std::fmax(a, b));
  }
  return near <= far * 1.00001F + 1e-6F;
}

}  // namespace

SurfaceTree::SurfaceTree(const Mesh& mesh) : solid_(mesh.solid) {
  if (mesh.primitive != Mesh::Primitive::triangles) return;
  const glm::vec3 origin(mesh.origin);
  double area = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size() && triangles_.size() < kMaxTriangles; i += 3) {
    Triangle triangle;
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangle.corners[corner] = mesh.positions[mesh.indices[i + corner]] + origin;
    const glm::vec3 cross =
        glm::cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
    const float length = glm::length(cross);
    if (!(length > 0) || !std::isfinite(length)) continue;
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangle.normals[corner] =
          mesh.normals.empty() ? cross / length : unit_or(mesh.normals[mesh.indices[i + corner]], cross / length);
    bounds_.add(box_around_corners(triangle.corners));
    triangles_.push_back(triangle);
  }
  if (triangles_.empty()) return;
  nodes_.reserve(triangles_.size());
  build(0, static_cast<std::uint32_t>(triangles_.size()));
  areas_.reserve(triangles_.size());
  for (const Triangle& t : triangles_) {
    area += double{glm::length(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]))};
    areas_.push_back(area);
  }
}

// Adds the branch of some triangles, and divides them at the median of the longest axis.
void SurfaceTree::build(std::uint32_t first, std::uint32_t last) {
  const std::size_t place = nodes_.size();
  Branch branch;
  for (std::uint32_t i = first; i < last; ++i) branch.box.add(box_around_corners(triangles_[i].corners));
  branch.first = first;
  branch.count = last - first;
  nodes_.push_back(branch);
  if (branch.count <= kLeaf) return;
  const glm::vec3 size = branch.box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle_of = [axis](const Triangle& t) {
    return t.corners[0][axis] + t.corners[1][axis] + t.corners[2][axis];
  };
  const std::uint32_t middle = first + branch.count / 2;
  std::nth_element(triangles_.begin() + first, triangles_.begin() + middle, triangles_.begin() + last,
                   [&](const Triangle& a, const Triangle& b) { return middle_of(a) < middle_of(b); });
  build(first, middle);
  nodes_[place].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[place].count = 0;
  build(middle, last);
}

// Intersects a line with a triangle (Moeller and Trumbore).
std::optional<SurfaceTree::Crossing> SurfaceTree::crossing(const Triangle& triangle, const glm::vec3& from,
                                                           const glm::vec3& direction) {
  const glm::vec3 one = triangle.corners[1] - triangle.corners[0], two = triangle.corners[2] - triangle.corners[0];
  const glm::vec3 p = glm::cross(direction, two);
  const float determinant = glm::dot(one, p);
  if (determinant == 0 || !std::isfinite(determinant)) return std::nullopt;
  const glm::vec3 s = from - triangle.corners[0];
  const float u = glm::dot(s, p) / determinant;
  if (!(u >= 0 && u <= 1)) return std::nullopt;
  const glm::vec3 q = glm::cross(s, one);
  const float v = glm::dot(direction, q) / determinant;
  if (!(v >= 0 && u + v <= 1)) return std::nullopt;
  const float part = glm::dot(two, q) / determinant;
  if (!(part >= 0 && part <= 1)) return std::nullopt;
  return Crossing{part, u, v};
}

// Calls `visit` for each triangle in leaves that the line passes before `end`, which `visit` may lower.
template <class Visit>
void SurfaceTree::visit_near(const glm::vec3& from, const glm::vec3& direction, const float& end,
                             const Visit& visit) const {
  if (nodes_.empty()) return;
  const glm::vec3 inverse = 1.0F / direction;
  std::array<std::uint32_t, 64> waiting;  // the tree is balanced, so its depth is below 20
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t place = waiting[--count];
    const Branch& branch = nodes_[place];
    if (!passes(branch.box, from, inverse, end)) continue;
    if (branch.count == 0) {
      waiting[count++] = branch.first;
      waiting[count++] = place + 1;
      continue;
    }
    for (std::uint32_t i = branch.first; i < branch.first + branch.count; ++i) visit(triangles_[i]);
  }
}

std::optional<SurfaceTree::Hit> SurfaceTree::first_hit(const glm::vec3& from, const glm::vec3& to) const {
  const glm::vec3 direction = to - from;
  float end = 1;
  const Triangle* found = nullptr;
  Crossing at;
  visit_near(from, direction, end, [&](const Triangle& triangle) {
    const auto one = crossing(triangle, from, direction);
    if (!one || one->part > end || (found && one->part == end)) return;
    found = &triangle;
    at = *one;
    end = one->part;
  });
  if (!found) return std::nullopt;
  Hit hit;
  hit.part = at.part;
  hit.point = from + direction * at.part;
  hit.face = glm::normalize(glm::cross(found->corners[1] - found->corners[0], found->corners[2] - found->corners[0]));
  hit.normal =
      unit_or(found->normals[0] * (1 - at.u - at.v) + found->normals[1] * at.u + found->normals[2] * at.v, hit.face);
  return hit;
}

void SurfaceTree::append_crossings(const glm::vec3& from, const glm::vec3& to, std::vector<float>& parts) const {
  const glm::vec3 direction = to - from;
  const float end = 1;
  visit_near(from, direction, end, [&](const Triangle& triangle) {
    if (const auto one = crossing(triangle, from, direction)) parts.push_back(one->part);
  });
}

SurfaceTree::Point SurfaceTree::random_point(ParticleRandom& random) const {
  if (triangles_.empty()) return {};
  const double wanted = double{random.unit()} * areas_.back();
  const auto found = std::upper_bound(areas_.begin(), areas_.end(), wanted);
  const auto place = std::min<std::ptrdiff_t>(found - areas_.begin(), std::ssize(areas_) - 1);
  const Triangle& triangle = triangles_[static_cast<std::size_t>(place)];
  float u = random.unit(), v = random.unit();
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const auto mixed = [&](const std::array<glm::vec3, 3>& values) {
    return values[0] * (1 - u - v) + values[1] * u + values[2] * v;
  };
  return {mixed(triangle.corners), unit_or(mixed(triangle.normals), triangle.normals[0])};
}

// Takes a line along Y through the box at a random place, and a point on it at a random height. The point is accepted
// if it is inside; the line then counts as often as it is long inside.
glm::vec3 SurfaceTree::random_inner_point(ParticleRandom& random) const {
  constexpr int kTries = 24;
  if (triangles_.empty()) return {};
  const glm::vec3 size = bounds_.size();
  std::vector<float> parts;
  glm::vec3 last = triangles_.front().corners[0];
  for (int i = 0; i < kTries; ++i) {
    glm::vec3 from = bounds_.lower + size * glm::vec3(random.unit(), 0, random.unit());
    glm::vec3 to = from;
    from.y -= size.y * 0.01F;
    to.y = bounds_.upper.y + size.y * 0.01F;
    const float height = random.unit();
    parts.clear();
    append_crossings(from, to, parts);
    if (parts.size() < 2) continue;
    std::sort(parts.begin(), parts.end());
    for (std::size_t k = 0; k + 1 < parts.size(); k += 2) {
      last = from + (to - from) * (parts[k] + (parts[k + 1] - parts[k]) * height);
      if (height >= parts[k] && height <= parts[k + 1]) return from + (to - from) * height;
    }
  }
  return last;
}

}  // namespace gs::vrml
