#include "qnv/mesh/triangle_tree.h"

#include "base/parallel.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace gs::qnv::displaced {
namespace {

constexpr std::uint32_t kLeaf = 4;
constexpr int kSplitsInTurn = 3;
constexpr std::size_t kDeepest = 64;  // stack size: a tree of 2^32 triangles divides by four per level, and at
                                      // each level three of four children wait
constexpr float kNowhere = 1e30f;

/// Node, or leaf of `count` triangles, that waits on the stack; and the distance to its box.
struct Waiting {
  std::uint32_t first, count;
  float distance;
};

/// Returns the numbers of triangles of the four children of a node with `count` triangles. 0 means no child.
std::array<std::uint32_t, 4> quarters(std::uint32_t count) {
  if (count <= kLeaf) return {count, 0, 0, 0};
  std::array<std::uint32_t, 4> parts{};
  std::size_t i = 0;
  for (const std::uint32_t half : {count / 2, count - count / 2}) {
    if (half > kLeaf) parts[i++] = half / 2;
    parts[i++] = half > kLeaf ? half - half / 2 : half;
  }
  return parts;
}

/// Returns the point nearest to p on the triangle a, a + ab, a + ac (C. Ericson, Real-Time Collision Detection, 5.1.5).
glm::vec3 nearest_on(const glm::vec3& p, const glm::vec3& a, const glm::vec3& ab, const glm::vec3& ac) {
  const glm::vec3 b = a + ab, c = a + ac, ap = p - a;
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

/// Reports whether the mask is set in any lane.
template <typename Mask>
bool any(const Mask& mask) {
  const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(mask);
  return (halves[0] | halves[1]) != 0;
}

/// Pushes the children that are nearer than `most`, the nearest child last.
template <typename Four>
void push_near(const Four& distances, float most, const std::array<std::uint32_t, 4>& first,
               const std::array<std::uint32_t, 4>& count, std::array<Waiting, kDeepest>& stack, std::size_t& top) {
  if (!any(distances <= most)) return;
  const std::size_t bottom = top;
  for (std::size_t slot = 0; slot < 4; ++slot) {
    if (!(distances[slot] <= most)) continue;
    std::size_t at = top++;
    for (; at > bottom && stack[at - 1].distance < distances[slot]; --at) stack[at] = stack[at - 1];
    stack[at] = {first[slot], count[slot], distances[slot]};
  }
}

}  // namespace

TriangleTree::TriangleTree(const SurfaceMesh& mesh, unsigned threads) : mesh_(mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  if (count == 0) return;
  std::vector<Centre> centres;
  centres.reserve(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Corners& corners = mesh.triangles[t];
    centres.push_back(
        {(mesh.positions[corners[0]] + mesh.positions[corners[1]] + mesh.positions[corners[2]]) / 3.0f, t});
  }
  const Size size = size_of(count);
  nodes_.resize(size.nodes);
  leaves_.resize(size.leaves);
  // Splits the tree level by level first, then builds the resulting parts in parallel. The numbers of triangles
  // determine all indices.
  std::vector<Part> parts{{0, count, 0, 0}};
  for (int depth = 0; depth < kSplitsInTurn; ++depth) {
    std::vector<std::vector<Part>> below(parts.size());
    parallel_for(
        parts.size(), [&](std::size_t i) { split(centres, parts[i], below[i]); }, threads);
    parts.clear();
    for (const auto& some : below) parts.insert(parts.end(), some.begin(), some.end());
  }
  parallel_for(
      parts.size(),
      [&](std::size_t i) {
        std::vector<Part> left{parts[i]};
        while (!left.empty()) {
          const Part part = left.back();
          left.pop_back();
          split(centres, part, left);
        }
      },
      threads);
  // Visits the nodes backwards: parents precede their descendants.
  for (std::size_t n = nodes_.size(); n-- > 0;)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (nodes_[n].count[slot] != 0 || nodes_[n].first[slot] == 0) continue;
      const Node& child = nodes_[nodes_[n].first[slot]];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        float lower = child.lower[axis][0], upper = child.upper[axis][0];
        for (std::size_t k = 1; k < 4 && child.lower[axis][k] != kNowhere; ++k) {
          lower = std::min(lower, child.lower[axis][k]);
          upper = std::max(upper, child.upper[axis][k]);
        }
        nodes_[n].lower[axis][slot] = lower;
        nodes_[n].upper[axis][slot] = upper;
      }
    }
}

