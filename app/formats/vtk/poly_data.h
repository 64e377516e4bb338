#pragma once

#include "app/formats/common/dataset_list.h"
#include "app/formats/common/mesh_asset.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Cells of one kind: the corners of all cells in sequence, and the end of each cell in this sequence.
struct PolyCells {
  std::vector<std::int32_t> corners;
  std::vector<std::size_t> ends;
};

/// VTK PolyData in the structure of its files.
struct PolyData {
  enum Kind : std::uint8_t { vertices, lines, polygons, strips };  // order of the cells in VTK
  static constexpr std::size_t kKinds = 4;

  std::vector<glm::vec3> points, normals;  // `normals` is empty or has one entry per point
  std::array<PolyCells, kKinds> cells;
  /// Data of all points or all cells: scalars with their title, or colours. Colours take precedence. Both may be empty.
  struct Data {
    std::vector<float> values;
    std::vector<vrml::Color> colors;
    std::string title;
    std::vector<glm::vec3> vectors{};  // of points, for arrows; NaN where missing; empty if arrows are not chosen

    [[nodiscard]] bool empty() const { return values.empty() && colors.empty(); }
  };
  Data of_points, of_cells;

  /// Returns the data to show: those of points, else those of cells.
  [[nodiscard]] const Data& shown() const { return of_points.empty() ? of_cells : of_points; }
};

/// Part of a surface, with a name for users, which may be empty.
struct PolyBlock {
  std::string name;
  PolyData data;
};

/// Returns the chosen component of a value with several parts, or the length of the vector.
[[nodiscard]] double shown_number(std::span<const double> parts, const VoxelComponent& choice);
/// Returns the end of a title: " (length)" or " (component 1)" for values of several parts.
[[nodiscard]] std::string part_text(std::size_t parts, const VoxelComponent& choice);

/// Appends a value with one or several parts to data, as the number to show and, for arrows, as a vector.
void append_number(std::span<const double> parts, const VoxelComponent& choice, PolyData::Data& data);

/// Returns the path of the data of points or cells in the list of a surface's arrays: "/PointData/NAME".
[[nodiscard]] std::string entry_path(bool of_points, std::string_view name);
[[nodiscard]] DatasetEntry surface_entry(bool of_points, std::string_view name, std::uint64_t rows,
                                         std::uint64_t components, std::string_view type, std::string_view unit);
/// Notes the list of the arrays of a surface, and calls `choose` with the entry of the user's choice. Without a choice,
/// the entry `usual` is shown. Reports a wrong choice and returns false.
[[nodiscard]] bool choose_surface_entry(std::vector<DatasetEntry> entries, MeshBuilder& builder,
                                        const std::function<void(std::size_t entry)>& choose, std::string usual);

/// Adds the data to the mesh: polygons and strips as faces, lines, vertices (or all points, if there are no cells) as
/// points. Scalars are coloured as the builder's choice states; point scalars take precedence over cell scalars. The
/// colour key describes their range. If arrows are chosen, adds arrows for vectors of points and makes the surface
/// grey. Throws OutOfBudget.
void build_poly_data(PolyData data, MeshBuilder& builder);
/// Adds the blocks of a surface with their names. They share a colour key. Throws OutOfBudget.
void build_poly_blocks(std::vector<PolyBlock> blocks, MeshBuilder& builder);

}  // namespace gs::app
