#include "app/insitu/bricks/pyramid.h"

#include <algorithm>

namespace gs::app::insitu {
namespace {

std::uint64_t points_of(const GridIndex& size) { return std::uint64_t{size[0]} * size[1] * size[2]; }

}  // namespace

Pyramid::Pyramid(const GridIndex& size) {
  for (GridIndex level = size;;) {
    for (std::uint32_t& points : level) points = std::max(points, 1U);
    sizes_.push_back(level);
    if (points_of(level) <= kMaxOverviewPoints) break;
    for (std::uint32_t& points : level) points = (points - 1) / 2 + 1;
  }
}

GridIndex Pyramid::chunk_shape(std::uint32_t level) const {
  GridIndex shape = sizes_[level];
  for (std::uint32_t& points : shape) points = std::min(points, kChunkEdge);
  return shape;
}

std::size_t Pyramid::chunk_points(std::uint32_t level) const {
  return static_cast<std::size_t>(points_of(chunk_shape(level)));
}

bool Pyramid::contains(const Chunk& chunk) const {
  if (chunk.level >= levels()) return false;
  const GridIndex shape = chunk_shape(chunk.level);
  for (std::size_t a = 0; a < 3; ++a)
    if (chunk.index[a] >= (sizes_[chunk.level][a] - 1) / shape[a] + 1) return false;
  return true;
}

std::vector<Chunk> Pyramid::chunks(std::uint32_t level) const {
  const GridIndex shape = chunk_shape(level);
  std::vector<Chunk> all;
  for (std::uint32_t z = 0; z * shape[2] < sizes_[level][2]; ++z)
    for (std::uint32_t y = 0; y * shape[1] < sizes_[level][1]; ++y)
      for (std::uint32_t x = 0; x * shape[0] < sizes_[level][0]; ++x) all.push_back({level, {x, y, z}});
  return all;
}

}  // namespace gs::app::insitu
