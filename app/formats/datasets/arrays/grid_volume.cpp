#include "app/formats/datasets/arrays/grid_volume.h"

#include "app/formats/common/dataset_list.h"
#include "app/formats/datasets/arrays/grid_reader.h"
#include "qnv/container/step_table.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace gs::app {
namespace {

/// Even positions along an axis, each between two elements of the array.
struct Resampling {
  struct Place {
    std::uint32_t below = 0, above = 0;
    float weight = 0;  // of the element above
  };
  std::vector<Place> places{};  // none if the elements are evenly spaced
  std::uint64_t count = 0;
  double first = 0, step = 1;

  [[nodiscard]] Place place(std::uint32_t i) const { return places.empty() ? Place{i, i, 0} : places[i]; }
};

double mixed(double below, double above, float weight, bool nearest) {
  if (nearest || below != below || above != above) return weight < 0.5f ? below : above;
  return below + (above - below) * static_cast<double>(weight);
}

/// Returns the even positions for uneven ones. `positions` ascend or descend strictly.
Resampling resampling_of(std::span<const double> positions) {
  Resampling made;
  const std::size_t count = positions.size();
  const double extent = positions.back() - positions.front();
  double least = std::abs(extent);
  for (std::size_t i = 1; i < count; ++i) least = std::min(least, std::abs(positions[i] - positions[i - 1]));
  constexpr double kFiner = 4;
  const double wanted = std::min(std::abs(extent) / least, kFiner * static_cast<double>(count));
  const auto places = static_cast<std::size_t>(std::max(std::ceil(wanted), static_cast<double>(count - 1))) + 1;
  made.first = positions.front();
  made.step = extent / static_cast<double>(places - 1);
  made.count = places;
  std::size_t below = 0;
  for (std::size_t i = 0; i < places; ++i) {
    const double at = made.first + made.step * static_cast<double>(i);
    while (below + 2 < count && (extent > 0 ? positions[below + 1] <= at : positions[below + 1] >= at)) ++below;
    const double share = (at - positions[below]) / (positions[below + 1] - positions[below]);
    made.places.push_back({static_cast<std::uint32_t>(below), static_cast<std::uint32_t>(below + 1),
                           static_cast<float>(std::clamp(share, 0.0, 1.0))});
  }
  return made;
}

Resampling identity_of(const GridAxis* axis, std::uint64_t count) {
  Resampling made;
  if (axis) made.first = axis->first, made.step = axis->step;
  made.count = count;
  return made;
}

bool ascends_strictly(std::span<const double> positions) {
  if (positions.size() < 2) return false;
  const bool up = positions[1] > positions[0];
  for (std::size_t i = 1; i < positions.size(); ++i)
    if (!(up ? positions[i] > positions[i - 1] : positions[i] < positions[i - 1])) return false;
  return std::isfinite(positions.front()) && std::isfinite(positions.back());
}

/// Form in which the slices of a grid are given.
enum class GridForm : std::uint8_t {
  stored,   // as in the file
  doubles,  // 64-bit integers, as doubles without slope and intercept
  values,   // floats with slope and intercept, and NaN for what is missing
};

/// Builds the source of one step.
class GridBuilder {
 public:
  GridBuilder(const DatasetTree& tree, GridSpec spec, const VoxelComponent& choice)
      : choice_(choice),
        array_(tree.arrays()[spec.arrays.front()]),
        slabs_(std::make_shared<SlabReader>(tree)),
        budget_(tree.budget()) {
    spec_ = std::make_shared<const GridSpec>(std::move(spec));
  }

  VolumeResult build() {
    for (std::size_t i = 0; i < spec_->axes.size(); ++i) {
      const GridAxis& axis = spec_->axes[i];
      if (array_.shape[i] == 0) return std::string("it has no elements");
      if (axis.role == AxisRole::time) time_axis_ = i;
      if (axis.role == AxisRole::component) component_axis_ = i;
      if (axis.role == AxisRole::channel) channels_ *= array_.shape[i];
    }
    components_ = spec_->arrays.size() > 1 ? spec_->arrays.size()
                  : component_axis_        ? array_.shape[*component_axis_]
                                           : array_.parts;
    if (choice_.found) {
      choice_.found->components = components_;
      choice_.found->component_names = array_.part_names;
      choice_.found->channels = channels_;
    }
    if (choice_.channel && *choice_.channel >= channels_)
      return "no channel " + std::to_string(*choice_.channel) + "; expected 0" +
             (channels_ > 1 ? " to " + std::to_string(channels_ - 1) : "");
    if (!choice_.magnitude && choice_.index >= components_)
      return "no component " + std::to_string(choice_.index) + "; expected " +
             (components_ == 1 ? "0, because each voxel has one number"
                               : "0 to " + std::to_string(components_ - 1) + ", or magnitude");
    if (std::string problem = plan(); !problem.empty()) return problem;
    if (!time_axis_ || array_.shape[*time_axis_] < 2) return source_of(0);
    return series();
  }

