#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/mesh/manifold.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace gs::qnv::progressive {

using displaced::Corners;
using displaced::kNone;

/// Triangles and vertices around a vertex, counter-clockwise: triangle k is between neighbours k and k + 1. At the
/// mesh's rim, the ring starts after the rim and has one more neighbour than triangles; else neighbour 0 follows the
/// last one.
struct VertexRing {
  std::vector<std::uint32_t> corners;     // corners of the triangles: 3 t + k
  std::vector<std::uint32_t> neighbours;  // vertices
  bool open = false;
};

/// Description of a vertex split: the triangles from neighbour `first` to neighbour `last` move to the new vertex. At
/// both neighbours, a triangle between the old and the new vertex closes the gap, unless it is omitted at a rim.
struct VertexSplit {
  std::uint32_t first = 0, last = 0;  // in VertexRing::neighbours; `last` may pass the end: modulo
  bool left = true, right = true;     // add a triangle at `first`, at `last`
};

/// Triangles, sides and vertices of a mesh that grows by vertex splits. FORMAT.md, "Splits".
class SplitMesh {
 public:
  SplitMesh() = default;
  explicit SplitMesh(exact::ExactMesh mesh);

  [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<std::uint32_t>& twins() const { return twins_; }
  [[nodiscard]] const std::vector<glm::ivec3>& places() const { return places_; }
  [[nodiscard]] std::vector<glm::ivec3>& places() { return places_; }
  /// Collects a vertex's ring. A closed ring starts with the smallest corner number. Time is proportional to its
  /// triangles.
  void ring(std::uint32_t vertex, VertexRing& out) const;
  /// Splits a vertex; the new vertex gets the next number. `ring` is the vertex's.
  void split(std::uint32_t vertex, const VertexRing& ring, const VertexSplit& how, const glm::ivec3& place);

 private:
  static std::uint32_t after(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
  static std::uint32_t before(std::uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }
  void join(std::uint32_t side, std::uint32_t other);

  std::vector<Corners> triangles_;
  std::vector<std::uint32_t> twins_;    // of side 3 t + k, from corner k to the next one
  std::vector<std::uint32_t> corners_;  // one corner of each vertex, or kNone
  std::vector<glm::ivec3> places_;
};

}  // namespace gs::qnv::progressive
