#include "app/formats/datasets/conventions/vtkhdf_amr.h"

#include "app/formats/datasets/arrays/grid_volume.h"
#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/conventions/mesh_arrays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint64_t kMostAmrVoxels = std::uint64_t{1} << 26;
constexpr std::size_t kMostAmrLevels = 32, kMostAmrBoxes = 1'000'000;

std::string amr_level_path(std::size_t level) { return "/VTKHDF/Level" + std::to_string(level); }

/// Box of cells, inclusive, in the indices of its level, and the place of its first value.
struct AmrBox {
  std::array<std::int64_t, 3> first{}, last{};
  std::uint64_t value = 0;

  [[nodiscard]] std::uint64_t count(std::size_t axis) const {
    return static_cast<std::uint64_t>(last[axis] - first[axis] + 1);
  }
};
struct AmrLevel {
  std::size_t array = 0;  // of the values
  std::array<double, 3> spacing{1, 1, 1};
  std::vector<AmrBox> boxes;
};

/// All levels of an array as one grid with the voxels of the level `target`.
class AmrFile final : public ArrayFile {
 public:
  AmrFile(std::shared_ptr<ArrayFile> source, std::vector<AmrLevel> levels, std::size_t target, const AmrBox& whole)
      : source_(std::move(source)), levels_(std::move(levels)), target_(target), whole_(whole) {
    ArrayInfo info = source_->arrays()[levels_.front().array];
    info.parts *= info.shape.size() > 1 ? static_cast<std::uint32_t>(info.shape[1]) : 1;
    info.shape = {whole_.count(2), whole_.count(1), whole_.count(0)};
    info.chunk.clear();
    info.dimensions.clear();
    element_ = size_of(info.type) * info.parts;
    arrays_.push_back(std::move(info));
  }

  const std::vector<ArrayInfo>& arrays() const override { return arrays_; }
  const std::vector<std::string>& groups() const override { return groups_; }
  std::vector<ArrayAttribute> attributes(const std::string&) override { return {}; }

