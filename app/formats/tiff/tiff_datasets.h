#pragma once

#include "app/formats/datasets/conventions/dataset_file.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Reports whether the first bytes are those of a TIFF or BigTIFF file.
[[nodiscard]] bool is_tiff(std::span<const std::byte> bytes);

/// Opens the images of a TIFF file: stacks, hyperstacks of ImageJ, and images of OME.
[[nodiscard]] DatasetFileResult open_tiff_datasets(const VolumeFile& file);

}  // namespace gs::app