/// Returns the numbers of nodes and leaves below a node with `count` triangles, including that node.
TriangleTree::Size TriangleTree::size_of(std::uint32_t count) {
  const auto known = sizes_.find(count);
  if (known != sizes_.end()) return known->second;
  Size size{1, 0};
  for (const std::uint32_t part : quarters(count)) {
    const Size below = part == 0 ? Size{0, 0} : part <= kLeaf ? Size{0, 1} : size_of(part);
    size.nodes += below.nodes;
    size.leaves += below.leaves;
  }
  return sizes_[count] = size;
}

TriangleTree::Size TriangleTree::known_size(std::uint32_t count) const {
  return count <= kLeaf ? Size{0, 1} : sizes_.at(count);
}

/// Partitions triangles at the median along the longest side of their box.
void TriangleTree::halve(std::vector<Centre>& centres, std::uint32_t first, std::uint32_t count) const {
  const auto begin = centres.begin() + first;
  Box box;
  for (std::uint32_t i = 0; i < count; ++i) box.add(begin[i].place);
  const glm::vec3 size = box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  put_middle(begin, begin + count / 2, begin + count, axis);
}

void TriangleTree::split(std::vector<Centre>& centres, const Part& part, std::vector<Part>& below) {
  if (part.count > kLeaf) {
    halve(centres, part.first, part.count);
    const std::uint32_t half = part.count / 2;
    if (half > kLeaf) halve(centres, part.first, half);
    if (part.count - half > kLeaf) halve(centres, part.first + half, part.count - half);
  }
  Node& node = nodes_[part.node];
  Part child{part.first, 0, part.node + 1, part.leaf};
  std::size_t slot = 0;
  for (const std::uint32_t count : quarters(part.count)) {
    for (std::size_t axis = 0; axis < 3; ++axis) node.lower[axis][slot] = node.upper[axis][slot] = kNowhere;
    child.count = count;
    if (count > kLeaf) {
      node.first[slot] = child.node;
      below.push_back(child);
    } else if (count > 0) {
      add_leaf(centres, child, node, slot);
    }
    if (count > 0) {
      const Size size = known_size(count);
      child.first += count;
      child.node += size.nodes;
      child.leaf += size.leaves;
    }
    ++slot;
  }
}

void TriangleTree::add_leaf(const std::vector<Centre>& centres, const Part& part, Node& parent, std::size_t slot) {
  parent.first[slot] = part.leaf;
  parent.count[slot] = part.count;
  Leaf& leaf = leaves_[part.leaf];
  Box box;
  for (std::uint32_t i = 0; i < kLeaf; ++i) {
    // Pads the leaf with its last triangle.
    const std::uint32_t t = centres[part.first + std::min(i, part.count - 1)].triangle;
    const Corners& corners = mesh_.triangles[t];
    const glm::vec3 a = mesh_.positions[corners[0]], b = mesh_.positions[corners[1]], c = mesh_.positions[corners[2]];
    const glm::vec3 cross = glm::cross(b - a, c - a);
    const float length = glm::length(cross);
    const glm::vec3 normal = length > 0 ? cross / length : glm::vec3(0);
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      leaf.a[at][i] = a[axis];
      leaf.ab[at][i] = b[axis] - a[axis];
      leaf.ac[at][i] = c[axis] - a[axis];
      leaf.normal[at][i] = normal[axis];
    }
    leaf.triangle[i] = t;
    for (const glm::vec3& p : {a, b, c}) box.add(p);
  }
  for (int axis = 0; axis < 3; ++axis) {
    parent.lower[static_cast<std::size_t>(axis)][slot] = box.lower[axis];
    parent.upper[static_cast<std::size_t>(axis)][slot] = box.upper[axis];
  }
}

