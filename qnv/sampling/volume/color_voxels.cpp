#include "qnv/sampling/volume/color_voxels.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace gs::qnv {
namespace {

std::uint8_t byte_of(double number) {
  return number > 0 ? static_cast<std::uint8_t>(std::min(std::floor(number + 0.5), 255.0)) : std::uint8_t{0};
}

/// Colours from the components of a stream, which have a level and may be brightness and differences.
class DecodedColors final : public ColorSlices {
 public:
  DecodedColors(std::vector<VolumeSource> components, bool luma, bool whole)
      : ColorSlices(std::move(components)), luma_(luma), whole_(whole) {}

 private:
  bool load(std::uint32_t z, std::span<std::vector<std::uint8_t>> planes) override {
    const std::size_t slice = slice_voxels(components_.front().layout);
    numbers_.resize(components_.size());
    for (std::size_t c = 0; c < components_.size(); ++c) {
      const VolumeSource& one = components_[c];
      stored_.resize(slice * size_of(one.layout.type));
      numbers_[c].resize(slice);
      if (!one.read(z, stored_)) return false;
      stored_numbers(one.layout, stored_, numbers_[c]);
      // Hostile streams may have any numbers.
      constexpr double kMost = 1 << 20;
      for (double& number : numbers_[c]) {
        number = number * one.layout.slope + one.layout.intercept;
        number = number == number ? std::clamp(number, -kMost, kMost) : 0.0;
      }
    }
    for (std::size_t i = 0; i < slice; ++i) {
      std::array<double, 3> color{numbers_[0][i], numbers_[1][i], numbers_[2][i]};
      if (luma_ && whole_) {
        const auto exact = [&](std::size_t c) { return static_cast<std::int32_t>(std::floor(color[c] + 0.5)); };
        const auto rgb = rgb_of({exact(0), exact(1), exact(2)});
        std::ranges::transform(rgb, color.begin(), [](std::int32_t number) { return static_cast<double>(number); });
      } else if (luma_) {
        const double half = color[0] - color[2] / 2, blue = half - color[1] / 2;
        color = {blue + color[1], color[2] + half, blue};
      }
      for (std::size_t c = 0; c < 3; ++c) planes[c][i] = byte_of(color[c]);
      if (planes.size() > 3) planes[3][i] = byte_of(numbers_[3][i]);
    }
    return true;
  }

  const bool luma_, whole_;
  std::vector<std::byte> stored_;
  std::vector<std::vector<double>> numbers_;
};

// Returns the sum of errors if all are known. An error of a difference counts half, rounded up to a whole number.
std::optional<float> sum_of_errors(std::span<const std::shared_ptr<const VolumeValues>> all, bool luma,
                                   std::optional<float> VolumeValues::*error, bool whole) {
  float most = 0;
  for (std::size_t c = 0; c < all.size(); ++c) {
    const std::optional<float>& own = (*all[c]).*error;
    if (!own) return std::nullopt;
    const float half = whole ? std::ceil(*own / 2) : *own / 2;
    if (luma && c < 3)
      most = c == 0 ? *own : most + half;
    else
      most = std::max(most, *own);
  }
  return most;
}

}  // namespace

std::vector<TransferPoint> color_transfer() {
  return {{0, {0, 0, 0}, 0}, {0.1f, {40, 40, 40}, 0.5f}, {1, {255, 255, 255}, 0.9f}};
}

bool has_colors(const VolumeSource& source) {
  return source.layout.colors && (source.components.size() == 3 || source.components.size() == 4) &&
         std::ranges::all_of(source.components, [&](const VolumeSource& one) {
           return one.layout.type == VoxelType::u8 && one.layout.slope == 1 && one.layout.intercept == 0 &&
                  !one.layout.missing && one.layout.dimensions == source.layout.dimensions;
         });
}

ColorSlices::ColorSlices(std::vector<VolumeSource> components) : components_(std::move(components)) {}

bool ColorSlices::load(std::uint32_t z, std::span<std::vector<std::uint8_t>> planes) {
  for (std::size_t c = 0; c < planes.size(); ++c)
    if (!components_[c].read(z, std::as_writable_bytes(std::span(planes[c])))) return false;
  return true;
}

bool ColorSlices::keep(std::uint32_t z) {
  if (kept_ && z_ == z) return true;
  const VolumeLayout& layout = components_.front().layout;
  if (z >= layout.dimensions[2]) return false;
  planes_.resize(components_.size());
  for (auto& plane : planes_) plane.resize(slice_voxels(layout));
  z_ = z;
  return kept_ = load(z, planes_);
}

bool ColorSlices::read(std::size_t c, std::uint32_t z, std::span<std::byte> to) {
  const std::lock_guard lock(mutex_);
  if (!keep(z) || c >= planes_.size() || to.size() != planes_[c].size()) return false;
  std::memcpy(to.data(), planes_[c].data(), to.size());
  return true;
}

bool ColorSlices::read_luma(std::uint32_t z, std::span<std::byte> to) {
  const std::lock_guard lock(mutex_);
  if (!keep(z) || to.size() != planes_.front().size()) return false;
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] = static_cast<std::byte>(luma_of(planes_[0][i], planes_[1][i], planes_[2][i]).y);
  return true;
}

VolumeSource color_source(VolumeLayout layout, const std::shared_ptr<ColorSlices>& slices, std::size_t components) {
  layout.type = VoxelType::u8;
  layout.slope = 1;
  layout.intercept = 0;
  layout.missing.reset();
  layout.labels = false;
  VolumeSource source;
  layout.colors = false;
  for (std::size_t c = 0; c < components; ++c)
    source.components.push_back(
        {layout, [slices, c](std::uint32_t z, std::span<std::byte> to) { return slices->read(c, z, to); }});
  layout.colors = true;
  source.layout = std::move(layout);
  source.read = [slices](std::uint32_t z, std::span<std::byte> to) { return slices->read_luma(z, to); };
  return source;
}