 private:
  VolumeResult series() {
    const GridAxis& axis = spec_->axes[*time_axis_];
    const std::uint64_t count = array_.shape[*time_axis_];
    if (count > qnv::kMaxSteps)
      return std::to_string(count) + " steps; expected at most " + std::to_string(qnv::kMaxSteps);
    std::vector<double> times = axis.positions;
    const bool ascend = times.size() == count && std::is_sorted(times.begin(), times.end()) &&
                        std::ranges::all_of(times, [](double time) { return std::isfinite(time); });
    if (!ascend) {
      times.resize(static_cast<std::size_t>(count));
      for (std::size_t i = 0; i < times.size(); ++i) times[i] = axis.first + axis.step * static_cast<double>(i);
    }
    if (choice_.found) choice_.found->times = times;
    if (choice_.step) {
      if (!choice_.step->time && choice_.step->number >= count)
        return "no step " + std::to_string(choice_.step->number) + "; expected 0 to " + std::to_string(count - 1);
      return source_of(qnv::step_number(*choice_.step, times));
    }
    if (layout_.labels) return source_of(0);
    std::vector<qnv::VolumeSource> steps;
    for (std::uint64_t i = 0; i < count; ++i) {
      VolumeResult made = source_of(i);
      if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
      steps.push_back(std::move(std::get<qnv::VolumeSource>(made)));
    }
    qnv::VolumeSource source = steps.front();
    source.steps = std::move(steps);
    source.times = std::move(times);
    return source;
  }

  [[nodiscard]] const GridAxis* axis_of(AxisRole role) const {
    for (const GridAxis& axis : spec_->axes)
      if (axis.role == role) return &axis;
    return nullptr;
  }

  /// Determines the layout and the form of the slices. Returns a message on failure.
  std::string plan() {
    const GridReader reader(slabs_, spec_, array_);
    glm::dvec3 origin(0);
    bool uneven = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const GridAxis* const axis = axis_of(static_cast<AxisRole>(i));
      const bool resample = axis && axis->positions.size() == reader.size()[i] && ascends_strictly(axis->positions);
      along_[i] = resample ? resampling_of(axis->positions) : identity_of(axis, reader.size()[i]);
      uneven = uneven || resample;
      if (along_[i].count > std::numeric_limits<std::uint32_t>::max()) return "an axis is too long";
      layout_.dimensions[i] = static_cast<std::uint32_t>(along_[i].count);
      const auto column = static_cast<int>(i);
      layout_.axes[i] = glm::vec3(spec_->directions[column] * along_[i].step);
      origin += spec_->directions[column] * along_[i].first;
    }
    layout_.origin = origin;
    layout_.labels = choice_.labels.value_or(spec_->labels) && !choice_.magnitude;
    const bool whole = array_.type != NumberType::f32 && array_.type != NumberType::f64;
    nearest_ = layout_.labels || (whole && spec_->slope == 1 && spec_->intercept == 0);
    std::vector<double> missing = spec_->missing;
    std::erase_if(missing, [](double one) { return one != one; });
    NumberType type = array_.type;
    if (spec_->reads_unsigned && type < NumberType::f32 && (static_cast<int>(type) & 1) != 0)
      type = static_cast<NumberType>(static_cast<int>(type) - 1);
    if (uneven || missing.size() > 1 || spec_->least || spec_->most)
      form_ = GridForm::values;
    else if (type >= NumberType::u64)
      form_ = GridForm::doubles;
    layout_.type = form_ == GridForm::values    ? qnv::VoxelType::f32
                   : form_ == GridForm::doubles ? qnv::VoxelType::f64
                                                : static_cast<qnv::VoxelType>(type);
    layout_.big_endian = std::endian::native == std::endian::big;
    if (form_ != GridForm::values) {
      layout_.slope = spec_->slope;
      layout_.intercept = spec_->intercept;
      if (!missing.empty()) layout_.missing = missing.front();
    }
    layout_.colors = spec_->colors && form_ == GridForm::stored && type == NumberType::u8 && !layout_.missing &&
                     !layout_.labels && !choice_.chosen && !choice_.magnitude && (components_ == 3 || components_ == 4);
    if (layout_.colors) layout_.slope = 1, layout_.intercept = 0;
    add_metadata(layout_, "dataset", spec_->path);
    add_metadata(layout_, "title", spec_->title);
    add_metadata(layout_, "units", spec_->unit);
    for (const auto& [key, value] : spec_->metadata) add_metadata(layout_, key, value);
    if (choice_.channel || channels_ > 1)
      add_metadata(layout_, "channel",
                   std::to_string(choice_.channel.value_or(0)) + " of " + std::to_string(channels_));
    mend(layout_);
    set_base(layout_);
    if (const auto problem = qnv::check(layout_)) return problem->message;
    const std::uint64_t plane = qnv::slice_voxels(layout_) * (sizeof(double) * 4);
    if (plane > budget_->left(Resource::volumes))
      return "slices of " + std::to_string(qnv::slice_voxels(layout_)) + " voxels take " +
             budget_->refusal(Resource::volumes);
    return {};
  }

