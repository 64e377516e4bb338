#pragma once

#include "app/formats/common/voxel_component.h"
#include "qnv/sampling/volume/voxel_type.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace gs::app {

/// Layout of a file without header, from the command line (`--dims`, `--type`, ...).
struct RawVolume {
  std::array<std::uint32_t, 3> dimensions{};  // size along x, y, z; 0 0 0 means that the file has a header
  qnv::VoxelType type = qnv::VoxelType::u8;
  bool big_endian = false;
  std::uint64_t offset = 0;  // number of bytes before the first voxel
  std::array<float, 3> spacing{1, 1, 1};
};

/// Parses a size such as "256x256x113" into the dimensions. If the text is invalid, returns false and changes nothing.
[[nodiscard]] bool read_dimensions(std::string_view text, RawVolume& raw);
/// Parses "u8", "i8", "u16", "i16", "u32", "i32", "f32" or "f64". The suffix "le" or "be" is the byte order; without
/// it, the order is little-endian. If the text is invalid, returns false and changes nothing.
[[nodiscard]] bool read_voxel_type(std::string_view text, RawVolume& raw);
/// Parses "magnitude", or the index of a component from 0. Returns nullopt for other texts.
[[nodiscard]] std::optional<VoxelComponent> read_voxel_component(std::string_view text);
/// Parses the step of a time series: a whole number of digits is the number of the step, other numbers are a time.
[[nodiscard]] std::optional<qnv::ShownStep> read_shown_step(std::string_view text);
/// Text for messages and help: the syntax that read_voxel_type accepts.
inline constexpr std::string_view kVoxelTypes =
    "u8, i8, u16, i16, u32, i32, f32 or f64, with the suffix be for big-endian";

}  // namespace gs::app
