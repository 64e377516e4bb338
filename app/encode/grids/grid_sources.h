#pragma once

#include "app/encode/grids/large_grid.h"

#include <cstddef>
#include <optional>

// Openers of the formats of large grids. They fill all members of a grid but its runs and its choice.
namespace gs::app {

/// Maximum number of components of shown values.
inline constexpr std::size_t kMostGridComponents = 64;
/// Maximum number of points or cells of a part. Corners are 32-bit numbers.
inline constexpr std::uint64_t kMostGridPoints = std::uint64_t{1} << 31;

/// Opens an unstructured grid of VTK XML files. Reads only headers. Returns nullopt for other files.
[[nodiscard]] std::optional<LargeGrid> open_vtk_grid(const VolumeFile& file, std::uint64_t memory);
/// Opens an unstructured grid of an HDF5 or NetCDF file: VTKHDF or Exodus II. Reads only the sizes of its parts.
/// Returns nullopt for other files.
[[nodiscard]] std::optional<LargeGrid> open_array_grid(const VolumeFile& file, std::uint64_t memory);

/// Returns true if an importer of a file may need more than `memory` bytes. So small files are not opened twice.
[[nodiscard]] constexpr bool may_exceed(std::size_t file_bytes, std::uint64_t memory) {
  constexpr std::uint64_t kMostShare = 8;  // memory of an importer, as a multiple of the file
  return file_bytes > memory / kMostShare;
}

}  // namespace gs::app
