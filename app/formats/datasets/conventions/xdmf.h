#pragma once

#include "app/formats/datasets/conventions/dataset_file.h"

namespace gs::app {

/// Returns true if a file begins like XDMF: XML with the element Xdmf.
[[nodiscard]] bool is_xdmf(std::span<const std::byte> bytes);
/// Opens an XDMF file with the files that it names.
[[nodiscard]] DatasetFileResult open_xdmf_file(const VolumeFile& file);

}  // namespace gs::app
