#pragma once

#include "qnv/base/description.h"
#include "qnv/base/triangles.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Vertex indices of a triangle's corners, counter-clockwise seen from outside.
using Corners = std::array<std::uint32_t, 3>;

/// Indexed triangle mesh.
struct SurfaceMesh {
  std::vector<glm::vec3> positions;  // units of the source
  std::vector<Rgb8> colors;          // one per vertex, or empty
  std::vector<Corners> triangles;
  std::vector<std::array<glm::vec3, 3>> normals;  // unit shading normals, one per corner; or empty
};

/// Adjacent triangles of each triangle. neighbours[t][k] is across the edge from corner k to corner k + 1; kNone on a
/// rim.
using Neighbours = std::vector<std::array<std::uint32_t, 3>>;
inline constexpr std::uint32_t kNone = 0xffffffff;

/// Builder that collects triangles and welds equal positions.
class MeshBuilder {
 public:
  /// If `colored`, gives each vertex the mean colour at its position. If `apart`, makes separate vertices for different
  /// colours.
  explicit MeshBuilder(bool colored, bool apart = false);
  /// Adds triangles. Skips triangles that are not finite or have no area.
  void add(std::span<const Triangle> triangles);
  /// Returns the number of triangles added so far.
  [[nodiscard]] std::size_t triangles() const { return mesh_.triangles.size(); }
  /// Returns all triangles, welded at equal positions. The mesh may be non-manifold and contain duplicates.
  [[nodiscard]] SurfaceMesh welded() const;
  /// Returns a manifold mesh: every edge has one triangle per side or is a rim, and the triangles around each vertex
  /// form one fan. Drops duplicate triangles. Cuts the surface where more than two triangles meet or orientations
  /// conflict. Fills `beside` with the neighbours unless it is nullptr.
  [[nodiscard]] SurfaceMesh finish(Neighbours* beside = nullptr);

 private:
  std::uint32_t vertex(const glm::vec3& position, Rgb8 color);
  void grow();
  void add_colors(SurfaceMesh& mesh) const;

  bool colored_, apart_;
  SurfaceMesh mesh_;
  std::vector<glm::vec3> sums_;  // sums of the colours at each vertex
  std::vector<std::uint32_t> counts_;  // number of colours at each vertex
  std::vector<Rgb8> own_colors_;  // colour of each vertex, if `apart`
  std::vector<std::uint32_t> table_;  // hash table with open addressing: vertex + 1
};

/// Duplicates vertices so that the mesh becomes manifold. The triangles around each vertex then form one fan, and each
/// edge has at most two triangles, with the same orientation.
void part(SurfaceMesh& mesh);

/// Mesh split into two, without colours and normals: the components with at least a given fraction of the area, and all
/// others. Unused vertices are dropped.
struct SplitMesh {
  SurfaceMesh large, small;
};
[[nodiscard]] SplitMesh split_components(const SurfaceMesh& mesh, double least_part);

/// Returns the neighbours of each triangle in a mesh from MeshBuilder::finish().
[[nodiscard]] Neighbours neighbours_of(std::span<const Corners> triangles);

}  // namespace gs::qnv::displaced
