#include "qnv/displaced/triangle_tree.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace gs::qnv::displaced {
namespace {

constexpr std::uint32_t kLeaf = 4;

float squared_distance(const Box& box, const glm::vec3& p) {
  const glm::vec3 d = glm::max(glm::max(box.lower - p, p - box.upper), glm::vec3(0));
  return glm::dot(d, d);
}

/// Of a triangle, the place nearest to p (C. Ericson, Real-Time Collision Detection, 5.1.5).
glm::vec3 nearest_on(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const glm::vec3 bp = p - b;
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / std::max(d1 - d3, 1e-30f));
  const glm::vec3 cp = p - c;
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / std::max(d2 - d6, 1e-30f));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return b + (c - b) * ((d4 - d3) / std::max((d4 - d3) + (d5 - d6), 1e-30f));
  const float sum = va + vb + vc;
  if (!(sum > 0)) return a;
  return a + ab * (vb / sum) + ac * (vc / sum);
}

}  // namespace

TriangleTree::TriangleTree(const SurfaceMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<glm::vec3> centres;
  centres.reserve(order_.size());
  normals_.reserve(order_.size());
  for (const Corners& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    centres.push_back((a + b + c) / 3.0f);
    const glm::vec3 cross = glm::cross(b - a, c - a);
    const float length = glm::length(cross);
    normals_.push_back(length > 0 ? cross / length : glm::vec3(0));
  }
  nodes_.reserve(order_.size());
  nodes_.emplace_back();
  if (!order_.empty()) build(0, 0, static_cast<std::uint32_t>(order_.size()), centres);
}

void TriangleTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t count,
                         std::vector<glm::vec3>& centres) {
  Box box, middles;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const std::uint32_t v : mesh_.triangles[order_[i]]) box.add(mesh_.positions[v]);
    middles.add(centres[order_[i]]);
  }
  nodes_[node].box = box;
  if (count <= kLeaf) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  const glm::vec3 size = middles.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
  });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_.emplace_back();
  nodes_.emplace_back();
  build(children, first, half, centres);
  build(children + 1, first + half, count - half, centres);
}

SurfacePoint TriangleTree::along(const glm::vec3& from, const glm::vec3& direction, float reach,
                                 const glm::vec3& facing, float least) const {
  SurfacePoint found;
  float nearest = reach;
  std::array<std::uint32_t, 64> stack{};
  std::size_t top = 0;
  stack[top++] = 0;
  const glm::vec3 inverse = 1.0f / direction;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    float near = -nearest, far = nearest;
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] == 0) {
        if (from[axis] < node.box.lower[axis] || from[axis] > node.box.upper[axis]) far = -1e30f;
        continue;
      }
      const float a = (node.box.lower[axis] - from[axis]) * inverse[axis];
      const float b = (node.box.upper[axis] - from[axis]) * inverse[axis];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    if (near > far) continue;
    if (node.count == 0) {
      stack[top++] = node.first;
      stack[top++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t t = order_[i];
      if (glm::dot(normals_[t], facing) < least) continue;
      const Corners& corners = mesh_.triangles[t];
      const glm::vec3 a = mesh_.positions[corners[0]];
      const glm::vec3 ab = mesh_.positions[corners[1]] - a, ac = mesh_.positions[corners[2]] - a;
      const glm::vec3 across = glm::cross(direction, ac);
      const float determinant = glm::dot(ab, across);
      if (std::abs(determinant) < 1e-30f) continue;
      const glm::vec3 to = from - a;
      const float u = glm::dot(to, across) / determinant;
      const glm::vec3 turned = glm::cross(to, ab);
      const float v = glm::dot(direction, turned) / determinant;
      if (u < -1e-5f || v < -1e-5f || u + v > 1.00001f) continue;
      const float distance = glm::dot(ac, turned) / determinant;
      if (!(std::abs(distance) < nearest)) continue;
      nearest = std::abs(distance);
      found = {t, from + distance * direction, distance};
    }
  }
  return found;
}

SurfacePoint TriangleTree::nearest(const glm::vec3& from, float reach, const glm::vec3& facing, float least) const {
  SurfacePoint found;
  float squared = reach * reach;
  std::array<std::uint32_t, 64> stack{};
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    if (squared_distance(node.box, from) > squared) continue;
    if (node.count == 0) {
      const bool swap =
          squared_distance(nodes_[node.first].box, from) < squared_distance(nodes_[node.first + 1].box, from);
      stack[top++] = node.first + (swap ? 1 : 0);
      stack[top++] = node.first + (swap ? 0 : 1);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t t = order_[i];
      if (glm::dot(normals_[t], facing) < least) continue;
      const Corners& corners = mesh_.triangles[t];
      const glm::vec3 p =
          nearest_on(from, mesh_.positions[corners[0]], mesh_.positions[corners[1]], mesh_.positions[corners[2]]);
      const float d = glm::dot(p - from, p - from);
      if (!(d < squared)) continue;
      squared = d;
      found = {t, p, std::sqrt(d)};
    }
  }
  return found;
}

glm::vec3 TriangleTree::weights(const SurfacePoint& point) const {
  const Corners& t = mesh_.triangles[point.triangle];
  const glm::vec3 p = point.position, a = mesh_.positions[t[0]], b = mesh_.positions[t[1]], c = mesh_.positions[t[2]];
  const glm::vec3 cross = glm::cross(b - a, c - a);
  const float squared = glm::dot(cross, cross);
  if (!(squared > 0)) return {1, 0, 0};
  const float u = glm::dot(glm::cross(c - b, p - b), cross) / squared;
  const float v = glm::dot(glm::cross(a - c, p - c), cross) / squared;
  return {u, v, 1 - u - v};
}

glm::vec3 TriangleTree::smooth(const SurfacePoint& point) const {
  if (mesh_.normals.empty() || point.triangle == kNone) return point.position;
  constexpr float kCurve = 0.5f;  // a sphere stays one
  const Corners& t = mesh_.triangles[point.triangle];
  const glm::vec3 at = weights(point);
  glm::vec3 bend(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 n = mesh_.normals[point.triangle][k];
    bend += at[static_cast<int>(k)] * glm::dot(mesh_.positions[t[k]] - point.position, n) * n;
  }
  return point.position + kCurve * bend;
}

}  // namespace gs::qnv::displaced
