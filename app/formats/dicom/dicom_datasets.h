#pragma once

#include "app/formats/datasets/conventions/dataset_file.h"

namespace gs::app {

/// Opens the series of a DICOM file, or of the files that a directory (DICOMDIR) or a folder names.
[[nodiscard]] DatasetFileResult open_dicom_datasets(const VolumeFile& file);

}  // namespace gs::app
