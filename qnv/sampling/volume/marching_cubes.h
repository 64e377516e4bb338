#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Case table of marching cubes, derived from the faces of a cell.
/// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2 & 1). A set of corners is a byte; bit c stands for corner c.
namespace gs::qnv::marching_cubes {

/// Edge of the cell from its lower to its upper corner. The indices of these corners differ in one bit.
struct Edge {
  std::uint8_t lower, upper;
};
inline constexpr std::array<Edge, 12> kEdges = {{{0, 1},
                                                 {2, 3},
                                                 {4, 5},
                                                 {6, 7},  // along x
                                                 {0, 2},
                                                 {1, 3},
                                                 {4, 6},
                                                 {5, 7},  // along y
                                                 {0, 4},
                                                 {1, 5},
                                                 {2, 6},
                                                 {3, 7}}};  // along z

/// Corners of each face, counter-clockwise seen from outside the cell.
inline constexpr std::array<std::array<std::uint8_t, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// Triangle between points on three edges, given by edge indices; counter-clockwise seen from the outside corners.
using EdgeTriangle = std::array<std::uint8_t, 3>;

class Cases {
 public:
  /// Returns the only table. The first call builds it. Any thread.
  static const Cases& get();

  /// Returns the faces that have exactly two diagonal corners inside. Bit f stands for kFaces[f].
  [[nodiscard]] std::uint8_t ambiguous_faces(std::uint8_t inside) const { return ambiguous_[inside]; }

  /// Returns the triangles of a cell. `joined` marks the ambiguous faces on which the inside corners are connected; all
  /// other bits must be 0.
  [[nodiscard]] std::span<const EdgeTriangle> triangles(std::uint8_t inside, std::uint8_t joined) const;

 private:
  Cases();
  struct Range {
    std::uint32_t first = 0, count = 0;
  };
  std::array<std::uint8_t, 256> ambiguous_{};
  std::vector<Range> ranges_;  // 64 entries for each set of inside corners
  std::vector<EdgeTriangle> triangles_;
};

}  // namespace gs::qnv::marching_cubes
