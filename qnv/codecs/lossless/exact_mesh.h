#pragma once

#include "qnv/base/description.h"
#include "qnv/codecs/lossless/shading.h"
#include "qnv/mesh/manifold.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::exact {

/// Minimum and maximum bits of vertex positions. A lattice has 2^bits positions per axis.
inline constexpr int kMinBits = 8, kMaxBits = 20;

/// Lattice of texture coordinates: 2^bits positions per axis, from `lower` to lower + size.
inline constexpr int kMaxTextureBits = 16;
struct TextureLattice {
  int bits = 0;  // 0 means that there are no texture coordinates
  glm::vec2 lower{0}, size{1};
  [[nodiscard]] int top() const { return (1 << bits) - 1; }
  [[nodiscard]] glm::vec2 at(const glm::ivec2& q) const {
    return lower + glm::vec2(q) * (size / static_cast<float>(top()));
  }
};
/// Texture coordinates of a triangle's three corners, on a TextureLattice.
using CornerCoordinates = std::array<glm::ivec2, 3>;

/// Mesh on a lattice with 2^bits positions along the longest edge of its box. Each side of an edge has one triangle or
/// is a rim. The triangles around each vertex form one fan. A non-manifold vertex of the source becomes several
/// vertices at one position.
struct ExactMesh {
  int bits = 11;                     // kMinBits to kMaxBits
  int finest = 0;  // positions are truncated from a lattice with this number of bits; 0 means `bits`
  int crease_angle = 180;  // degrees, 0 to 180; a larger angle between faces is a crease
  Shading shading;  // in sources: the rule that is closest to the normals
  std::vector<glm::ivec3> vertices;  // 0 to 2^bits - 1
  std::vector<Rgb8> colors;          // one per vertex, or empty
  std::vector<displaced::Corners> triangles;
  TextureLattice texture;
  std::vector<CornerCoordinates> coordinates;  // texture coordinates s, t (VRML97 4.6.11) per triangle, or empty
  std::vector<std::array<glm::vec3, 3>> normals;  // in sources: per corner, a unit vector or 0; may be empty
  std::vector<std::uint32_t>
      // in decoded meshes: for side 3 t + k, the side of the other triangle at the same edge, or kNone. Side 3 t + k
      // runs from corner k of triangle t to the next corner.
      twins;
};

}  // namespace gs::qnv::exact
