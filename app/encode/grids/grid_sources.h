#pragma once

#include "app/encode/grids/large_grid.h"

#include <cstddef>
#include <optional>

// Functions that open large grids, one per format. They set all members of a grid except `runs` and `choice`.
namespace gs::app {

/// Maximum number of components of shown values.
inline constexpr std::size_t kMostGridComponents = 64;
/// A part must have fewer points and fewer cells than this, because corners are signed 32-bit numbers.
inline constexpr std::uint64_t kMostGridPoints = std::uint64_t{1} << 31;

/// Opens an unstructured grid of VTK XML files. Reads only headers. Returns nullopt for other files.
[[nodiscard]] std::optional<LargeGrid> open_vtk_grid(const VolumeFile& file, std::uint64_t memory);
/// Opens an unstructured grid of an HDF5 or NetCDF file: VTKHDF or Exodus II. Reads only the sizes of its parts.
/// Returns nullopt for other files.
[[nodiscard]] std::optional<LargeGrid> open_array_grid(const VolumeFile& file, std::uint64_t memory);

/// Reports whether the importer of a file may need more than `memory` bytes. Saves opening small files twice.
[[nodiscard]] constexpr bool may_exceed(std::size_t file_bytes, std::uint64_t memory) {
  constexpr std::uint64_t kMostShare = 8;  // memory of an importer, as a multiple of the file
  return file_bytes > memory / kMostShare;
}

}  // namespace gs::app
