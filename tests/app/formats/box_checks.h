#pragma once

#include "qnv/sampling/volume/volume_slices.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::test {

/// Checks that the boxes of a volume have the voxels of its slices.
inline void check_boxes(const qnv::VolumeSource& source) {
  REQUIRE(source.read_box);
  qnv::VolumeSource slices = source;
  slices.read_box = nullptr;
  const auto& size = source.layout.dimensions;
  std::vector<qnv::VoxelBox> boxes{{{0, 0, 0}, size, {1, 1, 1}}};
  for (const std::uint32_t step : {1u, 2u, 3u, 7u}) {
    qnv::VoxelBox box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.step[a] = step + static_cast<std::uint32_t>(a);
      box.first[a] = std::min(size[a] - 1, 2 * step);
      box.size[a] = (size[a] - 1 - box.first[a]) / box.step[a] + 1;
    }
    boxes.push_back(box);
  }
  for (const qnv::VoxelBox& box : boxes) {
    const std::size_t bytes = static_cast<std::size_t>(qnv::voxel_count(box)) * qnv::size_of(source.layout.type);
    std::vector<std::byte> ours(bytes), theirs(bytes);
    REQUIRE(qnv::read_voxels(source, box, ours));
    REQUIRE(qnv::read_voxels(slices, box, theirs));
    CHECK(ours == theirs);
    std::vector<std::byte> fewer(bytes - 1);
    CHECK_FALSE(source.read_box(box, fewer));
  }
  std::vector<std::byte> one(qnv::size_of(source.layout.type));
  CHECK_FALSE(source.read_box({size, {1, 1, 1}, {1, 1, 1}}, one));
  CHECK_FALSE(source.read_box({{0, 0, 0}, {0, 1, 1}, {1, 1, 1}}, one));
  CHECK_FALSE(source.read_box({{0, 0, 0}, {1, 1, 1}, {0, 1, 1}}, one));
}

}  // namespace gs::test
