#pragma once

#include "qnv/codecs/displaced/tessellation/surface_cut.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Vertices and triangles of one patch at the detail of a cut. Reuse one object for many patches, to keep its memory.
/// Not thread-safe.
class PatchMesh {
 public:
  using Triangle = std::array<PatchTable::Number, 3>;

  void build(const PatchSurface& surface, const PatchCut& cut);

  /// Returns the vertices. Eight more can be read after the last one, so that loops may read eight at a time.
  [[nodiscard]] std::span<const PatchVertex> vertices() const { return std::span(vertices_).first(count_); }
  /// Returns one colour per vertex; empty if the surface has no colours.
  [[nodiscard]] const std::vector<Rgb8>& colors() const { return colors_; }
  /// Returns the inner triangles, counter-clockwise seen from outside; border() returns those along the edges.
  [[nodiscard]] std::span<const Triangle> inner() const { return inner_; }
  [[nodiscard]] std::span<const Triangle> border() const { return border_; }

 private:
  /// Part of an edge that is a side of a triangle: `left` is the number of remaining halvings, `from` the index of
  /// its start among the edge's finest positions.
  struct Side {
    int left = 0;
    std::uint8_t edge = PatchTable::Side::kNone;
    std::uint32_t from = 0;
  };
  void slide_all(std::span<const PatchTable::Middle> middles, float part);
  void refine_edges(const PatchSurface& surface, const PatchCut& cut, int deepest);
  void split(const Triangle& corners, const std::array<Side, 3>& sides);

  std::size_t count_ = 0;
  std::vector<PatchVertex> vertices_;  // with padding
  std::vector<Rgb8> colors_;
  std::array<std::vector<PatchTable::Number>, 3> edges_;  // vertex numbers of each edge, at the edge's own level
  std::vector<PatchTable::Number> before_;
  std::vector<PatchTable::Middle> middles_;
  std::vector<Triangle> split_;
  std::span<const Triangle> inner_, border_;
};

}  // namespace gs::qnv
