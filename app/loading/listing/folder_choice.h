#pragma once

#include "app/base/numbered_files.h"
#include "app/formats/common/time_steps.h"
#include "qnv/sampling/volume/volume_values.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Returns the number pattern in the last part of a URL, such as "run.%04d.qnv". Returns nullopt if there is none. The
/// placeholder has precedence over percent-encoding.
[[nodiscard]] std::optional<NumberedName> series_of_url(std::string_view url);

/// Files by which readers open a folder, and the way to read them.
struct FolderChoice {
  std::vector<std::string> files;  // names, in the order of the attempts
  bool is_scan = false;            // the files of the folder are slices of scans (DICOM)
  TimeSteps steps;                 // steps of a series of numbered files, and the index of the chosen one
};

/// Chooses a file by the sorted `names` of the files in a folder and its subfolders:
///
/// - with `series`, the wanted step of the files with these names, or the first one;
/// - otherwise the metadata of a Zarr or N5 container; the slices of a scan; or the only file of a known format.
///
/// Returns a message if there is no such file.
[[nodiscard]] std::variant<FolderChoice, std::string> choose_in_folder(std::span<const std::string> names,
                                                                       const std::optional<NumberedName>& series,
                                                                       const std::optional<qnv::ShownStep>& wanted);

}  // namespace gs::app
