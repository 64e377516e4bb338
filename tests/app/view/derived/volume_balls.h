#pragma once

#include "app/view/values/volume_grid.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

namespace gs::app::test_balls {

/// Returns a volume of `size` voxels a side, 0.5 apart from (3, 0, 0) on. Its values are 100 in the middle, and fall by
/// 10 per voxel down to 0.
inline qnv::VolumeSource ball(std::uint32_t size) {
  qnv::VolumeSource source;
  source.layout.dimensions = {size, size, size};
  for (int axis = 0; axis < 3; ++axis) {
    source.layout.axes[static_cast<std::size_t>(axis)] = glm::vec3(0);
    source.layout.axes[static_cast<std::size_t>(axis)][axis] = 0.5f;
  }
  source.layout.origin = {3, 0, 0};
  source.layout.type = qnv::VoxelType::f32;
  source.read = [size](std::uint32_t z, std::span<std::byte> slice) {
    const double middle = (size - 1) / 2.0;
    std::vector<float> values;
    for (std::uint32_t y = 0; y < size; ++y)
      for (std::uint32_t x = 0; x < size; ++x)
        values.push_back(static_cast<float>(std::max(0.0, 100 - 10 * std::hypot(x - middle, y - middle, z - middle))));
    std::memcpy(slice.data(), values.data(), slice.size());
    return true;
  };
  return source;
}

inline std::shared_ptr<const VolumeGrid> grid_of(const qnv::VolumeSource& source) {
  auto taken = VolumeGrid::take(source, nullptr, own_budget(), VolumeGrid::kMaxVoxels);
  if (auto* problem = std::get_if<std::string>(&taken)) FAIL(*problem);
  return std::get<std::shared_ptr<const VolumeGrid>>(taken);
}

}  // namespace gs::app::test_balls
