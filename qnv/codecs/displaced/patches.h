#pragma once

#include "qnv/mesh/manifold.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::displaced {

/// Maximum subdivision level of a base triangle: 4^8 triangles.
inline constexpr int kDeepestPatch = 8;

/// Position in a patch's grid: i steps from corner 0 towards corner 1, and j steps from corner 0 towards corner 2.
struct GridPlace {
  std::uint32_t i = 0, j = 0;
};

/// Triangles of a base mesh. At each level, a triangle becomes a patch of 4^level triangles. Numbers all vertices of a
/// level: base vertices, then edge vertices, then inner vertices. Each vertex has one number.
class Patches {
 public:
  struct Edge {
    std::uint32_t from = 0, to = 0;  // base vertices at the ends
    std::uint32_t owner = kNone, other = kNone;  // adjacent patches; `owner` has the smaller index
    bool crease = false;  // the patches on both sides have separate normals here
    /// Reports whether the edge is a visible line: a rim or a crease. Its vertices may also move sideways.
    [[nodiscard]] bool line() const { return crease || other == kNone; }
  };

  Patches() = default;
  /// `triangles` contain indices below `vertices`. Each edge has at most one triangle per side.
  Patches(std::vector<Corners> triangles, std::uint32_t vertices);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] std::uint32_t base_vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// Returns the edge from corner k to corner k + 1.
  [[nodiscard]] std::uint32_t edge(std::uint32_t patch, std::uint32_t k) const { return patch_edges_[patch][k]; }
  [[nodiscard]] bool owns(std::uint32_t patch, std::uint32_t k) const {
    return edges_[patch_edges_[patch][k]].owner == patch;
  }
  /// Returns the first patch with the base vertex `vertex` as a corner; kNone if there is none.
  [[nodiscard]] std::uint32_t owner(std::uint32_t vertex) const { return owners_[vertex]; }

  [[nodiscard]] std::size_t vertices_at(int level) const {
    const std::size_t n = std::size_t{1} << level;
    return vertices_ + edges_.size() * (n - 1) + triangles_.size() * ((n - 1) * (n - 2) / 2);
  }
  /// Returns the index of the first vertex on an edge. The t-th vertex from `from` (t = 1 to n - 1) has this index plus
  /// t - 1.
  [[nodiscard]] std::size_t edge_start(std::uint32_t edge, int level) const {
    return vertices_ + edge * ((std::size_t{1} << level) - 1);
  }
  /// Returns the index of the first inner vertex of a patch. The row j = 1 comes first.
  [[nodiscard]] std::size_t inner_start(std::uint32_t patch, int level) const {
    const std::size_t n = std::size_t{1} << level;
    return vertices_ + edges_.size() * (n - 1) + patch * ((n - 1) * (n - 2) / 2);
  }

  /// Sets for each edge, by index, whether it is a crease. Rims never become creases.
  void set_creases(const std::vector<bool>& creases);
  /// Returns the patches cut along their creases: the two sides of a crease get separate vertices.
  [[nodiscard]] Patches cut() const;
  [[nodiscard]] bool has_lines() const;

  /// Lists the indices of all vertices of a patch at a level, row by row: n + 1 vertices with j = 0, then n vertices
  /// with j = 1, ...
  void grid(std::uint32_t patch, int level, std::vector<std::uint32_t>& indices) const;

 private:
  std::vector<Corners> triangles_;
  std::vector<Edge> edges_;
  std::vector<std::array<std::uint32_t, 3>> patch_edges_;
  std::vector<std::uint32_t> owners_;  // owner() of each base vertex
  std::uint32_t vertices_ = 0;
};

/// Returns the index of the first vertex of row j in a grid with n steps per edge.
[[nodiscard]] constexpr std::size_t row_start(std::size_t j, std::size_t n) { return j * (n + 1) - j * (j - 1) / 2; }

}  // namespace gs::qnv::displaced
