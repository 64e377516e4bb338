#pragma once

#include "qnv/base/geometry.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Voxels to write: numbers of one type, and their meaning.
struct WrittenVoxels {
  qnv::VolumeLayout layout;  // type, byte order, slope, intercept and missing value of the numbers
  std::vector<std::byte> bytes;
};

/// Form of the written numbers.
struct VoxelForm {
  bool scaled = true;  // the format has slope and intercept; otherwise scaled values become float32
  bool big_endian = false;
  bool fits_types = false;  // FITS has u8, i16 and i32; other integers are shifted by half of their range
};

/// Converts the values of a geometry. Returns a message if it has none, or not the finest ones, or if they cannot be
/// read.
[[nodiscard]] std::variant<WrittenVoxels, std::string> voxels_to_write(const qnv::Geometry& geometry,
                                                                       const VoxelForm& form);

}  // namespace gs::app
