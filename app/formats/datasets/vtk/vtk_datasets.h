#pragma once

#include "app/formats/datasets/conventions/dataset_file.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Returns true if the first bytes are those of a file that open_vtk_datasets() reads.
[[nodiscard]] bool is_vtk_datasets(std::span<const std::byte> bytes);
/// Returns true for such a file if it, or files that it names, may need the module for scientific formats.
[[nodiscard]] bool needs_module_for_vtk(std::span<const std::byte> bytes);

/// Opens a VTK XML file, or a file that names others: pieces, blocks, or time steps.
[[nodiscard]] DatasetFileResult open_vtk_datasets(const VolumeFile& file);

}  // namespace gs::app
