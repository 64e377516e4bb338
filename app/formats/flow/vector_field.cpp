#include "app/formats/flow/vector_field.h"

#include "qnv/sampling/volume/volume_slices.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::app {

std::variant<VectorField, std::string> VectorField::read(const qnv::VolumeSource& source, const WorldBudget& budget,
                                                         const Progress& progress, std::uint64_t most) {
  constexpr std::size_t kLeastComponents = 2, kComponents = 3;
  if (source.components.size() < kLeastComponents)
    return std::string("arrows and streamlines need vectors; its voxels have one number");
  const qnv::VolumeLayout& layout = source.layout;
  std::uint32_t stride = 1;
  VectorField field;
  const auto count = [&] {
    std::uint64_t all = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      field.size_[i] = (layout.dimensions[i] - 1) / stride + 1;
      all *= field.size_[i];
    }
    return all;
  };
  while (count() > most) ++stride;
  const std::size_t slice = qnv::slice_voxels(layout);
  field.share_.emplace(budget, Resource::volumes);
  if (!field.share_->grow(count() * sizeof(glm::vec3) + slice * (sizeof(float) + sizeof(double))))
    return budget->refusal(Resource::volumes);
  field.vectors_.assign(static_cast<std::size_t>(count()), glm::vec3(0));
  std::vector<std::byte> scratch;
  std::vector<float> values(slice);
  for (std::size_t c = 0; c < std::min(source.components.size(), kComponents); ++c) {
    auto* next = field.vectors_.data();
    for (std::uint32_t z = 0; z < layout.dimensions[2]; z += stride) {
      if (progress.cancelled || budget->stopped()) return std::string("the time limit was reached");
      if (!qnv::read_slice(source.components[c], z, scratch, values)) return std::string("a slice cannot be read");
      for (std::uint32_t y = 0; y < layout.dimensions[1]; y += stride)
        for (std::uint32_t x = 0; x < layout.dimensions[0]; x += stride)
          (*next++)[static_cast<int>(c)] = values[std::size_t{y} * layout.dimensions[0] + x];
    }
  }
  field.origin_ = layout.base + layout.origin;
  for (int i = 0; i < 3; ++i)
    field.axes_[i] = glm::dvec3(layout.axes[static_cast<std::size_t>(i)]) * static_cast<double>(stride);
  field.inverse_ = glm::inverse(field.axes_);
  return field;
}

std::optional<glm::dvec3> VectorField::interpolated(const glm::dvec3& place) const {
  std::array<std::uint32_t, 3> below{}, above{};
  glm::dvec3 weight(0);
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    const double last = static_cast<double>(size_[axis] - 1);
    constexpr double kOutside = 0.5;  // a thin grid has lines on its only layer
    const double margin = last == 0 ? kOutside : 1e-9;
    if (!(place[i] >= -margin && place[i] <= last + margin)) return std::nullopt;
    const double inside = std::clamp(place[i], 0.0, last);
    below[axis] = static_cast<std::uint32_t>(inside);
    above[axis] = std::min(below[axis] + 1, size_[axis] - 1);
    weight[i] = inside - static_cast<double>(below[axis]);
  }
  glm::dvec3 sum(0);
  for (unsigned corner = 0; corner < 8; ++corner) {
    double part = 1;
    std::array<std::uint32_t, 3> at{};
    for (std::size_t i = 0; i < 3; ++i) {
      const bool upper = (corner >> i & 1u) != 0;
      at[i] = upper ? above[i] : below[i];
      part *= upper ? weight[static_cast<int>(i)] : 1 - weight[static_cast<int>(i)];
    }
    if (part == 0) continue;
    sum += part * glm::dvec3(this->at(at[0], at[1], at[2]));
  }
  return std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z) ? std::optional(sum) : std::nullopt;
}

double VectorField::spacing() const {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i)
    if (size_[static_cast<std::size_t>(i)] > 1) least = std::min(least, glm::length(axes_[i]));
  return std::isfinite(least) ? least : glm::length(axes_[0]);
}

double VectorField::length_at(double part) const {
  constexpr std::size_t kSamples = 100'000;
  const std::size_t step = std::max<std::size_t>(vectors_.size() / kSamples, 1);
  std::vector<double> lengths;
  for (std::size_t i = 0; i < vectors_.size(); i += step)
    if (const double length = glm::length(glm::dvec3(vectors_[i])); std::isfinite(length)) lengths.push_back(length);
  if (lengths.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(part * static_cast<double>(lengths.size() - 1));
  std::nth_element(lengths.begin(), lengths.begin() + place, lengths.end());
  return lengths[static_cast<std::size_t>(place)];
}

}  // namespace gs::app