  std::string read(std::size_t, std::span<const std::uint64_t> first, std::span<const std::uint64_t> count,
                   std::span<std::byte> to) override {
    if (first.size() != 3 || count.size() != 3) return "its axes differ";
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t size = arrays_.front().shape[i];
      if (first[i] > size || count[i] > size - first[i]) return "the part lies outside";
    }
    if (to.size() != count[0] * count[1] * count[2] * element_) return "the size differs";
    fill_missing(to);
    for (std::size_t level = 0; level < levels_.size(); ++level)
      for (std::size_t box = 0; box < levels_[level].boxes.size(); ++box)
        if (std::string problem = paint(level, box, first, count, to); !problem.empty()) return problem;
    return {};
  }

 private:
  void fill_missing(std::span<std::byte> to) const {
    const NumberType type = arrays_.front().type;
    std::ranges::fill(to, std::byte{0});
    const auto fill = [&]<class T>(T none) {
      for (std::size_t i = 0; i + sizeof(T) <= to.size(); i += sizeof(T))
        std::memcpy(to.data() + i, &none, sizeof none);
    };
    if (type == NumberType::f32) fill(std::numeric_limits<float>::quiet_NaN());
    if (type == NumberType::f64) fill(std::numeric_limits<double>::quiet_NaN());
  }
  /// Returns the cell of a level at the centre of a voxel.
  [[nodiscard]] std::int64_t cell_at(std::size_t level, std::size_t axis, std::uint64_t voxel) const {
    const double ratio = levels_[target_].spacing[axis] / levels_[level].spacing[axis];
    return static_cast<std::int64_t>(
        std::floor((static_cast<double>(whole_.first[axis]) + static_cast<double>(voxel) + 0.5) * ratio));
  }
  /// Returns the voxels, from `first` on, with their centres in a box.
  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> voxels_in(std::size_t level, const AmrBox& box,
                                                                  std::size_t axis, std::uint64_t first,
                                                                  std::uint64_t count) const {
    const double ratio = levels_[level].spacing[axis] / levels_[target_].spacing[axis];
    const double low = static_cast<double>(box.first[axis]) * ratio - static_cast<double>(whole_.first[axis]) - 2,
                 high = static_cast<double>(box.last[axis] + 1) * ratio - static_cast<double>(whole_.first[axis]) + 2;
    const auto end = static_cast<double>(first + count);
    auto begin = static_cast<std::uint64_t>(std::clamp(low, static_cast<double>(first), end));
    auto behind = static_cast<std::uint64_t>(std::clamp(high, static_cast<double>(first), end));
    while (begin < behind && cell_at(level, axis, begin) < box.first[axis]) ++begin;
    while (begin < behind && cell_at(level, axis, behind - 1) > box.last[axis]) --behind;
    return {begin, behind};
  }
  std::string paint(std::size_t level, std::size_t number, std::span<const std::uint64_t> first,
                    std::span<const std::uint64_t> count, std::span<std::byte> to) {
    const AmrBox& box = levels_[level].boxes[number];
    std::array<std::pair<std::uint64_t, std::uint64_t>, 3> range;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      range[axis] = voxels_in(level, box, axis, first[2 - axis], count[2 - axis]);
      if (range[axis].first >= range[axis].second) return {};
    }
    for (std::uint64_t z = range[2].first; z < range[2].second; ++z) {
      const std::vector<std::byte>* layer = nullptr;
      if (std::string problem = layer_of(level, number, cell_at(level, 2, z), layer); !problem.empty()) return problem;
      for (std::uint64_t y = range[1].first; y < range[1].second; ++y) {
        const auto row = static_cast<std::uint64_t>(cell_at(level, 1, y) - box.first[1]);
        std::byte* const next = to.data() + ((z - first[0]) * count[1] + (y - first[1])) * count[2] * element_;
        for (std::uint64_t x = range[0].first; x < range[0].second; ++x) {
          const auto column = static_cast<std::uint64_t>(cell_at(level, 0, x) - box.first[0]);
          std::memcpy(next + (x - first[2]) * element_, layer->data() + (row * box.count(0) + column) * element_,
                      element_);
        }
      }
    }
    return {};
  }
  /// Returns the values of a layer of cells of a box, and keeps them.
  std::string layer_of(std::size_t level, std::size_t number, std::int64_t z, const std::vector<std::byte>*& layer) {
    constexpr std::size_t kMostKept = 4096, kMostBytes = std::size_t{64} << 20;
    const AmrBox& box = levels_[level].boxes[number];
    const std::pair<std::size_t, std::size_t> key{level, number};
    if (const auto known = kept_.find(key); known != kept_.end() && known->second.first == z) {
      layer = &known->second.second;
      return {};
    }
    if (kept_.size() >= kMostKept || kept_bytes_ > kMostBytes) {
      kept_.clear();
      kept_bytes_ = 0;
    }
    auto& [at, bytes] = kept_[key];
    kept_bytes_ -= bytes.size();
    at = z;
    const std::uint64_t cells = box.count(0) * box.count(1);
    const ArrayInfo& array = source_->arrays()[levels_[level].array];
    bytes.resize(static_cast<std::size_t>(cells) * element_);
    kept_bytes_ += bytes.size();
    std::vector<std::uint64_t> first(array.shape.size(), 0), count = array.shape;
    first[0] = box.value + cells * static_cast<std::uint64_t>(z - box.first[2]);
    count[0] = cells;
    layer = &bytes;
    std::string problem = source_->read(levels_[level].array, first, count, bytes);
    if (!problem.empty()) at = std::numeric_limits<std::int64_t>::min();
    return problem;
  }

  std::shared_ptr<ArrayFile> source_;
  std::vector<AmrLevel> levels_;
  std::size_t target_;
  AmrBox whole_;
  std::size_t element_ = 0;
  std::vector<ArrayInfo> arrays_;
  std::vector<std::string> groups_;
  std::map<std::pair<std::size_t, std::size_t>, std::pair<std::int64_t, std::vector<std::byte>>> kept_;
  std::size_t kept_bytes_ = 0;
};

