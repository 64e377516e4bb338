#pragma once

#include "app/formats/dicom/dicom_series.h"
#include "app/formats/volume/volume_common.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Series of a file or folder, with the files that their slices come from.
struct DicomScan {
  std::vector<DicomImage> images;
  std::vector<DicomSeries> series;
  std::vector<std::string> notes;  // about files that were left out
};

/// Files of a scan: the bytes of one, or names to read.
struct DicomSources {
  SharedBytes content;             // of the only file
  std::vector<std::string> names;  // empty for one file
  ReadFile read;
};

/// Reads the headers of all files, and finds their series. Files that are no images are counted in a note. Returns a
/// message if there is no image.
[[nodiscard]] std::variant<DicomScan, std::string> scan_dicom(const DicomSources& sources, const WorldBudget& budget);

/// Makes the source of a series. Slices are decoded when they are read.
[[nodiscard]] VolumeResult dicom_volume(const std::shared_ptr<const DicomScan>& scan, std::size_t series,
                                        const DicomSources& sources, VoxelComponent component,
                                        const WorldBudget& budget);

}  // namespace gs::app
