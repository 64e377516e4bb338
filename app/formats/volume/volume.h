#pragma once

#include "app/base/read_file.h"
#include "app/formats/common/upright.h"
#include "app/formats/volume/raw_volume.h"
#include "base/budget.h"
#include "qnv/sampling/volume/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// Origin of a volume's file.
struct VolumeOrigin {
  ReadFile read_beside;  // reads files named by the header; null reads from the file's folder and below
  std::string name;      // original file name; empty means that of the path
};

/// Opens a volume of any known format, detected by its first bytes, else by its name; as headerless if `raw` has
/// dimensions. gzip files are decompressed to memory and other files mapped, so that a volume may exceed memory.
/// Decompressed data and text voxels are charged to `budget`. `origin` provides files that a header names. The source
/// owns all that it needs. Returns a message with the file name on failure. Safe for untrusted files. Runs on any
/// thread.
[[nodiscard]] std::variant<qnv::VolumeSource, std::string> open_volume(const std::string& path,
                                                                       const RawVolume& raw = {},
                                                                       const VolumeOrigin& origin = {},
                                                                       const WorldBudget& budget = own_budget());

/// Reports whether open_volume handles a file with these first bytes (about 1024, gzip-compressed or not).
[[nodiscard]] bool is_volume(std::string_view path, std::span<const std::byte> bytes);

/// Names of a format, for help and documentation.
struct VolumeFormatName {
  std::string_view name;                                      // "NRRD"
  std::string_view extensions;                                // lower case, each with its dot, separated by blanks
  bool (*sniff)(std::span<const std::byte> bytes) = nullptr;  // checks the first bytes; null if only the name decides
  std::string_view mime = "application/x-volume";
  UpRule up = UpRule::y;  // up direction if the file does not state one
};
[[nodiscard]] std::span<const VolumeFormatName> volume_format_names();

}  // namespace gs::app
