#pragma once

#include "qnv/volume/voxel_type.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace gs::app {

/// What a file without a header cannot say of itself (`--dims`, `--type`, ...).
struct RawVolume {
  std::array<std::uint32_t, 3> dimensions{};  // x fastest; 0 0 0: the file has a header
  qnv::VoxelType type = qnv::VoxelType::u8;
  bool big_endian = false;
  std::uint64_t offset = 0;  // bytes in front of the first voxel
  std::array<float, 3> spacing{1, 1, 1};
};

/// Reads "256x256x113" into the dimensions; false, and nothing changed, for anything else.
[[nodiscard]] bool read_dimensions(std::string_view text, RawVolume& raw);
/// Reads "u8", "i8", "u16", "i16", "u32", "i32", "f32" or "f64" with "le", "be" or nothing (little-endian)
/// behind it; false, and nothing changed, for anything else.
[[nodiscard]] bool read_voxel_type(std::string_view text, RawVolume& raw);
/// What read_voxel_type takes, for messages and help.
inline constexpr std::string_view kVoxelTypes =
    "u8, i8, u16, i16, u32, i32, f32 or f64, with be behind it if big-endian";

}  // namespace gs::app
