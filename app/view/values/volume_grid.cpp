#include "app/view/values/volume_grid.h"

#include "app/formats/volume/confined/confined_volume.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

namespace gs::app {
namespace {

glm::dmat3 grid_axes(const qnv::VolumeLayout& layout) {
  return {glm::dvec3(layout.axes[0]), glm::dvec3(layout.axes[1]), glm::dvec3(layout.axes[2])};
}

}  // namespace

std::variant<std::shared_ptr<const VolumeGrid>, std::string> VolumeGrid::read(const std::string& path,
                                                                              const std::atomic<bool>* stop,
                                                                              const WorldBudget& budget,
                                                                              std::uint64_t most_voxels,
                                                                              const VoxelComponent& component) {
  auto opened = open_volume_confined(path, {}, {nullptr, {}, component}, budget);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  auto taken = take(std::get<qnv::VolumeSource>(opened), stop, budget, most_voxels);
  if (auto* problem = std::get_if<std::string>(&taken)) return path + ": " + *problem;
  return taken;
}

std::variant<std::shared_ptr<const VolumeGrid>, std::string> VolumeGrid::take(
    const qnv::VolumeSource& source, const std::atomic<bool>* stop, const WorldBudget& budget,
    std::uint64_t most_voxels, const qnv::VolumeValues* about) {
  if (const auto problem = qnv::check(source.layout)) return problem->message;
  std::shared_ptr<VolumeGrid> grid(new VolumeGrid);
  grid->layout_ = source.layout;
  grid->whole_ = source.layout.dimensions;
  std::uint64_t count = 0;
  const auto count_kept = [&] {
    count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      grid->kept_[i] = (source.layout.dimensions[i] - 1) / grid->step_ + 1;
      count *= grid->kept_[i];
    }
  };
  grid->share_.emplace(budget, Resource::vectors);
  for (count_kept(); count > std::max<std::uint64_t>(most_voxels, 1); count_kept()) ++grid->step_;
  const std::size_t voxel_bytes = sizeof(float) + (qnv::has_colors(source) ? 4 : 0);
  while (!grid->share_->grow(count * voxel_bytes)) {
    if (count <= 8) return "not enough memory for the values of the volume";
    ++grid->step_;
    count_kept();
  }
  grid->values_.resize(count);
  std::vector<float> slice(qnv::slice_voxels(source.layout));
  std::vector<std::byte> scratch;
  float least = std::numeric_limits<float>::infinity(), most = -least;
  const std::size_t width = source.layout.dimensions[0];
  auto to = grid->values_.begin();
  for (std::uint32_t z = 0; z < grid->kept_[2]; ++z) {
    if (stop && *stop) return "the volume was closed";
    if (!qnv::read_slice(source, z * grid->step_, scratch, slice))
      return "slice " + std::to_string(z) + " cannot be read";
    for (std::uint32_t y = 0; y < grid->kept_[1]; ++y)
      for (std::uint32_t x = 0; x < grid->kept_[0]; ++x) {
        const float value = slice[std::size_t{y} * grid->step_ * width + std::size_t{x} * grid->step_];
        *to++ = value;
        least = std::min(least, value == value ? value : least);
        most = std::max(most, value == value ? value : most);
      }
  }
  if (!(least <= most)) return "the volume has no values";
  grid->range_ = {least, most};
  if (about) grid->describe(*about);
  if (qnv::has_colors(source) && !grid->read_colors(source)) return "the colours cannot be read";
  constexpr float kWhole = 16777216;  // larger whole numbers have no float of their own
  if (source.layout.labels && std::max(std::abs(grid->range_.first), std::abs(grid->range_.second)) > kWhole &&
      !grid->number_labels(source))
    return "the labels cannot be read";
  return std::shared_ptr<const VolumeGrid>(std::move(grid));
}

