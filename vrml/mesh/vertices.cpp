#include "vrml/mesh/vertices.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace gs::vrml {
namespace {

constexpr std::uint32_t kInfinity = 0x7f800000;  // bits of infinity; larger bits are NaN

/// Returns the bits of the largest absolute value; NaN is larger than infinity. Written so that compilers vectorise it.
[[nodiscard]] std::uint32_t largest_bits(std::span<const glm::vec3> points) {
  std::int32_t x = 0, y = 0, z = 0;
  for (const glm::vec3& p : points) {
    x = std::max(x, std::bit_cast<std::int32_t>(p.x) & 0x7fffffff);
    y = std::max(y, std::bit_cast<std::int32_t>(p.y) & 0x7fffffff);
    z = std::max(z, std::bit_cast<std::int32_t>(p.z) & 0x7fffffff);
  }
  return static_cast<std::uint32_t>(std::max({x, y, z}));
}

}  // namespace

UsableVertices::UsableVertices(std::span<const glm::vec3> points) : count_(points.size()) {
  if (largest_bits(points) < kInfinity) return;
  not_finite_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    not_finite_[i] = !(std::isfinite(points[i].x) && std::isfinite(points[i].y) && std::isfinite(points[i].z));
}

Box bounds_of(std::span<const glm::vec3> points, std::span<const std::uint8_t> used) {
  if (std::memchr(used.data(), 0, used.size()) == nullptr) return bounds_of(points);
  Box bounds;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (used[i] != 0) bounds.add(points[i]);
  return bounds;
}

Box bounds_of(std::span<const glm::vec3> points) {
  // Four points fill three registers of four floats each.
  constexpr std::size_t kFloats = 12;
  Box bounds;
  const std::size_t blocks = points.size() / 4;
  if (blocks != 0) {
    std::array<float, kFloats> lower, upper;
    lower.fill(std::numeric_limits<float>::infinity());
    upper.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t block = 0; block < blocks; ++block) {
      std::array<float, kFloats> four;
      std::memcpy(four.data(), points.data() + 4 * block, sizeof(four));
      for (std::size_t i = 0; i < kFloats; ++i) {
        lower[i] = four[i] < lower[i] ? four[i] : lower[i];
        upper[i] = four[i] > upper[i] ? four[i] : upper[i];
      }
    }
    for (std::size_t i = 0; i < kFloats; i += 3) {
      bounds.add({lower[i], lower[i + 1], lower[i + 2]});
      bounds.add({upper[i], upper[i + 1], upper[i + 2]});
    }
  }
  for (const glm::vec3& p : points.subspan(4 * blocks)) bounds.add(p);
  return bounds;
}

MFVec2f default_texture_coordinates(std::span<const glm::vec3> points, const Box& bounds) {
  MFVec2f coordinates;
  coordinates.resize(points.size());
  glm::vec2* next = coordinates.mutable_data();
  if (bounds.empty()) return coordinates;
  const glm::dvec3 lower(bounds.lower), size = glm::dvec3(bounds.upper) - lower;
  int s = 0;
  if (size.y > size[s]) s = 1;
  if (size.z > size[s]) s = 2;
  int t = s == 0 ? 1 : 0;
  for (int axis = t + 1; axis < 3; ++axis)
    if (axis != s && size[axis] > size[t]) t = axis;
  const double scale = size[s] > 0 ? 1 / size[s] : 0;
  for (const glm::vec3& p : points) {
    const glm::dvec2 st((p[s] - lower[s]) * scale, (p[t] - lower[t]) * scale);
    *next++ = glm::vec2(glm::clamp(st, -1e6, 1e6));  // clamps points outside the box, which are not used
  }
  return coordinates;
}

void fit_values(Array<float>& values, std::size_t count) {
  const std::size_t had = values.size();
  if (had == 0 || had == count) return;
  if (had > count) {
    values = Array<float>(values.span().first(count));
    return;
  }
  const float last = values.back();
  values.resize(count);
  std::fill(values.mutable_data() + had, values.mutable_data() + count, last);
}

bool is_translucent(std::span<const float> opacities) {
  return std::any_of(opacities.begin(), opacities.end(), [](float opacity) { return opacity < 1; });
}

bool needs_compaction(std::size_t points, std::size_t corners) { return points > 1024 && points / 4 > corners; }

Compaction compact(std::span<const std::int32_t> coord_index, std::size_t points) {
  Compaction result;
  const std::size_t size = std::bit_ceil(2 * coord_index.size() + 16);
  std::vector<std::uint64_t> table(size, 0);  // entries: old index + 1, new index
  result.index.resize(coord_index.size());
  std::int32_t* out = result.index.mutable_data();
  for (const std::int32_t vertex : coord_index) {
    if (vertex < 0 || static_cast<std::size_t>(vertex) >= points) {
      *out++ = vertex < 0 ? -1 : INT32_MAX;
      continue;
    }
    const std::uint64_t key = static_cast<std::uint64_t>(vertex) + 1;
    std::size_t slot = (key * 0x9e3779b97f4a7c15u >> 32) & (size - 1);
    while (table[slot] != 0 && table[slot] >> 32 != key) slot = (slot + 1) & (size - 1);
    if (table[slot] == 0) {
      table[slot] = key << 32 | result.kept.size();
      result.kept.push_back(static_cast<std::uint32_t>(vertex));
    }
    *out++ = static_cast<std::int32_t>(table[slot] & 0xffffffff);
  }
  return result;
}

}  // namespace gs::vrml
