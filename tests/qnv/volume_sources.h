#pragma once

#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

/// Volumes in memory, for tests.
namespace gs::test {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Makes a volume of stored voxels, x fastest. The type of the layout is T.
template <class T>
qnv::VolumeSource volume_of(qnv::VolumeLayout layout, std::vector<T> voxels) {
  const std::size_t slice = std::size_t{layout.dimensions[0]} * layout.dimensions[1] * sizeof(T);
  auto owned = std::make_shared<const std::vector<T>>(std::move(voxels));
  return {std::move(layout), [owned, slice](std::uint32_t z, std::span<std::byte> to) {
            if (to.size() != slice || (z + std::size_t{1}) * slice > owned->size() * sizeof(T)) return false;
            std::memcpy(to.data(), reinterpret_cast<const std::byte*>(owned->data()) + z * slice, slice);
            return true;
          }};
}

/// Makes a volume of floats from a function of the voxel's indices.
inline qnv::VolumeSource volume_of(qnv::VolumeLayout layout,
                                   const std::function<float(std::uint32_t, std::uint32_t, std::uint32_t)>& value) {
  std::vector<float> voxels;
  const auto [nx, ny, nz] = layout.dimensions;
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) voxels.push_back(value(x, y, z));
  layout.type = qnv::VoxelType::f32;
  return volume_of(std::move(layout), std::move(voxels));
}

/// Returns anisotropic axes that are not at right angles.
inline qnv::VolumeLayout oblique(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz) {
  qnv::VolumeLayout layout;
  layout.dimensions = {nx, ny, nz};
  layout.axes = {glm::vec3(0.5f, 0.1f, 0), glm::vec3(-0.2f, 0.8f, 0.1f), glm::vec3(0.1f, 0.2f, 1.5f)};
  layout.origin = glm::dvec3(10, -20, 30);
  return layout;
}

/// Returns the position of a voxel, computed from the definition.
inline glm::vec3 place_of(const qnv::VolumeLayout& layout, float x, float y, float z) {
  return glm::vec3(layout.origin) + x * layout.axes[0] + y * layout.axes[1] + z * layout.axes[2];
}

}  // namespace gs::test
