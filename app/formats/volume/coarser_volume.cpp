#include "app/formats/volume/coarser_volume.h"

#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

qnv::VolumeSource one_thinned(const qnv::VolumeSource& source, std::uint32_t step) {
  qnv::VolumeSource coarse;
  coarse.layout = source.layout;
  for (std::size_t i = 0; i < 3; ++i) {
    coarse.layout.dimensions[i] = (source.layout.dimensions[i] - 1) / step + 1;
    coarse.layout.axes[i] *= static_cast<float>(step);
  }
  coarse.read = [read = source.read, fine = source.layout, size = coarse.layout.dimensions, step](
                    std::uint32_t z, std::span<std::byte> to) {
    const std::size_t voxel = qnv::size_of(fine.type);
    if (z >= size[2] || to.size() != voxel * size[0] * size[1]) return false;
    std::vector<std::byte> slice(static_cast<std::size_t>(qnv::slice_voxels(fine)) * voxel);
    if (!read(z * step, slice)) return false;
    std::byte* next = to.data();
    for (std::size_t y = 0; y < size[1]; ++y) {
      const std::byte* row = slice.data() + y * step * fine.dimensions[0] * voxel;
      for (std::size_t x = 0; x < size[0]; ++x, next += voxel) std::memcpy(next, row + x * step * voxel, voxel);
    }
    return true;
  };
  return coarse;
}

}  // namespace

qnv::VolumeSource thinned(const qnv::VolumeSource& source, std::uint32_t step) {
  std::vector<qnv::VolumeSource> components;
  for (const qnv::VolumeSource& component : source.components) components.push_back(one_thinned(component, step));
  if (source.layout.colors) return qnv::color_source(std::move(components));
  qnv::VolumeSource coarse = one_thinned(source, step);
  coarse.components = std::move(components);
  coarse.trouble = source.trouble;
  return coarse;
}

std::uint32_t step_for_voxels(const qnv::VolumeLayout& layout, std::uint64_t most) {
  const auto left = [&](std::uint32_t step) {
    std::uint64_t voxels = 1;
    for (const std::uint32_t side : layout.dimensions) voxels *= side == 0 ? 0 : (side - 1) / step + 1;
    return voxels;
  };
  const auto longest = *std::max_element(std::begin(layout.dimensions), std::end(layout.dimensions));
  std::uint32_t step = 1;
  while (step < longest && left(step) > most) ++step;
  return step;
}

void add_coarser(qnv::VolumeSource& source) {
  const std::uint64_t voxels = qnv::voxel_count(source.layout);
  if (!source.coarser.empty() || voxels < kLongVoxels) return;
  const auto step =
      static_cast<std::uint32_t>(std::ceil(std::cbrt(static_cast<double>(voxels) / static_cast<double>(kQuickVoxels))));
  source.coarser.push_back(thinned(source, std::max<std::uint32_t>(step, 2)));
}

}  // namespace gs::app
