#pragma once

#include "app/formats/datasets/conventions/dataset_file.h"
#include "app/formats/vtk/vtk_surface.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Returns true if the first bytes are those of a file that open_vtk_datasets() reads.
[[nodiscard]] bool is_vtk_datasets(std::span<const std::byte> bytes);
/// Returns true for such a file if it, or files that it names, may need the module for scientific formats.
[[nodiscard]] bool needs_module_for_vtk(std::span<const std::byte> bytes);

/// Opens a VTK XML file, or a file that names others: pieces, blocks, or time steps.
[[nodiscard]] DatasetFileResult open_vtk_datasets(const VolumeFile& file);

/// File of an unstructured grid, which is read in parts.
struct VtkPartFile {
  std::string path;        // relative to the folder of the first file; empty for that file itself
  std::uint64_t size = 0;  // bytes
  VtkXmlHeader header;     // with the arrays of the surface only
};
/// Unstructured grid in one or several files, and the array that its surface shows.
struct VtkPartFiles {
  std::vector<VtkPartFile> files;
  VtkShownArray shown;
};
/// Returns the files of the chosen step and dataset if all of them have unstructured grids.
/// Returns nullopt for other data, and if a file cannot be opened.
[[nodiscard]] std::optional<VtkPartFiles> vtk_grid_files(const VolumeFile& file);

}  // namespace gs::app
