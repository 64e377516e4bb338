#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/mesh/manifold.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace gs::qnv::progressive {

using displaced::Corners;
using displaced::kNone;

/// Triangles and neighbours around a vertex, counter-clockwise. Triangle k is between the neighbours k and k + 1. At
/// the mesh's rim, the ring starts at the rim and has one more neighbour than triangles. Inside the mesh, the ring is
/// closed: neighbour 0 follows the last neighbour.
struct VertexRing {
  std::vector<std::uint32_t> corners;  // for each triangle t at the vertex: 3 t + k, where corner k is the vertex
  std::vector<std::uint32_t> neighbours;  // vertex indices
  bool open = false;
};

/// Description of a vertex split. The triangles from neighbour `first` to neighbour `last` move to the new vertex. A
/// new triangle between the old and the new vertex closes the gap at each of the two neighbours, except where a rim
/// omits it.
struct VertexSplit {
  std::uint32_t first = 0, last = 0;  // indices in VertexRing::neighbours; `last` may wrap around
  bool left = true, right = true;  // add a new triangle at `first`; at `last`
};

/// Mesh that grows by vertex splits: triangles, sides and vertices. FORMAT.md, "Splits".
class SplitMesh {
 public:
  SplitMesh() = default;
  explicit SplitMesh(exact::ExactMesh mesh);

  [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<std::uint32_t>& twins() const { return twins_; }
  [[nodiscard]] const std::vector<glm::ivec3>& places() const { return places_; }
  [[nodiscard]] std::vector<glm::ivec3>& places() { return places_; }
  /// Collects the ring of a vertex. A closed ring starts with the corner that has the lowest index. Time is
  /// proportional to the number of triangles around the vertex.
  void ring(std::uint32_t vertex, VertexRing& out) const;
  /// Splits a vertex. The new vertex gets the next index. `ring` must be the ring of `vertex`.
  void split(std::uint32_t vertex, const VertexRing& ring, const VertexSplit& how, const glm::ivec3& place);

 private:
  static std::uint32_t after(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
  static std::uint32_t before(std::uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }
  void join(std::uint32_t side, std::uint32_t other);

  std::vector<Corners> triangles_;
  std::vector<std::uint32_t> twins_;  // adjacent side of each side 3 t + k, from corner k to the next one
  std::vector<std::uint32_t> corners_;  // one corner of each vertex; kNone if it has none
  std::vector<glm::ivec3> places_;
};

}  // namespace gs::qnv::progressive
