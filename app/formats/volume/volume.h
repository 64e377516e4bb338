#pragma once

#include "app/base/read_file.h"
#include "app/base/world_budget.h"
#include "app/formats/common/upright.h"
#include "qnv/volume/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

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

/// Where a volume's file is from.
struct VolumeOrigin {
  ReadFile read_beside;  // what a header names; null: out of the folder of the file and below it
  std::string name;      // the file's own; empty: as its path has it
};

/// Opens a volume of any format of the table; by its first bytes, else by its name; as headerless where
/// `raw` has dimensions. gzip'd files are unpacked to memory, other files mapped, so that a volume may be larger than
/// memory; what is unpacked, and slices as numbers, are drawn from `budget`. Files that belong to a header come by
/// `origin`. The source owns what it needs.
/// Else: what is wrong, and what was expected; names the file. Safe for untrusted files. Any thread.
[[nodiscard]] std::variant<qnv::VolumeSource, std::string> open_volume(const std::string& path,
                                                                       const RawVolume& raw = {},
                                                                       const VolumeOrigin& origin = {},
                                                                       const WorldBudget& budget = own_budget());

/// True when a file, of which these are the first bytes (some 1024, gzip'd or not), is for open_volume.
[[nodiscard]] bool is_volume(std::string_view path, std::span<const std::byte> bytes);

/// The formats, for help and documentation.
struct VolumeFormatName {
  std::string_view name;                                      // "NRRD"
  std::string_view extensions;                                // lower case, each with its point, a blank behind each
  bool (*sniff)(std::span<const std::byte> bytes) = nullptr;  // by the first bytes; null: only the name tells
  std::string_view mime = "application/x-volume";
  UpRule up = UpRule::y;  // what is up, where the file itself does not say
};
[[nodiscard]] std::span<const VolumeFormatName> volume_format_names();

}  // namespace gs::app