/// Reads the boxes of a level. Returns a message on failure.
std::string read_amr_level(DatasetTree& tree, std::size_t number, const std::string& name, std::uint64_t step,
                           AmrLevel& level) {
  const std::string path = amr_level_path(number), steps = "/VTKHDF/Steps/Level" + std::to_string(number);
  const ArrayInfo* const values = tree.find(path + "/CellData/" + name);
  const ArrayInfo* const boxes = tree.find(path + "/AMRBox");
  if (!values || !boxes || values->shape.empty() || values->shape.size() > 2)
    return path + " has no CellData/" + name + " or no AMRBox";
  if (boxes->shape.size() != 2 || boxes->shape[1] != 6 || boxes->shape[0] > kMostAmrBoxes)
    return path + "/AMRBox has an impossible shape; expected boxes of six numbers";
  level.array = *tree.index_of(values->path);
  const std::vector<double> spacing = tree.numbers(path, "Spacing");
  for (std::size_t i = 0; i < 3 && spacing.size() == 3; ++i)
    level.spacing[i] = std::isfinite(spacing[i]) && spacing[i] > 0 ? spacing[i] : 1;
  const auto of_step = [&](const std::string& array, std::uint64_t otherwise) {
    auto read = tree.find(array) ? tree.rows(array, step, 1) : std::variant<std::vector<double>, std::string>();
    const auto* const row = std::get_if<std::vector<double>>(&read);
    return row && !row->empty() && (*row)[0] >= 0 && (*row)[0] < 1e15 ? static_cast<std::uint64_t>((*row)[0])
                                                                      : otherwise;
  };
  const std::uint64_t first = of_step(steps + "/AMRBoxOffset", 0),
                      count = of_step(steps + "/NumberOfAMRBox", boxes->shape[0]);
  const auto read = tree.rows(boxes->path, first, count);
  if (const auto* const problem = std::get_if<std::string>(&read)) return *problem;
  const auto& numbers = std::get<std::vector<double>>(read);
  std::uint64_t value = of_step(steps + "/CellDataOffsets/" + name, 0);
  for (std::size_t i = 0; i + 6 <= numbers.size(); i += 6) {
    AmrBox box;
    std::uint64_t cells = 1;
    constexpr double kMost = 1e9;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = numbers[i + 2 * axis], high = numbers[i + 2 * axis + 1];
      if (!(low >= -kMost && high <= kMost && low <= high)) return path + "/AMRBox has an impossible box";
      box.first[axis] = static_cast<std::int64_t>(low);
      box.last[axis] = static_cast<std::int64_t>(high);
      if (box.count(axis) > values->shape[0] / cells) return path + "/AMRBox has more cells than values";
      cells *= box.count(axis);
    }
    if (value > values->shape[0] || cells > values->shape[0] - value)
      return path + "/AMRBox has more cells than values";
    box.value = value;
    value += cells;
    level.boxes.push_back(box);
  }
  return {};
}

/// Returns the box of all cells of level 0, in the indices of a level.
AmrBox domain_at(const std::vector<AmrLevel>& levels, std::size_t level) {
  AmrBox whole = levels.front().boxes.front();
  for (const AmrBox& box : levels.front().boxes)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      whole.first[axis] = std::min(whole.first[axis], box.first[axis]);
      whole.last[axis] = std::max(whole.last[axis], box.last[axis]);
    }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double ratio = levels.front().spacing[axis] / levels[level].spacing[axis];
    const double first = std::floor(static_cast<double>(whole.first[axis]) * ratio + 1e-6),
                 behind = std::ceil(static_cast<double>(whole.last[axis] + 1) * ratio - 1e-6);
    constexpr double kMost = 4e18;
    whole.first[axis] = static_cast<std::int64_t>(std::clamp(first, -kMost, kMost));
    whole.last[axis] = static_cast<std::int64_t>(std::clamp(behind - 1, first, kMost));
  }
  return whole;
}

bool fits_amr(const AmrBox& box, std::uint64_t most) {
  double voxels = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    voxels *= static_cast<double>(box.last[axis]) - static_cast<double>(box.first[axis]) + 1;
  return voxels <= static_cast<double>(most);
}

}  // namespace

