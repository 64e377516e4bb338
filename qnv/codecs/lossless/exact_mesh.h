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

/// Lattice bits of vertex positions: the lattice has 2^bits positions per axis.
inline constexpr int kMinBits = 8, kMaxBits = 20;

/// Lattice of texture coordinates: 2^bits positions per axis, from `lower` to lower + size.
inline constexpr int kMaxTextureBits = 16;
struct TextureLattice {
  int bits = 0;  // 0: no texture coordinates
  glm::vec2 lower{0}, size{1};
  [[nodiscard]] int top() const { return (1 << bits) - 1; }
  [[nodiscard]] glm::vec2 at(const glm::ivec2& q) const {
    return lower + glm::vec2(q) * (size / static_cast<float>(top()));
  }
};
/// Texture coordinates of a triangle's three corners, on a TextureLattice.
using CornerCoordinates = std::array<glm::ivec2, 3>;

/// Mesh on a lattice with 2^bits positions along the longest edge of its box. Each side of an edge has one triangle or
/// is a rim, and the triangles around each vertex form one fan. Non-manifold sources get several vertices at one
/// position.
struct ExactMesh {
  int bits = 11;                     // kMinBits to kMaxBits
  int finest = 0;                    // bits of the lattice of which positions are truncated; 0 means `bits`
  int crease_angle = 180;            // degrees, 0 to 180; larger angles between faces are shaded as creases
  Shading shading;                   // of a source: the rule closest to its normals
  std::vector<glm::ivec3> vertices;  // 0 to 2^bits - 1
  std::vector<Rgb8> colors;          // one per vertex, or empty
  std::vector<displaced::Corners> triangles;
  TextureLattice texture;
  std::vector<CornerCoordinates> coordinates;     // s and t (VRML97 4.6.11) of each triangle, or empty
  std::vector<std::array<glm::vec3, 3>> normals;  // of a source: one per corner, unit or 0; or empty
  std::vector<std::uint32_t>
      // Decoded meshes: for side 3 t + k, from corner k to the next one, the side on the other triangle, or kNone.
      twins;
};

}  // namespace gs::qnv::exact
