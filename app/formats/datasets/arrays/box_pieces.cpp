#include "app/formats/datasets/arrays/box_pieces.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr std::uint64_t kMostPiece = std::uint64_t{8} << 20;  // bytes of a piece of several chunks
constexpr std::uint64_t kRowGap = 4096;                       // bytes between samples of a row that are not worth a request

using Range = std::pair<std::uint32_t, std::uint32_t>;  // first sample, number of samples

/// Returns the samples of an axis, divided at each multiple of `edge` voxels.
std::vector<Range> ranges_of(const qnv::VoxelBox& box, std::size_t axis, std::uint64_t edge) {
  std::vector<Range> ranges;
  std::uint64_t last = 0;
  for (std::uint32_t i = 0; i < box.size[axis]; ++i) {
    const std::uint64_t at = (box.first[axis] + std::uint64_t{i} * box.step[axis]) / edge;
    if (ranges.empty() || at != last) ranges.emplace_back(i, 0);
    ++ranges.back().second;
    last = at;
  }
  return ranges;
}

/// Returns the edges of pieces in voxels: multiples of those of chunks.
std::array<std::uint64_t, 3> edges_of(const qnv::VoxelBox& box, const std::array<std::uint32_t, 3>& chunk,
                                      std::size_t number) {
  const bool rows = chunk == std::array<std::uint32_t, 3>{};
  std::array<std::uint64_t, 3> edges{}, whole{};
  for (std::size_t a = 0; a < 3; ++a) {
    edges[a] = std::max<std::uint64_t>(chunk[a], 1);
    whole[a] = (box.size[a] - std::uint64_t{1}) * box.step[a] + 1 + edges[a];
  }
  if (rows && box.step[0] * number <= kRowGap) edges[0] = std::uint64_t{1} << 40;  // the row
  const auto bytes = [&] {
    std::uint64_t product = number;
    for (std::size_t a = 0; a < 3; ++a) product *= std::min(edges[a], whole[a]);
    return product;
  };
  for (std::size_t a = 0; a < 3; ++a)
    while (box.step[a] <= std::max<std::uint64_t>(chunk[a], 1) && edges[a] < whole[a]) {
      edges[a] *= 2;
      if (bytes() <= kMostPiece) continue;
      edges[a] /= 2;
      return edges;
    }
  return edges;
}

}  // namespace

bool for_each_piece(const qnv::VoxelBox& box, const std::array<std::uint32_t, 3>& chunk, std::size_t number,
                    const std::function<bool(const BoxPiece&)>& read) {
  const std::array<std::uint64_t, 3> edges = edges_of(box, chunk, number);
  std::array<std::vector<Range>, 3> ranges;
  for (std::size_t a = 0; a < 3; ++a) ranges[a] = ranges_of(box, a, edges[a]);
  BoxPiece piece;
  const auto place = [&](std::size_t a, const Range& range) {
    piece.at[a] = range.first;
    piece.samples[a] = range.second;
    piece.voxels.first[a] = box.first[a] + range.first * box.step[a];
    piece.voxels.size[a] = (range.second - 1) * box.step[a] + 1;
  };
  for (const Range& z : ranges[2]) {
    place(2, z);
    for (const Range& y : ranges[1]) {
      place(1, y);
      for (const Range& x : ranges[0]) {
        place(0, x);
        if (!read(piece)) return false;
      }
    }
  }
  return true;
}

}  // namespace gs::app