  [[nodiscard]] std::shared_ptr<GridReader> reader_of(std::uint64_t step, std::uint64_t component) const {
    auto reader = std::make_shared<GridReader>(slabs_, spec_, array_);
    const bool apart = spec_->arrays.size() > 1;
    reader->choose_array(spec_->arrays[apart ? static_cast<std::size_t>(component) : 0]);
    if (!apart) reader->choose_component(component);
    if (time_axis_) reader->choose_index(*time_axis_, step);
    std::uint64_t rest = choice_.channel.value_or(0);
    for (std::size_t i = spec_->axes.size(); i-- > 0;) {
      if (spec_->axes[i].role != AxisRole::channel) continue;
      reader->choose_index(i, rest % array_.shape[i]);
      rest /= array_.shape[i];
    }
    return reader;
  }

  /// Returns a function that reads the values of a slice of the file.
  using ReadValues = std::function<bool(std::uint64_t z, std::vector<double>& to)>;
  /// Returns a function that gives interpolated values as floats.
  [[nodiscard]] auto interpolated(ReadValues read) const {
    return [read = std::move(read), along = along_, nearest = nearest_, width = axis_size(0),
            below = std::vector<double>(),
            above = std::vector<double>()](std::uint32_t z, std::span<std::byte> to) mutable {
      const auto columns = static_cast<std::uint32_t>(along[0].count),
                 rows = static_cast<std::uint32_t>(along[1].count);
      if (z >= along[2].count || to.size() != std::size_t{columns} * rows * sizeof(float)) return false;
      const Resampling::Place place = along[2].place(z);
      if (!read(place.below, below)) return false;
      if (place.weight > 0) {
        if (!read(place.above, above)) return false;
        for (std::size_t i = 0; i < below.size(); ++i) below[i] = mixed(below[i], above[i], place.weight, nearest);
      }
      std::byte* next = to.data();
      for (std::uint32_t y_to = 0; y_to < rows; ++y_to)
        for (std::uint32_t x_to = 0; x_to < columns; ++x_to) {
          const Resampling::Place row = along[1].place(y_to), column = along[0].place(x_to);
          const auto at = [&](std::uint32_t y) {
            const double* const values = below.data() + std::size_t{y} * width;
            return column.weight > 0 ? mixed(values[column.below], values[column.above], column.weight, nearest)
                                     : values[column.below];
          };
          const double value =
              row.weight > 0 ? mixed(at(row.below), at(row.above), row.weight, nearest) : at(row.below);
          const auto number = static_cast<float>(value);
          std::memcpy(next, &number, sizeof number);
          next += sizeof number;
        }
      return true;
    };
  }
  [[nodiscard]] std::size_t axis_size(std::size_t axis) const {
    return static_cast<std::size_t>(GridReader(slabs_, spec_, array_).size()[axis]);
  }

  [[nodiscard]] qnv::VolumeSource source_of_component(std::uint64_t step, std::uint64_t component) const {
    qnv::VolumeSource source;
    source.layout = layout_;
    const auto reader = reader_of(step, component);
    if (form_ == GridForm::values)
      source.read =
          interpolated([reader](std::uint64_t z, std::vector<double>& to) { return reader->read_values(z, to); });
    else if (form_ == GridForm::doubles)
      source.read = [reader, numbers = std::vector<double>()](std::uint32_t z, std::span<std::byte> to) mutable {
        if (!reader->read_numbers(z, numbers) || to.size() != numbers.size() * sizeof(double)) return false;
        std::memcpy(to.data(), numbers.data(), to.size());
        return true;
      };
    else
      source.read = [reader](std::uint32_t z, std::span<std::byte> to) { return reader->read_stored(z, to); };
    set_box_reader(source, reader);
    return source;
  }

