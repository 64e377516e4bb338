#pragma once

#include "base/parallel.h"
#include "qnv/base/description.h"
#include "qnv/sampling/volume/voxel_type.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Layout of a regular grid of scalar values. The values are read slice by slice, so that the grid may be larger than
/// memory.
struct VolumeLayout {
  std::array<std::uint32_t, 3> dimensions{};  // voxels along x, y, z; x varies fastest
  std::array<glm::vec3, 3> axes{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0),
                                glm::vec3(0, 0, 1)};  // step from a voxel to the next, world units
  glm::dvec3 origin{0};                               // centre of voxel (0, 0, 0), world units, relative to `base`
  glm::dvec3 base{0};                                 // Description::origin of results
  VoxelType type = VoxelType::u8;
  bool big_endian = false;
  double slope = 1, intercept = 0;  // value = stored * slope + intercept
  std::optional<double> missing;    // stored value that means "no data"
  bool labels = false;              // the stored numbers are labels of a segmentation, which are never interpolated
  bool colors = false;              // the components of the source are red, green, blue and perhaps opacity (sRGB, u8)
  std::vector<std::pair<std::string, std::string>> metadata;  // UTF-8
};

/// Voxels of a volume: `size` of them along each axis, from voxel `first` on, `step` voxels apart.
struct VoxelBox {
  std::array<std::uint32_t, 3> first{}, size{1, 1, 1}, step{1, 1, 1};
};

/// Volume: its layout, and a function that reads the stored bytes of slice z. A slice has x * y voxels. The function
/// returns false on failure. Only one thread at a time calls it; z may have any order.
struct VolumeSource {
  VolumeLayout layout;
  std::function<bool(std::uint32_t z, std::span<std::byte> slice)> read;
  std::vector<VolumeSource> components{};  // all numbers of a voxel, if it has several and none was chosen
  std::vector<VolumeSource> steps{};       // all steps of a time series; the source itself is one of them
  std::vector<double> times{};             // of the steps, ascending
  std::vector<VolumeSource> coarser{};     // the same space with fewer voxels, the coarsest first
  /// Returns a message about parts that could not be read so far; empty if there are none. May be null.
  std::function<std::string()> trouble{};
  /// Reads the stored bytes of the voxels of a box, x first. Returns false on failure, or if the box leaves the volume.
  /// Null if only slices can be read. The rules of `read` hold.
  std::function<bool(const VoxelBox& box, std::span<std::byte> voxels)> read_box{};
  /// Edges of the chunks in voxels: reading one voxel costs as much as reading its chunk. 0 means that each row of
  /// voxels can be read alone.
  std::array<std::uint32_t, 3> chunk{};
};

}  // namespace gs::qnv