VolumeSource color_source(std::vector<VolumeSource> components) {
  VolumeLayout layout = components.front().layout;
  const std::size_t count = components.size();
  return color_source(std::move(layout), std::make_shared<ColorSlices>(std::move(components)), count);
}

std::shared_ptr<const VolumeValues> color_values(std::span<const std::shared_ptr<const VolumeValues>> components,
                                                 bool luma) {
  const VolumeValues& first = *components.front();
  const bool whole = first.level == 0;
  std::vector<VolumeSource> sources;
  for (const auto& one : components) sources.push_back(one->source);
  auto made = std::make_shared<VolumeValues>(first);
  made->stored = VoxelType::u8;
  made->slope = 1;
  made->intercept = 0;
  made->missing.reset();
  made->range = kColorRange;
  made->error = sum_of_errors(components, luma, &VolumeValues::error, whole);
  made->rms = sum_of_errors(components, luma, &VolumeValues::rms, false);
  made->exact = std::ranges::all_of(components, [](const auto& one) { return one->exact; });
  for (std::size_t c = 1; c < components.size(); ++c) made->bytes += components[c]->bytes;
  const auto slices = std::make_shared<DecodedColors>(std::move(sources), luma, whole);
  made->source = color_source(first.source.layout, slices, components.size());
  made->components.clear();
  const auto base = *made;
  for (const VolumeSource& one : base.source.components) {
    auto component = std::make_shared<VolumeValues>(base);
    component->source = one;
    made->components.push_back(std::move(component));
  }
  return made;
}

namespace {

// Number of voxels along the normal, with its own, from which a vector takes the brightest colour. The colour of the
// voxel with the steepest change is mixed with dark surroundings.
constexpr std::uint32_t kColorSteps = 3, kCoarseSteps = 2;

/// Voxel with a colour that a vector may have.
struct ColorPlace {
  std::uint32_t vector = 0;
  std::size_t at = 0;  // in the slice
};

// Returns the places of all vectors, by slice. `begin` gets the first one of each slice.
std::vector<ColorPlace> color_places(const VolumeLayout& layout, const Volume& volume, std::uint32_t steps,
                                     std::vector<std::size_t>& begin) {
  const auto [nx, ny, nz] = layout.dimensions;
  const std::array<glm::dvec3, 3> axes{glm::dvec3(layout.axes[0]), glm::dvec3(layout.axes[1]),
                                       glm::dvec3(layout.axes[2])};
  const glm::dmat3 voxel_of = glm::inverse(glm::dmat3(axes[0], axes[1], axes[2]));
  const double step = std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  const bool directed = volume.normals.size() == volume.size();
  const auto each = [&, nx = nx, ny = ny, nz = nz](const auto& visit) {
    for (std::size_t i = 0; i < volume.size(); ++i)
      for (std::uint32_t k = 0; k < (directed ? steps : 1); ++k) {
        const glm::dvec3 along = directed ? glm::dvec3(volume.normals[i]) * (step * k) : glm::dvec3(0);
        const glm::dvec3 at = glm::floor(voxel_of * (glm::dvec3(volume.positions[i]) + along - layout.origin) + 0.5);
        if (at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < nx && at.y < ny && at.z < nz)
          visit(static_cast<std::uint32_t>(at.z),
                ColorPlace{static_cast<std::uint32_t>(i),
                           static_cast<std::size_t>(at.y) * nx + static_cast<std::size_t>(at.x)});
      }
  };
  begin.assign(std::size_t{nz} + 1, 0);
  each([&](std::uint32_t z, const ColorPlace&) { ++begin[z + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<ColorPlace> places(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  each([&](std::uint32_t z, const ColorPlace& place) { places[next[z]++] = place; });
  return places;
}

}  // namespace

void color_vectors(const VolumeSource& source, Volume& volume, bool coarse) {
  volume.colors.assign(volume.size(), {255, 255, 255});
  std::vector<std::size_t> begin;
  const std::vector<ColorPlace> places =
      color_places(source.layout, volume, coarse ? kCoarseSteps : kColorSteps, begin);
  std::vector<std::int32_t> brightness(volume.size(), -1);
  std::vector<std::uint8_t> opacity(volume.size(), 255);
  std::array<std::vector<std::byte>, 4> planes;
  for (auto& plane : planes) plane.resize(slice_voxels(source.layout), std::byte{255});
  for (std::uint32_t z = 0; z + std::size_t{1} < begin.size(); ++z) {
    if (begin[z] == begin[z + 1]) continue;
    bool good = true;
    for (std::size_t c = 0; c < source.components.size(); ++c) good = good && source.components[c].read(z, planes[c]);
    if (!good) continue;
    for (const ColorPlace& place : std::span(places).subspan(begin[z], begin[z + 1] - begin[z])) {
      const auto number = [&](std::size_t c) { return std::to_integer<std::uint8_t>(planes[c][place.at]); };
      const std::int32_t luma = luma_of(number(0), number(1), number(2)).y;
      if (luma <= brightness[place.vector]) continue;
      brightness[place.vector] = luma;
      volume.colors[place.vector] = {number(0), number(1), number(2)};
      opacity[place.vector] = number(3);
    }
  }
  // Weights stay above 0.
  for (std::size_t i = 0; i < volume.size(); ++i)
    if (opacity[i] < 255)
      volume.weights[i] = std::max(volume.weights[i] * static_cast<float>(std::max<std::uint8_t>(opacity[i], 1)) / 255,
                                   std::numeric_limits<float>::min());
}

}  // namespace gs::qnv