void VolumeGrid::describe(const qnv::VolumeValues& about) {
  range_ = about.range;
  bricks_ = about.bricks;
  error_ = about.error;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (about.whole[axis] == 0) continue;
    whole_[axis] = about.whole[axis];
    std::uint32_t voxels = whole_[axis];
    for (int level = 0; level < about.level && voxels > 1; ++level) {
      voxels = voxels / 2 + voxels % 2;
      fineness_[axis] *= 2;
    }
  }
}

bool VolumeGrid::read_colors(const qnv::VolumeSource& source) {
  colors_.assign(values_.size(), {0, 0, 0, 255});
  const std::size_t width = source.layout.dimensions[0];
  std::vector<std::byte> plane(qnv::slice_voxels(source.layout));
  for (std::uint32_t z = 0; z < kept_[2]; ++z)
    for (std::size_t c = 0; c < source.components.size(); ++c) {
      if (!source.components[c].read(z * step_, plane)) return false;
      auto to = colors_.begin() + static_cast<std::ptrdiff_t>(std::size_t{z} * kept_[1] * kept_[0]);
      for (std::uint32_t y = 0; y < kept_[1]; ++y)
        for (std::uint32_t x = 0; x < kept_[0]; ++x)
          (*to++)[c] = std::to_integer<std::uint8_t>(plane[std::size_t{y} * step_ * width + std::size_t{x} * step_]);
    }
  return true;
}

bool VolumeGrid::number_labels(const qnv::VolumeSource& source) {
  std::vector<std::byte> stored(qnv::slice_voxels(source.layout) * qnv::size_of(source.layout.type));
  std::vector<double> numbers(qnv::slice_voxels(source.layout));
  const std::size_t width = source.layout.dimensions[0];
  const auto visit = [&](auto&& take) {
    for (std::uint32_t z = 0; z < kept_[2]; ++z) {
      if (!source.read(z * step_, stored)) return false;
      qnv::stored_numbers(source.layout, stored, numbers);
      for (std::uint32_t y = 0; y < kept_[1]; ++y)
        for (std::uint32_t x = 0; x < kept_[0]; ++x)
          take(numbers[std::size_t{y} * step_ * width + std::size_t{x} * step_]);
    }
    return true;
  };
  std::set<double> found;
  const bool read = visit([&, last = 0.0](double number) mutable {
    if (number == number && (number != last || found.empty())) found.insert(last = number);
  });
  labels_.assign(found.begin(), found.end());
  auto to = values_.begin();
  if (!read || labels_.empty()) return false;
  range_ = {0, static_cast<float>(labels_.size() - 1)};
  return visit([&](double number) {
    const auto at = std::ranges::lower_bound(labels_, number);
    *to++ = number == number ? static_cast<float>(at - labels_.begin()) : qnv::kMissing;
  });
}

double VolumeGrid::label_of(float value) const {
  if (labels_.empty() || !(value >= 0)) return static_cast<double>(value);
  return labels_[std::min(static_cast<std::size_t>(value), labels_.size() - 1)];
}

glm::dvec3 VolumeGrid::voxel_at(const glm::dvec3& place) const {
  return glm::inverse(grid_axes(layout_)) * (place - glm::dvec3(layout_.origin));
}

glm::dvec3 VolumeGrid::place_of(const glm::dvec3& voxel) const {
  return glm::dvec3(layout_.origin) + grid_axes(layout_) * voxel;
}

VolumeGrid::FineSample VolumeGrid::fine_sample(const glm::dvec3& voxel) const {
  for (const qnv::ValueBrick& brick : bricks_) {
    FineSample sample{&brick};
    bool inside = true;
    for (int i = 0; inside && i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const double place = std::round(std::max(voxel[i], 0.0) / brick.steps[axis]);
      const double last = brick.core_first[axis] + (brick.core_size[axis] - 1.0);
      inside = place >= brick.core_first[axis] && place <= last;
      if (inside) sample.at[axis] = static_cast<std::uint32_t>(place);
    }
    if (inside) return sample;
  }
  return {};
}