SurfacePoint TriangleTree::along(const glm::vec3& from, const glm::vec3& direction, float reach,
                                 const glm::vec3& facing, float least) const {
  SurfacePoint found;
  if (nodes_.empty()) return found;
  float nearest = reach;
  std::array<float, 3> inverse{};
  for (int axis = 0; axis < 3; ++axis)
    inverse[static_cast<std::size_t>(axis)] = 1 / (std::abs(direction[axis]) > 1e-20f ? direction[axis] : 1e-20f);
  std::array<Waiting, kDeepest> stack;
  std::size_t top = 0;
  stack[top++] = {0, 0, 0};
  while (top > 0) {
    const Waiting next = stack[--top];
    if (next.distance > nearest) continue;
    if (next.count == 0) {
      const Node& node = nodes_[next.first];
      Four near = Four{} - nearest, far = Four{} + nearest;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float p = from[static_cast<int>(axis)];
        const Four a = (node.lower[axis] - p) * inverse[axis], b = (node.upper[axis] - p) * inverse[axis];
        const Four low = a < b ? a : b, high = a < b ? b : a;
        near = near > low ? near : low;
        far = far < high ? far : high;
      }
      const Four zero{}, behind = zero - far;
      Four distance = near > behind ? near : behind;
      distance = distance > zero ? distance : zero;
      distance = near > far ? zero + kNowhere : distance;
      push_near(distance, nearest, node.first, node.count, stack, top);
      continue;
    }
    const Leaf& leaf = leaves_[next.first];
    const auto dot = [](const std::array<Four, 3>& a, const std::array<Four, 3>& b) {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    const auto cross = [](const std::array<Four, 3>& a, const std::array<Four, 3>& b) {
      return std::array<Four, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const auto all = [](const glm::vec3& v) { return std::array<Four, 3>{Four{} + v.x, Four{} + v.y, Four{} + v.z}; };
    const std::array<Four, 3> d = all(direction), across = cross(d, leaf.ac);
    const Four determinant = dot(leaf.ab, across);
    const std::array<Four, 3> to{from.x - leaf.a[0], from.y - leaf.a[1], from.z - leaf.a[2]};
    const std::array<Four, 3> turned = cross(to, leaf.ab);
    const Four u = dot(to, across) / determinant, v = dot(d, turned) / determinant;
    const Four distances = dot(leaf.ac, turned) / determinant;
    const Four turns = dot(leaf.normal, all(facing));
    const auto missed = (turns < least) | (u < -1e-5f) | (v < -1e-5f) | (u + v > 1.00001f);
    if (!any(~missed)) continue;
    for (std::size_t k = 0; k < next.count; ++k) {
      if (missed[k] || !(std::abs(determinant[k]) >= 1e-30f) || !(std::abs(distances[k]) < nearest)) continue;
      nearest = std::abs(distances[k]);
      found = {leaf.triangle[k], from + distances[k] * direction, distances[k]};
    }
  }
  return found;
}

SurfacePoint TriangleTree::on(std::uint32_t triangle, const glm::vec3& from, const glm::vec3& direction,
                              float reach) const {
  const Corners& t = mesh_.triangles[triangle];
  const glm::vec3 a = mesh_.positions[t[0]], ab = mesh_.positions[t[1]] - a, ac = mesh_.positions[t[2]] - a;
  const glm::vec3 across = glm::cross(direction, ac), to = from - a, turned = glm::cross(to, ab);
  const float determinant = glm::dot(ab, across);
  if (!(std::abs(determinant) >= 1e-30f)) return {};
  const float u = glm::dot(to, across) / determinant, v = glm::dot(direction, turned) / determinant;
  const float distance = glm::dot(ac, turned) / determinant;
  if (u < 0 || v < 0 || u + v > 1 || !(std::abs(distance) < reach)) return {};
  return {triangle, from + distance * direction, distance};
}

SurfacePoint TriangleTree::nearest(const glm::vec3& from, float reach, const glm::vec3& facing, float least) const {
  SurfacePoint found;
  if (nodes_.empty()) return found;
  float squared = reach * reach;
  std::array<Waiting, kDeepest> stack;
  std::size_t top = 0;
  stack[top++] = {0, 0, 0};
  while (top > 0) {
    const Waiting next = stack[--top];
    if (next.distance > squared) continue;
    if (next.count == 0) {
      const Node& node = nodes_[next.first];
      Four distance{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float p = from[static_cast<int>(axis)];
        const Four below = node.lower[axis] - p, above = p - node.upper[axis], zero{};
        Four outside = below > above ? below : above;
        outside = outside > zero ? outside : zero;
        distance += outside * outside;
      }
      push_near(distance, squared, node.first, node.count, stack, top);
      continue;
    }
    const Leaf& leaf = leaves_[next.first];
    for (std::size_t k = 0; k < next.count; ++k) {
      const auto at = [k](const std::array<Four, 3>& of) { return glm::vec3(of[0][k], of[1][k], of[2][k]); };
      if (glm::dot(at(leaf.normal), facing) < least) continue;
      const glm::vec3 p = nearest_on(from, at(leaf.a), at(leaf.ab), at(leaf.ac));
      const float d = glm::dot(p - from, p - from);
      if (!(d < squared)) continue;
      squared = d;
      found = {leaf.triangle[k], p, std::sqrt(d)};
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
  constexpr float kCurve = 0.5f;  // this value preserves a sphere
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
