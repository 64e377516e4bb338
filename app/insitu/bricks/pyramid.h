#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::app::insitu {

using GridIndex = std::array<std::uint32_t, 3>;  // along x, y, z

/// Chunk of a level of a pyramid.
struct Chunk {
  std::uint32_t level = 0;
  GridIndex index{};
  friend auto operator<=>(const Chunk&, const Chunk&) = default;
};

/// Levels of a grid, in chunks. Level n has every 2^n-th point along each axis. The last level is
/// the overview.
class Pyramid {
 public:
  static constexpr std::uint32_t kChunkEdge = 64;
  static constexpr std::uint64_t kMaxOverviewPoints = std::uint64_t{1} << 18;

  Pyramid() = default;
  explicit Pyramid(const GridIndex& size);

  [[nodiscard]] std::uint32_t levels() const { return static_cast<std::uint32_t>(sizes_.size()); }
  [[nodiscard]] std::uint32_t overview() const { return levels() - 1; }
  /// Returns the number of points of a level along each axis.
  [[nodiscard]] const GridIndex& size(std::uint32_t level) const { return sizes_[level]; }
  /// Returns the points of a chunk along each axis. The last chunks may extend beyond the level.
  [[nodiscard]] GridIndex chunk_shape(std::uint32_t level) const;
  [[nodiscard]] std::size_t chunk_points(std::uint32_t level) const;
  [[nodiscard]] bool contains(const Chunk& chunk) const;
  /// Returns all chunks of a level.
  [[nodiscard]] std::vector<Chunk> chunks(std::uint32_t level) const;

 private:
  std::vector<GridIndex> sizes_;
};

}  // namespace gs::app::insitu