std::vector<DatasetEntry> list_vtkhdf_amr(DatasetTree& tree) {
  std::vector<DatasetEntry> all;
  std::size_t levels = 0;
  while (levels < kMostAmrLevels && tree.has_group(amr_level_path(levels))) ++levels;
  const std::string first = amr_level_path(0) + "/CellData";
  for (const ArrayInfo& array : tree.arrays()) {
    DatasetEntry entry = entry_of(tree, array);
    const bool of_cells = array.path.find("/CellData/") != std::string::npos;
    if (folder_of_path(array.path) == first && is_readable(array) && !array.shape.empty() && array.shape.size() <= 2) {
      entry.form = DatasetForm::volume;
      entry.note = "data of cells of " + std::to_string(levels) + (levels == 1 ? " level" : " levels");
      entry.is_minor = is_bookkeeping(array.path);
      entry.rank = entry.is_minor ? 1 : array.shape.size() == 1 ? 12 : 10;
    } else if (of_cells) {
      entry.note = "part of the dataset of level 0";
      entry.is_minor = true;
    } else if (array.path.find("/PointData/") != std::string::npos) {
      entry.note = "data of points of OverlappingAMR are not shown";
    }
    all.push_back(std::move(entry));
  }
  return all;
}

VolumeResult vtkhdf_amr_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  const std::string name = name_of_path(entry.path);
  auto read = tree.find("/VTKHDF/Steps/Values") ? tree.values("/VTKHDF/Steps/Values")
                                                : std::variant<std::vector<double>, std::string>();
  const auto* const times = std::get_if<std::vector<double>>(&read);
  const qnv::ShownStep wanted = choice.step.value_or(qnv::ShownStep());
  const std::size_t steps = times ? times->size() : 0;
  const std::uint64_t step = wanted.time && steps > 0 ? qnv::step_number(wanted, *times) : wanted.number;
  if (step >= std::max<std::size_t>(steps, 1))
    return "no step " + std::to_string(step) + "; expected 0 to " + std::to_string(std::max<std::size_t>(steps, 1) - 1);
  std::vector<AmrLevel> levels;
  std::string left_out;
  while (levels.size() < kMostAmrLevels && tree.has_group(amr_level_path(levels.size()))) {
    AmrLevel level;
    if (std::string problem = read_amr_level(tree, levels.size(), name, step, level); !problem.empty()) {
      if (levels.empty()) return problem;
      left_out = std::move(problem);
      break;
    }
    if (level.boxes.empty()) break;
    const ArrayInfo &one = tree.arrays()[level.array],
                    &first = tree.arrays()[levels.empty() ? level.array : levels.front().array];
    if (one.type != first.type || one.parts != first.parts || one.shape.size() != first.shape.size() ||
        (one.shape.size() > 1 && one.shape[1] != first.shape[1]))
      return one.path + " has another type than " + first.path;
    levels.push_back(std::move(level));
  }
  if (levels.empty()) return std::string("it has no boxes");
  const std::uint64_t most = std::min(kMostAmrVoxels, tree.budget()->left(Resource::volumes) / 32);
  std::size_t target = 0;
  for (std::size_t level = 1; level < levels.size(); ++level)
    if (fits_amr(domain_at(levels, level), most)) target = level;
  const AmrBox whole = domain_at(levels, target);
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 40;
  if (!fits_amr(whole, kLargest)) return std::string("its level 0 is too large");
  const std::array<double, 3> spacing = levels[target].spacing;
  const std::size_t used = levels.size();
  const auto file = std::make_shared<AmrFile>(tree.file(), std::move(levels), target, whole);
  const DatasetTree grid(file, tree.content(), tree.budget());
  GridSpec spec;
  spec.arrays = {0};
  spec.path = entry.path;
  spec.title = name;
  spec.unit = entry.unit;
  spec.axes.resize(3);
  std::vector<double> origin = tree.numbers("/VTKHDF", "Origin");
  if (origin.size() != 3) origin = {0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    GridAxis& axis = spec.axes[2 - i];
    axis.role = static_cast<AxisRole>(i);
    axis.step = spacing[i];
    axis.first = origin[i] + spacing[i] * (static_cast<double>(whole.first[i]) + 0.5);
  }
  spec.metadata.emplace_back("levels", "0 to " + std::to_string(used - 1));
  spec.metadata.emplace_back("level of the voxels", std::to_string(target));
  if (!left_out.empty()) spec.metadata.emplace_back("levels left out", left_out);
  VoxelComponent of_step = choice;
  of_step.step.reset();
  return open_grid(grid, std::move(spec), of_step);
}

}  // namespace gs::app
