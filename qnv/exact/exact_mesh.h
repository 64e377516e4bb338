#pragma once

#include "qnv/base/cloud.h"
#include "qnv/displaced/manifold.h"
#include "qnv/exact/shading.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::exact {

/// Places an axis of the lattice on which the vertices of a mesh lie, as a power of two.
inline constexpr int kLeastBits = 8, kMostBits = 20;

/// Where texture coordinates lie: 2^bits places an axis from `lower` on, the last one at lower + size.
inline constexpr int kMostTextureBits = 16;
struct TextureLattice {
  int bits = 0;  // 0: corners have none
  glm::vec2 lower{0}, size{1};
  [[nodiscard]] int top() const { return (1 << bits) - 1; }
  [[nodiscard]] glm::vec2 at(const glm::ivec2& q) const {
    return lower + glm::vec2(q) * (size / static_cast<float>(top()));
  }
};
/// Of the three corners of a triangle, on a TextureLattice.
using CornerCoordinates = std::array<glm::ivec2, 3>;

/// A mesh on a lattice that has 2^bits places along the longest edge of its box. Every edge has one triangle a side or
/// is a rim, and the triangles round every vertex are one fan; where a source is otherwise, several vertices are at the
/// same place.
struct ExactMesh {
  int bits = 11;                     // kLeastBits to kMostBits
  int finest = 0;                    // places are those of a lattice of so many bits, cut off; 0: of `bits`
  int crease_angle = 180;            // degrees, to 180: sides that are farther apart are shaded apart
  Shading shading;                   // of a source: what comes nearest to its normals
  std::vector<glm::ivec3> vertices;  // 0 to 2^bits - 1
  std::vector<Rgb8> colors;          // one a vertex, or none at all
  std::vector<displaced::Corners> triangles;
  TextureLattice texture;
  std::vector<CornerCoordinates> coordinates;     // of each triangle, or none at all: s and t (VRML97 4.6.11)
  std::vector<std::array<glm::vec3, 3>> normals;  // of a source: of each corner, unit or 0; or none at all
  std::vector<std::uint32_t>
      twins;  // as decoded: of side 3 t + k, from corner k to the next one, that beside it, or kNone
};

}  // namespace gs::qnv::exact
