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

/// Returns the form of the last part of a URL if this is the name of a series, such as "run.%04d.qnv". The placeholder
/// has precedence over percent-encoding.
[[nodiscard]] std::optional<NumberedName> series_of_url(std::string_view url);

/// File that stands for a folder, and how it is read.
struct FolderChoice {
  std::vector<std::string> files;  // names, in the order of the attempts
  bool is_scan = false;            // the files of the folder are slices of scans (DICOM)
  TimeSteps steps;                 // of a series of numbered files, and the number of this one
};

/// Chooses a file among the `names` of the files in a folder and its subfolders, which are sorted:
///
/// - with `series`, the wanted step of the files with these names, or the first one;
/// - otherwise the metadata of a Zarr or N5 container; the slices of a scan; or the only file of a known format.
///
/// Returns a message if there is no such file.
[[nodiscard]] std::variant<FolderChoice, std::string> choose_in_folder(std::span<const std::string> names,
                                                                       const std::optional<NumberedName>& series,
                                                                       const std::optional<qnv::ShownStep>& wanted);

}  // namespace gs::app
