#pragma once

#include "qnv/codecs/displaced/tessellation/surface_cut.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Builder of the vertices and triangles of one patch at the detail of a cut. An object keeps its memory, so reuse it
/// for many patches. One thread at a time.
class PatchMesh {
 public:
  using Triangle = std::array<PatchTable::Number, 3>;

  void build(const PatchSurface& surface, const PatchCut& cut);

  /// Returns the vertices. Memory for eight more vertices after the last one is readable, for loops that read eight at
  /// a time.
  [[nodiscard]] std::span<const PatchVertex> vertices() const { return std::span(vertices_).first(count_); }
  /// Returns one colour per vertex; empty if the surface has no colours.
  [[nodiscard]] const std::vector<Rgb8>& colors() const { return colors_; }
  /// Returns the inner triangles, counter-clockwise seen from outside. border() returns the triangles along the edges.
  [[nodiscard]] std::span<const Triangle> inner() const { return inner_; }
  [[nodiscard]] std::span<const Triangle> border() const { return border_; }

 private:
  /// Side of a triangle that is part of a patch edge. `left` is the number of remaining halvings, `from` the index of
  /// the side's start among the finest positions on the edge.
  struct Side {
    int left = 0;
    std::uint8_t edge = PatchTable::Side::kNone;
    std::uint32_t from = 0;
  };
  void slide_all(std::span<const PatchTable::Middle> middles, float part);
  void refine_edges(const PatchSurface& surface, const PatchCut& cut, int deepest);
  void split(const Triangle& corners, const std::array<Side, 3>& sides);

  std::size_t count_ = 0;
  std::vector<PatchVertex> vertices_;  // with padding at the end
  std::vector<Rgb8> colors_;
  std::array<std::vector<PatchTable::Number>, 3> edges_;  // vertices of each edge, at its own level
  std::vector<PatchTable::Number> before_;
  std::vector<PatchTable::Middle> middles_;
  std::vector<Triangle> split_;
  std::span<const Triangle> inner_, border_;
};

}  // namespace gs::qnv