  /// Sets the function that reads boxes, unless values are interpolated.
  void set_box_reader(qnv::VolumeSource& source, const std::shared_ptr<GridReader>& reader) const {
    for (const Resampling& axis : along_)
      if (!axis.places.empty()) return;
    source.chunk = reader->chunk();
    if (form_ == GridForm::stored) {
      source.read_box = [reader, dimensions = layout_.dimensions, number = size_of(reader->type())](
                            const qnv::VoxelBox& box, std::span<std::byte> to) {
        return qnv::lies_in(box, dimensions) && to.size() == qnv::voxel_count(box) * number &&
               reader->read_stored(box, to);
      };
      return;
    }
    source.read_box = [reader, dimensions = layout_.dimensions, form = form_, numbers = std::vector<double>()](
                          const qnv::VoxelBox& box, std::span<std::byte> to) mutable {
      const std::size_t number = form == GridForm::values ? sizeof(float) : sizeof(double);
      if (!qnv::lies_in(box, dimensions) || to.size() != qnv::voxel_count(box) * number) return false;
      if (!(form == GridForm::values ? reader->read_values(box, numbers) : reader->read_numbers(box, numbers)))
        return false;
      std::byte* next = to.data();
      for (const double one : numbers) {
        const auto narrow = static_cast<float>(one);
        std::memcpy(next, form == GridForm::values ? static_cast<const void*>(&narrow) : &one, number);
        next += number;
      }
      return true;
    };
  }

  [[nodiscard]] qnv::VolumeSource magnitude_of_step(std::uint64_t step) const {
    qnv::VolumeSource source;
    source.layout = layout_;
    source.layout.type = qnv::VoxelType::f32;
    source.layout.slope = 1;
    source.layout.intercept = 0;
    source.layout.missing.reset();
    std::vector<std::shared_ptr<GridReader>> readers;
    for (std::uint64_t i = 0; i < components_; ++i) readers.push_back(reader_of(step, i));
    source.read =
        interpolated([readers, part = std::vector<double>()](std::uint64_t z, std::vector<double>& to) mutable {
          to.clear();
          for (const auto& reader : readers) {
            if (!reader->read_values(z, part)) return false;
            to.resize(part.size(), 0);
            for (std::size_t i = 0; i < part.size(); ++i) to[i] += part[i] * part[i];
          }
          for (double& one : to) one = std::sqrt(one);
          return true;
        });
    return source;
  }

  VolumeResult source_of(std::uint64_t step) const {
    if (choice_.magnitude && components_ > 1) {
      if (components_ > qnv::kMaxValueComponents)
        return std::to_string(components_) + " components have no magnitude; expected at most " +
               std::to_string(qnv::kMaxValueComponents);
      qnv::VolumeSource source = magnitude_of_step(step);
      add_metadata(source.layout, "component", "magnitude of " + std::to_string(components_));
      return source;
    }
    qnv::VolumeSource source = source_of_component(step, choice_.magnitude ? 0 : choice_.index);
    if (components_ > 1 && components_ <= qnv::kMaxValueComponents && !choice_.chosen && !layout_.labels)
      for (std::uint64_t i = 0; i < components_; ++i) source.components.push_back(source_of_component(step, i));
    if (layout_.colors) return qnv::color_source(std::move(source.components));
    if (components_ > 1)
      add_metadata(source.layout, "component", std::to_string(choice_.index) + " of " + std::to_string(components_));
    return source;
  }

  VoxelComponent choice_;
  ArrayInfo array_;
  std::shared_ptr<SlabReader> slabs_;
  WorldBudget budget_;
  std::shared_ptr<const GridSpec> spec_;
  std::optional<std::size_t> time_axis_, component_axis_;
  std::uint64_t channels_ = 1, components_ = 1;
  std::array<Resampling, 3> along_;
  qnv::VolumeLayout layout_;
  GridForm form_ = GridForm::stored;
  bool nearest_ = false;
};

}  // namespace

bool is_even(std::span<const double> positions) {
  if (positions.size() < 2) return true;
  const double step = (positions.back() - positions.front()) / static_cast<double>(positions.size() - 1);
  if (!std::isfinite(step) || step == 0) return false;
  constexpr double kTolerance = 0.01;
  const double rounding = 4e-7 * std::max(std::abs(positions.front()), std::abs(positions.back()));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double expected = positions.front() + step * static_cast<double>(i);
    if (!(std::abs(positions[i] - expected) <= kTolerance * std::abs(step) + rounding)) return false;
  }
  return true;
}

VolumeResult open_grid(const DatasetTree& tree, GridSpec spec, const VoxelComponent& choice) {
  return GridBuilder(tree, std::move(spec), choice).build();
}

}  // namespace gs::app
