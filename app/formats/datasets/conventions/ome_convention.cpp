#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/zarr/zarr_file.h"
#include "qnv/container/step_table.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

// Images of OME-Zarr as datasets: each level of a pyramid is one.
namespace gs::app {
namespace {

constexpr std::uint64_t kLeastOmeVoxels = 4096;  // of a level that is worth a look
constexpr double kMostLocalOme = 256.0 * (1 << 20), kMostRemoteOme = 16.0 * (1 << 20);  // elements of the default level

const ZarrFile* zarr_of_tree(DatasetTree& tree) { return dynamic_cast<const ZarrFile*>(tree.file().get()); }

/// Returns the role of an axis of `image`.
AxisRole ome_role(const ZarrImage& image, std::size_t axis) {
  const std::string& name = image.axes[axis].name;
  const std::string& type = image.axes[axis].type;
  if (type == "time") return AxisRole::time;
  if (type == "channel") return AxisRole::component;
  if (type == "space") {
    if (name == "x") return AxisRole::x;
    if (name == "y") return AxisRole::y;
    if (name == "z") return AxisRole::z;
    // Other names: the last three axes of space are z, y and x.
    std::size_t behind = 0;
    for (std::size_t i = axis + 1; i < image.axes.size(); ++i)
      if (image.axes[i].type == "space") ++behind;
    constexpr std::array kRoles{AxisRole::x, AxisRole::y, AxisRole::z};
    if (behind < kRoles.size()) return kRoles[behind];
  }
  return AxisRole::channel;
}

/// Returns the usual sign of a unit.
std::string unit_sign(const std::string& unit) {
  static constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"micrometer", "um"}, {"nanometer", "nm"}, {"millimeter", "mm"}, {"centimeter", "cm"},  {"meter", "m"},
      {"kilometer", "km"},  {"angstrom", "A"},   {"second", "s"},      {"millisecond", "ms"}, {"microsecond", "us"},
      {"minute", "min"},    {"hour", "h"},       {"day", "d"}};
  for (const auto& [name, sign] : kSigns)
    if (name == unit) return std::string(sign);
  return unit;
}

struct OmePlace {
  const ZarrImage* image = nullptr;
  std::size_t level = 0;
};

std::optional<OmePlace> ome_place(const ZarrFile& file, const std::string& path) {
  for (const ZarrImage& image : file.images())
    for (std::size_t i = 0; i < image.levels.size(); ++i)
      if (image.levels[i].path == path) return OmePlace{&image, i};
  return std::nullopt;
}

/// Returns the elements of one picture of an array: those along the axes of space.
double ome_elements(const ZarrImage& image, const ArrayInfo& array) {
  double count = 1;
  for (std::size_t i = 0; i < array.shape.size() && i < image.axes.size(); ++i)
    if (const AxisRole role = ome_role(image, i); role == AxisRole::x || role == AxisRole::y || role == AxisRole::z)
      count *= static_cast<double>(array.shape[i]);
  return count;
}

/// Sets the directions of the axes of space from a matrix that turns or shears them.
void set_ome_directions(const ZarrImage& image, const ZarrLevel& level, GridSpec& spec) {
  std::array<std::optional<std::size_t>, 3> places;
  for (std::size_t i = 0; i < image.axes.size(); ++i) {
    const AxisRole role = ome_role(image, i);
    if (role == AxisRole::x) places[0] = i;
    if (role == AxisRole::y) places[1] = i;
    if (role == AxisRole::z) places[2] = i;
  }
  for (int column = 0; column < 3; ++column) {
    const auto from = places[static_cast<std::size_t>(column)];
    if (!from) continue;
    glm::dvec3 direction(0);
    for (int row = 0; row < 3; ++row)
      if (const auto to = places[static_cast<std::size_t>(row)]) direction[row] = level.matrix[*to][*from];
    const double length = glm::length(direction);
    if (!(length > 0) || !std::isfinite(length)) continue;
    spec.directions[column] = direction / length;
    spec.axes[*from].step = length;
  }
  // The shift is one of the world, but the position of the first element is one along the turned axes.
  glm::dvec3 shift(0);
  for (int row = 0; row < 3; ++row)
    if (const auto to = places[static_cast<std::size_t>(row)]) shift[row] = level.translation[*to];
  if (std::abs(glm::determinant(spec.directions)) < 1e-9) return;
  shift = glm::inverse(spec.directions) * shift;
  for (int column = 0; column < 3; ++column)
    if (const auto from = places[static_cast<std::size_t>(column)]) spec.axes[*from].first = shift[column];
}

}  // namespace

bool suits_ome(DatasetTree& tree) {
  const ZarrFile* const file = zarr_of_tree(tree);
  return file && !file->images().empty();
}

