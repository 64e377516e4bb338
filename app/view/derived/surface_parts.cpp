#include "app/view/derived/surface_parts.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace gs::app {
namespace {

using Corner = std::array<std::uint32_t, 3>;

/// Voxels of a part from `first` to before `last`. Its inner voxels are missing.
struct Covered {
  Corner first{}, last{};
};

std::uint32_t fineness_of(const qnv::ValueBrick& brick, std::size_t axis) {
  return static_cast<std::uint32_t>(std::lround(1 / brick.steps[axis]));
}

// Returns the voxels of a part, with `fine` samples per voxel of the grid, that a finer part covers.
Covered covered_by(const qnv::ValueBrick& finer, const Corner& fine) {
  Covered box;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t ratio = std::max(fineness_of(finer, a) / fine[a], 1u);
    box.first[a] = finer.core_first[a] / ratio;
    box.last[a] = (finer.core_first[a] + finer.core_size[a] + ratio - 1) / ratio;
  }
  return box;
}

// Makes the inner voxels of all boxes in slice z missing. `first` is the first voxel of the slice, and `size` its size.
void omit(const std::vector<Covered>& boxes, const Corner& first, const Corner& size, std::uint32_t z, float* slice) {
  for (const Covered& box : boxes) {
    // A box that ends with the volume covers its last voxels, too.
    if (z <= box.first[2] || z >= box.last[2]) continue;
    const auto range = [&](std::size_t a) {
      return std::pair(std::max(box.first[a] + 1, first[a]), std::min(box.last[a], first[a] + size[a]));
    };
    const auto [x0, x1] = range(0);
    const auto [y0, y1] = range(1);
    for (std::uint32_t y = y0; y < y1; ++y)
      for (std::uint32_t x = x0; x < x1; ++x)
        slice[std::size_t{y - first[1]} * size[0] + (x - first[0])] = qnv::kMissing;
  }
}

qnv::VolumeLayout layout_of_part(const VolumeGrid& grid, const Corner& first, const Corner& size,
                                 const std::array<double, 3>& steps) {
  qnv::VolumeLayout layout = grid.layout();
  glm::dvec3 at(0);
  for (std::size_t a = 0; a < 3; ++a) {
    at[static_cast<int>(a)] = first[a] * steps[a];
    layout.axes[a] *= static_cast<float>(steps[a]);
  }
  layout.origin = grid.place_of(at);
  layout.dimensions = size;
  layout.type = qnv::VoxelType::f32;
  layout.big_endian = std::endian::native == std::endian::big;
  layout.slope = 1;
  layout.intercept = 0;
  layout.missing.reset();  // kMissing is a NaN
  return layout;
}

// Returns the parts of the next finer level in a box of samples.
std::vector<Covered> finer_parts(const VolumeGrid& grid, int level, const Corner& fine) {
  std::vector<Covered> boxes;
  for (const qnv::ValueBrick& brick : grid.bricks())
    if (brick.level == level) boxes.push_back(covered_by(brick, fine));
  return boxes;
}

}  // namespace

std::vector<qnv::VolumeSource> surface_parts(const std::shared_ptr<const VolumeGrid>& grid) {
  std::vector<qnv::VolumeSource> parts;
  int coarsest = 0;
  for (const qnv::ValueBrick& brick : grid->bricks()) coarsest = std::max(coarsest, brick.level);
  const Corner all{grid->kept(0), grid->kept(1), grid->kept(2)};
  parts.push_back(
      {layout_of_part(*grid, {}, all, {1, 1, 1}),
       [grid, all, boxes = finer_parts(*grid, coarsest, {1, 1, 1})](std::uint32_t z, std::span<std::byte> to) {
         const std::span<const float> slice = grid->kept_slice(z);
         if (to.size() != slice.size_bytes()) return false;
         std::vector<float> values(slice.begin(), slice.end());
         omit(boxes, {}, all, z, values.data());
         std::memcpy(to.data(), values.data(), to.size());
         return true;
       }});
  for (const qnv::ValueBrick& brick : grid->bricks()) {
    Corner size{}, fine{};
    bool flat = false;
    for (std::size_t a = 0; a < 3; ++a) {
      // The cells after the last voxel reach into the margin.
      size[a] =
          std::min(brick.core_first[a] + brick.core_size[a] + 1, brick.first[a] + brick.size[a]) - brick.core_first[a];
      fine[a] = fineness_of(brick, a);
      flat = flat || size[a] < 2;
    }
    if (flat) continue;
    parts.push_back({layout_of_part(*grid, brick.core_first, size, brick.steps),
                     [grid, brick, size,
                      boxes = brick.level > 0 ? finer_parts(*grid, brick.level - 1, fine) : std::vector<Covered>()](
                         std::uint32_t z, std::span<std::byte> to) {
                       std::vector<float> values(std::size_t{size[0]} * size[1]);
                       if (z >= size[2] || to.size() != values.size() * sizeof(float)) return false;
                       const Corner& at = brick.core_first;
                       float* next = values.data();
                       for (std::uint32_t y = 0; y < size[1]; ++y)
                         for (std::uint32_t x = 0; x < size[0]; ++x)
                           *next++ = brick.value(at[0] + x, at[1] + y, at[2] + z);
                       omit(boxes, at, size, at[2] + z, values.data());
                       std::memcpy(to.data(), values.data(), to.size());
                       return true;
                     }});
  }
  return parts;
}

}  // namespace gs::app
