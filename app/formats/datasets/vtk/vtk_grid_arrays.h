#pragma once

#include "app/formats/datasets/arrays/grid_volume.h"
#include "app/formats/datasets/vtk/vtk_files.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Piece of a grid: a file, and the points that it has, if the file that names it states them.
struct VtkGridPiece {
  std::string path;
  std::optional<VtkExtent> extent;
};

/// Regular or rectilinear grid in one or several files, at one or several times.
struct VtkGridSteps {
  std::vector<std::vector<VtkGridPiece>> steps;  // pieces of each time
  std::vector<double> times;
  VtkExtent extent{};                    // of all pieces
  std::vector<VtkDeclaredArray> arrays;  // of the first time
  std::array<GridAxis, 3> axes;          // of points
  glm::dmat3 directions{1};
};

/// Opens an array of such a grid as a volume. Pieces are read on demand; values of missing ones are NaN, or 0 of whole
/// numbers. Returns a message on failure.
[[nodiscard]] VolumeResult open_vtk_grid(std::shared_ptr<VtkFiles> files, const VtkGridSteps& grid, std::size_t array,
                                         const VoxelComponent& choice);

/// Returns the shape of an array of the grid, slowest axis first, without time and components.
[[nodiscard]] std::vector<std::uint64_t> vtk_grid_shape(const VtkGridSteps& grid, VtkSection section);

/// Geometry of a grid: its axes and the directions of these.
struct VtkGridPlaces {
  std::array<GridAxis, 3> axes;
  glm::dmat3 directions{1};
};
/// Returns the geometry of an ImageData by the texts of its header.
[[nodiscard]] VtkGridPlaces vtk_image_places(const VtkExtent& extent, const std::string& origin,
                                             const std::string& spacing, const std::string& direction);
/// Returns the axis for these positions of points.
[[nodiscard]] GridAxis vtk_axis_of(std::vector<double> positions);
/// Returns the geometry of the points of a StructuredGrid if they form a regular or rectilinear lattice, which may be
/// turned; nullopt if they are curvilinear, or flat.
[[nodiscard]] std::optional<VtkGridPlaces> vtk_lattice_of(const VtkOpened& file, const VtkExtent& extent,
                                                          const WorldBudget& budget);

}  // namespace gs::app