std::vector<DatasetEntry> list_ome(DatasetTree& tree) {
  const ZarrFile& file = *zarr_of_tree(tree);
  std::vector<DatasetEntry> entries, others;
  for (const ArrayInfo& array : tree.arrays()) {
    DatasetEntry entry = entry_of(tree, array);
    const auto place = ome_place(file, array.path);
    if (!place || !is_readable(array)) {
      if (!array.problem.empty()) entry.note = array.problem;
      others.push_back(std::move(entry));
      continue;
    }
    const ZarrImage& image = *place->image;
    entry.form = DatasetForm::volume;
    entry.axes.clear();
    for (const ZarrAxis& axis : image.axes) entry.axes += (entry.axes.empty() ? "" : ", ") + axis.name;
    entry.note = "level " + std::to_string(place->level) + " of " + std::to_string(image.levels.size());
    if (image.labels) entry.note += ", labels";
    if (!image.name.empty() && image.name.size() < 64) entry.note += ", image '" + image.name + "'";
    // The finest level of the first image that is not too large to read as a whole; else the coarsest one.
    const double most = file.is_remote() ? kMostRemoteOme : kMostLocalOme, count = ome_elements(image, array);
    const double others_first = image.labels ? 1e18 : &image == &file.images().front() ? 1 : 1e9;
    entry.rank = (count <= most ? count : 1 / count) / others_first;
    // Views read parts of the finest level.
    entry.view_rank = image.labels ? entry.rank : count / others_first;
    entries.push_back(std::move(entry));
  }
  std::ranges::move(others, std::back_inserter(entries));
  return entries;
}

namespace {

/// Opens one level of an image.
VolumeResult open_ome_level(DatasetTree& tree, const ZarrImage& image, const ZarrLevel& level,
                            const VoxelComponent& choice) {
  const auto array = tree.index_of(level.path);
  if (!array) return std::string("its array is missing");
  GridSpec spec;
  spec.arrays = {*array};
  spec.path = level.path;
  spec.title = image.name;
  spec.labels = image.labels;
  if (!image.labels) read_value_attributes(tree, tree.arrays()[*array], spec);
  const std::vector<std::uint64_t>& shape = tree.arrays()[*array].shape;
  for (std::size_t i = 0; i < image.axes.size(); ++i) {
    GridAxis axis;
    axis.role = ome_role(image, i);
    axis.name = image.axes[i].name;
    axis.first = level.translation[i];
    axis.step = level.scale[i];
    if (axis.step == 0 || !std::isfinite(axis.step)) axis.step = 1;
    // Channels that the user chose by number, or too many of them for components.
    if (axis.role == AxisRole::component && (choice.channel || shape[i] > qnv::kMaxValueComponents))
      axis.role = AxisRole::channel;
    if (axis.role == AxisRole::time)
      for (std::uint64_t step = 0; step < std::min<std::uint64_t>(shape[i], qnv::kMaxSteps); ++step)
        axis.positions.push_back(axis.first + axis.step * static_cast<double>(step));
    const std::string unit = unit_sign(image.axes[i].unit);
    if (axis.role == AxisRole::x && !unit.empty()) spec.metadata.emplace_back("space units", unit);
    if (axis.role == AxisRole::time && !unit.empty()) spec.metadata.emplace_back("time unit", unit);
    spec.axes.push_back(std::move(axis));
  }
  if (!level.matrix.empty()) set_ome_directions(image, level, spec);
  for (std::size_t i = 0; i < image.channels.size() && i < qnv::kMaxValueComponents; ++i)
    if (!image.channels[i].empty()) spec.metadata.emplace_back("channel " + std::to_string(i), image.channels[i]);
  return open_grid(tree, std::move(spec), choice);
}

}  // namespace

VolumeResult ome_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  const auto place = ome_place(*zarr_of_tree(tree), entry.path);
  if (!place) return std::string("it belongs to no image");
  const ZarrImage& image = *place->image;
  VolumeResult result = open_ome_level(tree, image, image.levels[place->level], choice);
  auto* const source = std::get_if<qnv::VolumeSource>(&result);
  if (!source) return result;
  // Coarser levels, if they have fewer voxels in each step.
  std::uint64_t least = qnv::voxel_count(source->layout);
  for (std::size_t i = place->level + 1; i < image.levels.size(); ++i) {
    VolumeResult coarse = open_ome_level(tree, image, image.levels[i], choice);
    auto* const one = std::get_if<qnv::VolumeSource>(&coarse);
    if (!one || qnv::voxel_count(one->layout) >= least || qnv::voxel_count(one->layout) < kLeastOmeVoxels) break;
    least = qnv::voxel_count(one->layout);
    source->coarser.insert(source->coarser.begin(), std::move(*one));
  }
  return result;
}

}  // namespace gs::app
