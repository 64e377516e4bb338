#pragma once

#include "qnv/surface/surface_cut.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// The vertices and triangles of one patch as a cut has it. Kept from patch to patch, as memory is. One thread.
class PatchMesh {
 public:
  using Triangle = std::array<PatchTable::Number, 3>;

  void build(const PatchSurface& surface, const PatchCut& cut);

  /// Behind the last one there is room for eight more, so that they can be read eight at a time.
  [[nodiscard]] std::span<const PatchVertex> vertices() const { return std::span(vertices_).first(count_); }
  /// One each; empty where the surface has none.
  [[nodiscard]] const std::vector<Rgb8>& colors() const { return colors_; }
  /// Triangles, counter-clockwise seen from outside: those inside, and those along the edges.
  [[nodiscard]] std::span<const Triangle> inner() const { return inner_; }
  [[nodiscard]] std::span<const Triangle> border() const { return border_; }

 private:
  /// A part of an edge that is a side of a triangle: so many halvings are left, and it begins at `from` of the edge's
  /// finest places.
  struct Side {
    int left = 0;
    std::uint8_t edge = PatchTable::Side::kNone;
    std::uint32_t from = 0;
  };
  void slide_all(std::span<const PatchTable::Middle> middles, float part);
  void refine_edges(const PatchSurface& surface, const PatchCut& cut, int deepest);
  void split(const Triangle& corners, const std::array<Side, 3>& sides);

  std::size_t count_ = 0;
  std::vector<PatchVertex> vertices_;  // and room
  std::vector<Rgb8> colors_;
  std::array<std::vector<PatchTable::Number>, 3> edges_;  // numbers of the vertices of an edge, at its own level
  std::vector<PatchTable::Number> before_;
  std::vector<PatchTable::Middle> middles_;
  std::vector<Triangle> split_;
  std::span<const Triangle> inner_, border_;
};

}  // namespace gs::qnv
