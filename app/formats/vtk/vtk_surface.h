#pragma once

#include "app/formats/common/voxel_component.h"
#include "app/formats/volume/vtk_xml.h"
#include "app/formats/vtk/bookkeeping.h"
#include "app/formats/vtk/grid_cells.h"
#include "app/formats/vtk/poly_data.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Array to show on a surface. Without a name, the surface has no data.
struct VtkShownArray {
  VtkSection section = VtkSection::point_data;
  std::string name;
};

/// Reader of the surface of a block, which one or several VTK XML files hold: vertices, lines, polygons and strips of
/// PolyData, visible faces of the cells of an UnstructuredGrid (grid_cells.h), and outer faces of structured grids.
/// Reports problems; pieces without an array are grey there. Triples and quadruples of bytes are colours. Vectors are
/// shown by length, or by the chosen component. Omits hidden cells. Functions may throw OutOfBudget.
class VtkSurfaceReader {
 public:
  /// `builder` must outlive this object.
  VtkSurfaceReader(VtkShownArray shown, const VoxelComponent& choice, MeshBuilder& builder)
      : shown_(std::move(shown)), choice_(choice), builder_(builder) {}

  /// Adds all pieces of a file.
  void add(const SharedBytes& file, const VtkXmlHeader& header);
  /// Returns the surface. It has no points if the files have none.
  [[nodiscard]] PolyData take();

 private:
  [[nodiscard]] const VtkArray* array_of(std::size_t piece, VtkSection section, std::string_view name) const;
  std::optional<StoredVoxels> numbers(const VtkArray& array, std::uint64_t count);
  void add_piece(std::size_t number);
  void add_structured_piece(std::size_t number);
  bool add_structured_points(std::size_t number, const std::array<std::int64_t, 6>& extent, std::uint64_t count);
  bool read_vectors(const VtkArray& array, std::uint64_t count, std::vector<glm::vec3>& to);
  /// Returns the flags of hidden points or cells of a piece; empty if there are none.
  [[nodiscard]] GhostFlags ghosts(std::size_t piece, VtkSection section, std::uint64_t count);
  /// Reads the shown array of a piece behind the data of the `first` points or cells of earlier pieces.
  void read_data(std::size_t piece, std::size_t first, std::uint64_t count, PolyData::Data& data);
  /// Reads data and flags of the cells of PolyData. `before` counts the cells of each kind in earlier pieces.
  void read_cell_data(std::size_t piece, std::uint64_t count, const std::array<std::size_t, PolyData::kKinds>& before);
  void join_cell_data();
  bool read_grid(std::size_t piece, std::uint64_t count, std::size_t first);
  void read_polyhedra(std::size_t piece, std::size_t first_cell, std::size_t first_point);
  bool read_cells(std::size_t piece, VtkSection section, std::uint64_t count, std::size_t first, PolyCells& cells);

  VtkShownArray shown_;
  VoxelComponent choice_;
  MeshBuilder& builder_;
  SharedBytes file_;
  const VtkXmlHeader* header_ = nullptr;
  PolyData data_;
  GridCells grid_;
  PolyData::Data of_grid_;                                // of the cells of `grid_`
  std::array<PolyData::Data, PolyData::kKinds> of_kind_;  // of the cells of each kind in `data_`
  GhostFlags ghost_points_,
      ghost_cells_;  // of all points, and of the cells of `grid_`; short if later pieces have none
  std::array<GhostFlags, PolyData::kKinds> ghost_kinds_;
};

}  // namespace gs::app
