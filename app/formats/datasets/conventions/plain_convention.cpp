#include "app/formats/datasets/conventions/conventions_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Arrays without a convention, and attributes that many programs share.

namespace gs::app {
namespace {

constexpr std::uint64_t kMostColors = 4;
constexpr std::size_t kMostAxes = 12;

/// Returns the role that the name of an axis states.
std::optional<AxisRole> named_role(std::string_view name) {
  static constexpr std::pair<std::string_view, AxisRole> kNames[] = {{"x", AxisRole::x},
                                                                     {"y", AxisRole::y},
                                                                     {"z", AxisRole::z},
                                                                     {"t", AxisRole::time},
                                                                     {"time", AxisRole::time},
                                                                     {"c", AxisRole::component},
                                                                     {"channel", AxisRole::component},
                                                                     {"depth", AxisRole::z},
                                                                     {"height", AxisRole::y},
                                                                     {"width", AxisRole::x}};
  return value_named(kNames, lower_case(name_of_path(name)));
}

/// Returns the names of the axes: those of the array, or of an attribute such as "tczyx".
std::vector<std::string> axis_names(DatasetTree& tree, const ArrayInfo& array) {
  if (array.dimensions.size() == array.shape.size()) return array.dimensions;
  for (const char* const name : {"axes", "axisorder", "dimension_order", "DimensionNames", "_ARRAY_DIMENSIONS"}) {
    const ArrayAttribute* const found = tree.attribute(array.path, name);
    if (!found || found->texts.empty()) continue;
    if (found->texts.size() == array.shape.size()) return found->texts;
    if (found->texts.front().size() == array.shape.size()) {
      std::vector<std::string> names;
      for (const char c : found->texts.front()) names.emplace_back(1, c);
      return names;
    }
  }
  return {};
}

bool set_named_roles(std::span<const std::string> names, std::vector<GridAxis>& axes) {
  bool used[static_cast<std::size_t>(AxisRole::channel) + 1]{};
  if (names.size() != axes.size()) return false;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto role = named_role(names[i]);
    if (!role || std::exchange(used[static_cast<std::size_t>(*role)], true)) return false;
    axes[i].role = *role;
  }
  return used[static_cast<std::size_t>(AxisRole::x)] && used[static_cast<std::size_t>(AxisRole::y)];
}

/// Sets roles by the order and the sizes of the axes: time, channel or component, z, y, x, component. A first axis that
/// can grow, or has a name for time, is time and not a channel, even if it is short.
void set_usual_roles(const ArrayInfo& array, std::span<const std::string> names, std::vector<GridAxis>& axes) {
  std::size_t end = axes.size();
  const bool first_is_time = array.first_grows || (!names.empty() && named_role(names.front()) == AxisRole::time);
  const auto small = [&](std::size_t axis) { return array.shape[axis] >= 2 && array.shape[axis] <= kMostColors; };
  const auto larger = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      if (array.shape[i] <= kMostColors) return false;
    return true;
  };
  bool has_components = array.parts > 1;
  if (!has_components && end >= 3 && small(end - 1) &&
      (end >= 4 ? larger(end - 4, end - 1) : array.type == NumberType::u8 && larger(0, 2))) {
    axes[--end].role = AxisRole::component;
    has_components = true;
  }
  constexpr AxisRole kSpace[] = {AxisRole::x, AxisRole::y, AxisRole::z};
  for (const AxisRole role : kSpace)
    if (end > 0) axes[--end].role = role;
  if (end > 0 && small(end - 1) && !has_components && !(end == 1 && first_is_time)) {
    axes[--end].role = AxisRole::component;
    has_components = true;
  }
  if (end == 2 && !has_components && array.shape[1] > 1) axes[--end].role = AxisRole::component;
  if (end == 1 && array.shape[0] > 1) axes[--end].role = AxisRole::time;
}

GridSpec plain_spec(DatasetTree& tree, const ArrayInfo& array) {
  GridSpec spec;
  spec.arrays = {*tree.index_of(array.path)};
  spec.path = array.path;
  spec.axes.resize(array.shape.size());
  const std::vector<std::string> names = axis_names(tree, array);
  if (!set_named_roles(names, spec.axes)) set_usual_roles(array, names, spec.axes);
  for (std::size_t i = 0; i < std::min(names.size(), spec.axes.size()); ++i) spec.axes[i].name = name_of_path(names[i]);
  read_common_attributes(tree, array, spec);
  spec.colors = true;
  return spec;
}

/// Applies numbers for the axes of space: one for all of them, or one for each in the order of the array.
template <class Apply>
void apply_to_space(std::span<const double> numbers, GridSpec& spec, Apply apply) {
  std::vector<GridAxis*> space;
  for (GridAxis& axis : spec.axes)
    if (axis.role <= AxisRole::z) space.push_back(&axis);
  if (numbers.size() == 1) {
    for (GridAxis* const axis : space) apply(*axis, numbers[0]);
  } else if (numbers.size() == space.size() || numbers.size() == spec.axes.size()) {
    const std::size_t skipped = numbers.size() - space.size();
    for (std::size_t i = 0; i < space.size(); ++i) apply(*space[i], numbers[i + skipped]);
  } else if (numbers.size() == 3 && space.size() == 2) {
    for (std::size_t i = 0; i < 2; ++i) apply(*space[i], numbers[i + 1]);
  }
}

}  // namespace

