#pragma once

#include "app/base/read_file.h"
#include "app/base/world_budget.h"
#include "app/formats/common/upright.h"
#include "app/formats/volume/raw_volume.h"
#include "qnv/volume/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

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
