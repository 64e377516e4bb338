#pragma once

#include "qnv/displaced/manifold.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::displaced {

/// Deepest subdivision of a base triangle: 4^8 triangles.
inline constexpr int kDeepestPatch = 8;

/// Vertices of a patch's grid: i steps from corner 0 towards corner 1, j towards corner 2.
struct GridPlace {
  std::uint32_t i = 0, j = 0;
};

/// The triangles of a base mesh, each a patch that is divided into 4^level triangles, and how all vertices of a level
/// are numbered: those of the base, then of its edges, then of its triangles, each once.
class Patches {
 public:
  struct Edge {
    std::uint32_t from = 0, to = 0;              // vertices of the base
    std::uint32_t owner = kNone, other = kNone;  // patches beside it; `owner` has the smaller number
    bool crease = false;                         // both sides turn their own way
    /// A line that is seen: the end of the surface, or a crease. Its vertices may move sideways, too.
    [[nodiscard]] bool line() const { return crease || other == kNone; }
  };

  Patches() = default;
  /// `triangles` index `vertices` vertices; each edge has at most one triangle a side.
  Patches(std::vector<Corners> triangles, std::uint32_t vertices);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] std::uint32_t base_vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// The edge from corner k to corner k + 1.
  [[nodiscard]] std::uint32_t edge(std::uint32_t patch, std::uint32_t k) const { return patch_edges_[patch][k]; }
  [[nodiscard]] bool owns(std::uint32_t patch, std::uint32_t k) const {
    return edges_[patch_edges_[patch][k]].owner == patch;
  }
  /// The first patch that a vertex of the base is a corner of; kNone: of none.
  [[nodiscard]] std::uint32_t owner(std::uint32_t vertex) const { return owners_[vertex]; }

  [[nodiscard]] std::size_t vertices_at(int level) const {
    const std::size_t n = std::size_t{1} << level;
    return vertices_ + edges_.size() * (n - 1) + triangles_.size() * ((n - 1) * (n - 2) / 2);
  }
  /// Where the vertices of an edge begin; the t-th (1 to n - 1) from its `from` is t - 1 further.
  [[nodiscard]] std::size_t edge_start(std::uint32_t edge, int level) const {
    return vertices_ + edge * ((std::size_t{1} << level) - 1);
  }
  /// Where the inner vertices of a patch begin, j = 1 first.
  [[nodiscard]] std::size_t inner_start(std::uint32_t patch, int level) const {
    const std::size_t n = std::size_t{1} << level;
    return vertices_ + edges_.size() * (n - 1) + patch * ((n - 1) * (n - 2) / 2);
  }

  /// Says of every edge, by its number, whether it is a crease; rims are none.
  void set_creases(const std::vector<bool>& creases);
  /// The same patches, cut along their creases: what lies beside them has a vertex of its own on either side.
  [[nodiscard]] Patches cut() const;
  [[nodiscard]] bool has_lines() const;

  /// The numbers of all vertices of a patch at a level: those of j = 0 first, n + 1 of them, then n of j = 1, ...
  void grid(std::uint32_t patch, int level, std::vector<std::uint32_t>& indices) const;

 private:
  std::vector<Corners> triangles_;
  std::vector<Edge> edges_;
  std::vector<std::array<std::uint32_t, 3>> patch_edges_;
  std::vector<std::uint32_t> owners_;  // of vertices of the base
  std::uint32_t vertices_ = 0;
};

/// Where row j of a grid of n steps begins.
[[nodiscard]] constexpr std::size_t row_start(std::size_t j, std::size_t n) { return j * (n + 1) - j * (j - 1) / 2; }

}  // namespace gs::qnv::displaced