void read_value_attributes(DatasetTree& tree, const ArrayInfo& array, GridSpec& spec) {
  const std::string& path = array.path;
  for (const char* const name : {"units", "unit", "Units", "Unit"})
    if (spec.unit.empty()) spec.unit = tree.text(path, name);
  for (const char* const name : {"long_name", "title", "description"})
    if (spec.title.empty()) spec.title = tree.text(path, name);
  // Programs number the parts of a dataset: ".../SV_P/1".
  if (spec.title.empty()) spec.title = name_of_path(path);
  if (spec.title.find_first_not_of("0123456789") == std::string::npos && folder_of_path(path) != "/")
    spec.title = name_of_path(folder_of_path(path)) + "/" + spec.title;
  if (const auto scale = tree.number(path, "scale_factor"); scale && *scale != 0 && std::isfinite(*scale))
    spec.slope = *scale;
  if (const auto offset = tree.number(path, "add_offset"); offset && std::isfinite(*offset)) spec.intercept = *offset;
  const bool whole = array.type != NumberType::f32 && array.type != NumberType::f64;
  const bool has_sign = whole && (static_cast<int>(array.type) & 1) != 0;
  const std::string is_unsigned = lower_case(tree.text(path, "_Unsigned"));
  spec.reads_unsigned = has_sign && is_unsigned == "true";
  const double wrap = std::exp2(static_cast<double>(size_of(array.type) * 8));
  const auto stored = [&](double number) { return spec.reads_unsigned && number < 0 ? number + wrap : number; };
  for (const char* const name : {"_FillValue", "missing_value"})
    for (const double number : tree.numbers(path, name)) {
      const double one =
          array.type == NumberType::f32 ? static_cast<double>(static_cast<float>(number)) : stored(number);
      if (std::isfinite(one) && std::ranges::find(spec.missing, one) == spec.missing.end()) spec.missing.push_back(one);
    }
  const std::vector<double> range = tree.numbers(path, "valid_range");
  if (range.size() == 2) spec.least = stored(range[0]), spec.most = stored(range[1]);
  if (const auto least = tree.number(path, "valid_min")) spec.least = stored(*least);
  if (const auto most = tree.number(path, "valid_max")) spec.most = stored(*most);
  if (spec.least && !std::isfinite(*spec.least)) spec.least.reset();
  if (spec.most && !std::isfinite(*spec.most)) spec.most.reset();
}

void read_common_attributes(DatasetTree& tree, const ArrayInfo& array, GridSpec& spec) {
  read_value_attributes(tree, array, spec);
  const std::string& path = array.path;
  const bool whole = array.type != NumberType::f32 && array.type != NumberType::f64;
  spec.labels = whole && spec.slope == 1 && spec.intercept == 0 && !tree.numbers(path, "flag_values").empty();
  static constexpr std::pair<const char*, const char*> kSpacings[] = {
      {"element_size_um", "um"}, {"element_size", ""}, {"spacing", ""},    {"voxel_size", ""},
      {"voxel_spacing", ""},     {"voxelsize", ""},    {"pixel_size", ""}, {"resolution", ""}};
  for (const auto& [name, unit] : kSpacings) {
    const std::vector<double> numbers = tree.numbers(path, name);
    if (numbers.empty() || !std::ranges::all_of(numbers, [](double n) { return std::isfinite(n) && n > 0; })) continue;
    apply_to_space(numbers, spec, [](GridAxis& axis, double number) { axis.step = number; });
    if (*unit != '\0') spec.metadata.emplace_back("space units", unit);
    break;
  }
  for (const char* const name : {"origin", "offset"})
    if (const std::vector<double> numbers = tree.numbers(path, name); numbers.size() > 1)
      return apply_to_space(numbers, spec, [](GridAxis& axis, double number) { axis.first = number; });
}

bool is_readable(const ArrayInfo& array) { return array.type != NumberType::none && array.problem.empty(); }

double element_count(const ArrayInfo& array) {
  double count = 1;
  for (const std::uint64_t size : array.shape) count *= static_cast<double>(size);
  return count;
}

DatasetEntry entry_of(DatasetTree& tree, const ArrayInfo& array) {
  DatasetEntry entry;
  entry.path = array.path;
  entry.shape = array.shape;
  entry.type = array.type_name;
  for (const char* const name : {"units", "unit", "Units", "Unit"})
    if (entry.unit.empty()) entry.unit = tree.text(array.path, name);
  for (const std::string& name : array.dimensions) entry.axes += (entry.axes.empty() ? "" : ", ") + name_of_path(name);
  entry.note = array.problem;
  return entry;
}

bool suits_any(DatasetTree&) { return true; }

std::vector<DatasetEntry> list_plain(DatasetTree& tree) {
  std::vector<DatasetEntry> all;
  for (const ArrayInfo& array : tree.arrays()) {
    DatasetEntry entry = entry_of(tree, array);
    const auto wide = std::ranges::count_if(array.shape, [](std::uint64_t size) { return size > 1; });
    const double count = element_count(array);
    if (is_readable(array) && array.shape.size() >= 2 && array.shape.size() <= kMostAxes && count >= 4) {
      entry.form = DatasetForm::volume;
      constexpr double kDeeper = 1000;
      entry.rank = std::log2(count) + kDeeper * static_cast<double>(std::min<std::ptrdiff_t>(wide, 3));
    }
    all.push_back(std::move(entry));
  }
  return all;
}

VolumeResult plain_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  const ArrayInfo* const array = tree.find(entry.path);
  if (!array) return std::string("there is no such array");
  return open_grid(tree, plain_spec(tree, *array), choice);
}

}  // namespace gs::app
