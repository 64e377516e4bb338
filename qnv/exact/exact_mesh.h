#pragma once

#include "qnv/base/cloud.h"
#include "qnv/displaced/manifold.h"
#include "qnv/exact/shading.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::exact {

/// Places an axis of the lattice on which the vertices of a mesh lie, as a power of two.
inline constexpr int kLeastBits = 8, kMostBits = 20;

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
  std::vector<std::uint32_t>
      twins;  // as decoded: of side 3 t + k, from corner k to the next one, that beside it, or kNone
};

}  // namespace gs::qnv::exact
