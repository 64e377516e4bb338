#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"
#include "app/formats/common/upright.h"
#include "app/formats/common/voxel_component.h"
#include "app/formats/volume/raw_volume.h"
#include "base/budget.h"
#include "qnv/sampling/volume/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

class FileStates;

/// Origin of a volume's file: its name and the files beside it; and the component to read.
struct VolumeOrigin {
  ReadFile read_beside;  // reads files that the header names; null reads below the file's folder
  std::string name;      // original file name; empty means the name in the path
  VoxelComponent component{};
  ReadFiles read_files = {};    // reads files of a container; null reads below the file's folder
  ListFolder list_folder = {};  // lists folders of a container; null with `read_files` means that none can be listed
  NeedBytes need = {};          // receives parts of the file from a server; null if the file is complete
  std::shared_ptr<FileStates> states = {};  // records the other files that are read; may be null
};

/// Returns the file that stands for a local folder of a scan (DICOM): the first one that is a volume. Returns an empty
/// text for other folders and for files.
[[nodiscard]] std::string entry_of_folder(const std::string& path);
/// If `path` is such a folder, or VoxelComponent::folder states a local one, `origin` reads the files of that folder.
void use_folder(const std::string& path, VolumeOrigin& origin);

/// Opens a volume. `path` may be a folder with an entry (entry_of_folder). Detects the format by the first bytes, else
/// by the name. If `raw` has dimensions, the file has no header. Decompresses gzip files into memory and maps other
/// files, so that a volume may exceed memory. Decompressed data and voxels from text are charged to `budget`. `origin`
/// provides files that a header names. The result owns all that it needs. Returns a message with the file name on
/// failure. Safe for untrusted files. Any thread.
[[nodiscard]] std::variant<qnv::VolumeSource, std::string> open_volume(const std::string& path,
                                                                       const RawVolume& raw = {},
                                                                       const VolumeOrigin& origin = {},
                                                                       const WorldBudget& budget = own_budget());

/// Like open_volume(), for the mapped bytes of the file `path`.
[[nodiscard]] std::variant<qnv::VolumeSource, std::string> open_volume_file(const std::string& path,
                                                                            const SharedBytes& bytes,
                                                                            const RawVolume& raw,
                                                                            const VolumeOrigin& origin,
                                                                            const WorldBudget& budget);
/// Maps the file of a volume. Returns a message with the file name if it cannot be read or is empty.
[[nodiscard]] std::variant<SharedBytes, std::string> map_volume(const std::string& path);
/// Returns a message if the slices of a layout exceed a budget.
[[nodiscard]] std::optional<std::string> too_large_slices(const qnv::VolumeLayout& layout, const Budget& budget);

/// End of the message for a file that holds a mesh instead of a volume.
inline constexpr std::string_view kIsMesh = " is a mesh; expected a volume";

/// Returns true if open_volume accepts a file with these first bytes (about 1024, gzip-compressed or not).
[[nodiscard]] bool is_volume(std::string_view path, std::span<const std::byte> bytes);

/// Returns true if a file on a server can be read by parts. `first` are its first bytes.
[[nodiscard]] bool reads_by_parts(std::string_view name, std::span<const std::byte> first);
/// Returns true if the extension of a name belongs to a format that can be read by parts.
[[nodiscard]] bool may_read_by_parts(std::string_view name);

/// Name and file names of a format, for help and documentation.
struct VolumeFormatName {
  std::string_view name;                                      // "NRRD"
  std::string_view extensions;                                // lower case, each with its dot, separated by blanks
  bool (*sniff)(std::span<const std::byte> bytes) = nullptr;  // tests the first bytes; null if only the name decides
  std::string_view mime = "application/x-volume";
  UpRule up = UpRule::y;  // rule for the up axis, unless the file defines it
  bool belongs_to_others = false;  // as ContentType::belongs_to_others
};
[[nodiscard]] std::span<const VolumeFormatName> volume_format_names();

}  // namespace gs::app