std::optional<std::array<std::uint32_t, 3>> VolumeGrid::kept_at(const glm::dvec3& voxel) const {
  std::array<std::uint32_t, 3> at{};
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    // Voxels of the whole volume may lie beyond the last one of a coarser level.
    const double end = std::max(layout_.dimensions[axis] - 0.5, (whole_[axis] - 0.5) / fineness_[axis]);
    if (!(voxel[i] >= -0.5 && voxel[i] <= end)) return std::nullopt;
    const double place = std::round(std::max(voxel[i], 0.0) / step_);
    at[axis] = std::min(static_cast<std::uint32_t>(place), kept_[axis] - 1);
  }
  return at;
}

std::optional<std::array<std::uint8_t, 4>> VolumeGrid::color_at(const glm::dvec3& voxel) const {
  const auto at = kept_at(voxel);
  if (!at || !has_colors()) return std::nullopt;
  return kept_color((*at)[0], (*at)[1], (*at)[2]);
}

std::optional<float> VolumeGrid::nearest(const glm::dvec3& voxel) const {
  const auto at = kept_at(voxel);
  if (!at) return std::nullopt;
  const FineSample fine = fine_sample(voxel);
  const float value = fine.brick ? fine.brick->value(fine.at[0], fine.at[1], fine.at[2])
                                 : kept_value((*at)[0], (*at)[1], (*at)[2]);
  return value == value ? std::optional(value) : std::nullopt;
}

std::optional<float> VolumeGrid::error_at(const glm::dvec3& voxel) const {
  const FineSample fine = fine_sample(voxel);
  return fine.brick ? fine.brick->error_of(fine.at[0], fine.at[1], fine.at[2]) : error_;
}

qnv::VolumeSource source_of(const std::shared_ptr<const VolumeGrid>& grid, std::uint32_t stride) {
  qnv::VolumeSource source;
  source.layout = grid->layout();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    source.layout.dimensions[axis] = (grid->kept(axis) - 1) / stride + 1;
    source.layout.axes[axis] *= static_cast<float>(grid->step()) * static_cast<float>(stride);
  }
  source.layout.type = qnv::VoxelType::f32;
  source.layout.big_endian = std::endian::native == std::endian::big;
  source.layout.slope = 1;
  source.layout.intercept = 0;
  source.layout.missing.reset();  // kMissing is a NaN
  source.layout.colors = grid->has_colors();
  for (std::size_t c = 0; source.layout.colors && c < 4; ++c) {
    qnv::VolumeSource one;
    one.layout = source.layout;
    one.layout.type = qnv::VoxelType::u8;
    one.read = [grid, stride, c, size = source.layout.dimensions](std::uint32_t z, std::span<std::byte> to) {
      if (z >= size[2] || to.size() != std::size_t{size[0]} * size[1]) return false;
      for (std::uint32_t y = 0; y < size[1]; ++y)
        for (std::uint32_t x = 0; x < size[0]; ++x)
          to[std::size_t{y} * size[0] + x] =
              static_cast<std::byte>(grid->kept_color(x * stride, y * stride, z * stride)[c]);
      return true;
    };
    source.components.push_back(std::move(one));
  }
  source.read = [grid, stride, size = source.layout.dimensions](std::uint32_t z, std::span<std::byte> to) {
    if (z >= size[2] || to.size() != std::size_t{size[0]} * size[1] * sizeof(float)) return false;
    const std::span<const float> slice = grid->kept_slice(z * stride);
    if (stride == 1) {
      std::memcpy(to.data(), slice.data(), to.size());
      return true;
    }
    std::byte* next = to.data();
    for (std::size_t y = 0; y < size[1]; ++y)
      for (std::size_t x = 0; x < size[0]; ++x, next += sizeof(float))
        std::memcpy(next, &slice[(y * grid->kept(0) + x) * stride], sizeof(float));
    return true;
  };
  return source;
}

}  // namespace gs::app
