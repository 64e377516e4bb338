#pragma once

#include "qnv/sampling/volume/voxel_type.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace gs::app {

/// Layout of a headerless file, from the command line (`--dims`, `--type`, ...).
struct RawVolume {
  std::array<std::uint32_t, 3> dimensions{};  // x fastest; 0 0 0 means that the file has a header
  qnv::VoxelType type = qnv::VoxelType::u8;
  bool big_endian = false;
  std::uint64_t offset = 0;  // bytes before the first voxel
  std::array<float, 3> spacing{1, 1, 1};
};

/// Parses "256x256x113" into the dimensions. Otherwise returns false and changes nothing.
[[nodiscard]] bool read_dimensions(std::string_view text, RawVolume& raw);
/// Parses "u8", "i8", "u16", "i16", "u32", "i32", "f32" or "f64", with suffix "le", "be" or none (little-endian).
/// Otherwise returns false and changes nothing.
[[nodiscard]] bool read_voxel_type(std::string_view text, RawVolume& raw);
/// Syntax of read_voxel_type, for messages and help.
inline constexpr std::string_view kVoxelTypes =
    "u8, i8, u16, i16, u32, i32, f32 or f64, with the suffix be for big-endian";

}  // namespace gs::app
