#include "app/formats/volume/vtk_xml.h"

#include <algorithm>
#include <array>
#include <utility>

// Reader of VTK XML ImageData.

namespace gs::app {
namespace {

/// Chooses an array: the active scalars of points, else the first point array with one component, else the first point
/// array. Without point arrays, chooses among cell arrays by the same order.
const VtkArray* choose(const VtkXmlHeader& header) {
  for (const bool of_points : {true, false}) {
    const std::string& scalars = of_points ? header.point_scalars : header.cell_scalars;
    const VtkArray *named = nullptr, *single = nullptr, *first = nullptr;
    for (const VtkArray& array : header.arrays) {
      if (array.section != (of_points ? VtkSection::point_data : VtkSection::cell_data) || !vtk_type_of(array.type))
        continue;
      if (!first) first = &array;
      if (!single && array.components == 1) single = &array;
      if (!named && !scalars.empty() && array.name == scalars) named = &array;
    }
    if (first) return named ? named : single ? single : first;
  }
  return nullptr;
}

/// Sets dimensions and position of the voxels. Voxels are points, or centres of cells.
std::optional<std::string> place(const VtkXmlHeader& header, bool of_points, qnv::VolumeLayout& layout) {
  const std::vector<double> extent = numbers_of(
      header.pieces.empty() || header.pieces.back().extent.empty() ? header.whole_extent : header.pieces.back().extent,
      6);
  std::vector<double> origin = numbers_of(header.origin, 3), spacing = numbers_of(header.spacing, 3);
  std::vector<double> direction = numbers_of(header.direction, 9);
  if (extent.size() != 6)
    return "the extent is '" + header.whole_extent.substr(0, 80) + "'; expected six whole numbers";
  if (origin.size() != 3) origin = {0, 0, 0};
  if (spacing.size() != 3) spacing = {1, 1, 1};
  if (direction.size() != 9) direction = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> sizes{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double points = extent[2 * i + 1] - extent[2 * i] + 1;
    sizes[i] = of_points ? points : std::max(1.0, points - 1);
    const double first = extent[2 * i] + (of_points || points < 2 ? 0 : 0.5);
    for (std::size_t k = 0; k < 3; ++k) {
      const double step = direction[3 * k + i] * spacing[i];
      layout.axes[i][static_cast<int>(k)] = static_cast<float>(step);
      origin[k] += step * first;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) layout.origin[static_cast<int>(i)] = origin[i];
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions)
    return "the extent is '" + header.whole_extent.substr(0, 80) + "'; expected at least one point per axis";
  layout.dimensions = *dimensions;
  return std::nullopt;
}

}  // namespace

VolumeResult open_vti(const VolumeFile& file) {
  // Pieces, in other files or in this one, and chosen arrays are those of datasets.
  if (!file.component.dataset.empty() || is_vtk_xml(file.content.bytes, "PImageData")) return open_datasets(file);
  auto read = read_vtk_xml(file.content.bytes, "ImageData");
  if (auto* problem = std::get_if<std::string>(&read)) return std::move(*problem);
  const VtkXmlHeader& header = std::get<VtkXmlHeader>(read);
  if (header.piece_count > 1) return open_datasets(file);
  const VtkArray* array = choose(header);
  if (!array) return std::string("no numeric DataArray in PointData or CellData");
  qnv::VolumeLayout layout;
  if (auto problem = place(header, array->section == VtkSection::point_data, layout)) return std::move(*problem);
  add_metadata(layout, "array", array->name);
  const std::string name = lower_case(array->name);
  layout.colors = name.find("rgb") != std::string::npos || name.find("color") != std::string::npos ||
                  name.find("colour") != std::string::npos;
  if (!array->units.empty()) add_metadata(layout, "units", array->units);
  const StoredType type = *vtk_type_of(array->type);
  const auto size = stored_size(layout, type, array->components);
  if (const auto* problem = std::get_if<std::string>(&size)) return *problem;
  auto voxels = vtk_values(file.content, header, *array, std::get<std::uint64_t>(size) / size_of(type), file.budget);
  if (auto* problem = std::get_if<std::string>(&voxels)) return std::move(*problem);
  std::get<StoredVoxels>(voxels).components = array->components;
  std::get<StoredVoxels>(voxels).component = file.component;
  return make_source(std::move(layout), std::get<StoredVoxels>(std::move(voxels)));
}

}  // namespace gs::app
