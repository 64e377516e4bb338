#pragma once

#include "qnv/displaced/manifold.h"
#include "qnv/exact/exact_mesh.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace gs::qnv::progressive {

using displaced::Corners;
using displaced::kNone;

/// What lies round a vertex, counter-clockwise: triangle k is between neighbours k and k + 1. Where the mesh ends there,
/// it begins behind the end, and has one neighbour more than triangles; else neighbour 0 follows the last one.
struct VertexRing {
  std::vector<std::uint32_t> corners;     // of the triangles: 3 t + k
  std::vector<std::uint32_t> neighbours;  // vertices
  bool open = false;
};

/// How a vertex becomes two: the triangles from neighbour `first` to neighbour `last` go to the new one, and beside
/// both of these a triangle between old and new closes the gap, unless it is left out at an end of the mesh.
struct VertexSplit {
  std::uint32_t first = 0, last = 0;  // of VertexRing::neighbours; last may be behind the end: modulo
  bool left = true, right = true;     // a triangle at `first`, at `last`
};

/// Triangles, sides and vertices of a mesh that grows vertex by vertex. FORMAT.md, "Splits".
class SplitMesh {
 public:
  SplitMesh() = default;
  explicit SplitMesh(exact::ExactMesh mesh);

  [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<std::uint32_t>& twins() const { return twins_; }
  [[nodiscard]] const std::vector<glm::ivec3>& places() const { return places_; }
  [[nodiscard]] std::vector<glm::ivec3>& places() { return places_; }
  /// Where the mesh does not end, the ring begins with the least corner. Time is in proportion to its triangles.
  void ring(std::uint32_t vertex, VertexRing& out) const;
  /// The new vertex has the next number. `ring`: of the vertex.
  void split(std::uint32_t vertex, const VertexRing& ring, const VertexSplit& how, const glm::ivec3& place);

 private:
  static std::uint32_t after(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
  static std::uint32_t before(std::uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }
  void join(std::uint32_t side, std::uint32_t other);

  std::vector<Corners> triangles_;
  std::vector<std::uint32_t> twins_;    // of side 3 t + k, from corner k to the next one
  std::vector<std::uint32_t> corners_;  // a corner of each vertex; kNone: it has none
  std::vector<glm::ivec3> places_;
};

}  // namespace gs::qnv::progressive
