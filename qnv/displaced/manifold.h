#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/triangles.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// A corner of three vertices, counter-clockwise seen from outside.
using Corners = std::array<std::uint32_t, 3>;

/// Triangles that share their vertices.
struct SurfaceMesh {
  std::vector<glm::vec3> positions;  // units of the source
  std::vector<Rgb8> colors;          // one a vertex, or none at all
  std::vector<Corners> triangles;
  std::vector<std::array<glm::vec3, 3>> normals;  // for shading, a corner each, unit; or none at all
};

/// Triangles beside triangles: neighbours[t][k] lies beside the edge from corner k to corner k + 1; kNone where the
/// mesh ends.
using Neighbours = std::vector<std::array<std::uint32_t, 3>>;
inline constexpr std::uint32_t kNone = 0xffffffff;

/// Gathers triangles and welds what lies at the same place.
class MeshBuilder {
 public:
  /// `colored`: vertices get the mean of the colours at their place; `apart`: other colours are other vertices.
  explicit MeshBuilder(bool colored, bool apart = false);
  /// Triangles that are not finite, or have no area, are left out.
  void add(std::span<const Triangle> triangles);
  /// How many triangles it has.
  [[nodiscard]] std::size_t triangles() const { return mesh_.triangles.size(); }
  /// All that was added, joined where it lies at the same place; triangles may meet in any way, and be there twice.
  [[nodiscard]] SurfaceMesh welded() const;
  /// A mesh in which every edge has one triangle a side or is a rim, and the triangles round every vertex are one fan:
  /// double triangles are left out, and where more than two meet, or two turn different ways, the surface is cut.
  /// `beside`: gets its neighbours.
  [[nodiscard]] SurfaceMesh finish(Neighbours* beside = nullptr);

 private:
  std::uint32_t vertex(const glm::vec3& position, Rgb8 color);
  void grow();
  void add_colors(SurfaceMesh& mesh) const;

  bool colored_, apart_;
  SurfaceMesh mesh_;
  std::vector<glm::vec3> sums_;        // of the colours of a vertex
  std::vector<std::uint32_t> counts_;  // how many
  std::vector<Rgb8> own_colors_;       // of vertices, where others are apart
  std::vector<std::uint32_t> table_;   // open addressing: vertex + 1
};

/// Gives vertices of their own to what is no fan round a vertex, and where more than two triangles meet at an edge, or
/// two turn different ways.
void part(SurfaceMesh& mesh);

/// A mesh in two, without colours and normals: components that have at least this part of the area, and the others.
/// Vertices that neither uses are left out.
struct SplitMesh {
  SurfaceMesh large, small;
};
[[nodiscard]] SplitMesh split_components(const SurfaceMesh& mesh, double least_part);

/// The mesh is as `MeshBuilder::finish` gives it.
[[nodiscard]] Neighbours neighbours_of(std::span<const Corners> triangles);

}  // namespace gs::qnv::displaced
