#include "qnv/codecs/values/bricks/brick_vectors.h"

#include "qnv/sampling/volume/gradient_row.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <span>
#include <utility>

namespace gs::qnv::values {

namespace {

/// Rows of the values of a brick, with their neighbours.
class BrickRows {
 public:
  BrickRows(const BrickSamples& samples, const SampleBox& core, const VolumeLayout& layout)
      : box_(samples.box), core_(core), all_(layout.dimensions), values_(samples.samples.size()) {
    values_of(layout, std::as_bytes(std::span(samples.samples)), values_);
    // Lengths at the ends of a row need the neighbours there.
    first_ = core.first[0] - (core.first[0] > 0 ? 1u : 0u);
    const std::uint32_t last = core.first[0] + core.size[0];
    count_ = last + (last < all_[0] ? 1u : 0u) - first_;
  }
  [[nodiscard]] GradientRow row(std::uint32_t y, std::uint32_t z) const {
    const std::size_t nx = box_.size[0], slice = nx * box_.size[1];
    const float* const here =
        values_.data() + (z - box_.first[2]) * slice + (y - box_.first[1]) * nx + (first_ - box_.first[0]);
    GradientRow row;
    row.here = here;
    row.before = {y > 0 ? here - nx : here, z > 0 ? here - slice : here};
    row.after = {y + 1 < all_[1] ? here + nx : here, z + 1 < all_[2] ? here + slice : here};
    row.factor = {y > 0 && y + 1 < all_[1] ? 0.5 : 1.0, z > 0 && z + 1 < all_[2] ? 0.5 : 1.0};
    row.count = count_;
    return row;
  }
  /// Index in row() of the first sample of the core.
  [[nodiscard]] std::uint32_t shift() const { return core_.first[0] - first_; }
  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  SampleBox box_, core_;
  Extent all_;
  std::vector<float> values_;
  std::uint32_t first_ = 0, count_ = 0;
};

}  // namespace

std::vector<BrickVector> longest_vectors(const BrickSamples& samples, const SampleBox& core, const VolumeLayout& layout,
                                         std::size_t most) {
  const glm::dmat3 to_world = glm::transpose(glm::inverse(glm::dmat3(layout.axes[0], layout.axes[1], layout.axes[2])));
  const BrickRows rows(samples, core, layout);
  const std::size_t nx = core.size[0], ny = core.size[1];
  std::vector<float> lengths(sample_count(core.size)), line(rows.count());
  std::vector<std::uint32_t> counts(kLengthKeys);
  for (std::uint32_t z = 0; z < core.size[2]; ++z)
    for (std::uint32_t y = 0; y < core.size[1]; ++y) {
      magnitudes(rows.row(core.first[1] + y, core.first[2] + z), to_world, may_miss(layout), line.data());
      float* const to = lengths.data() + (z * ny + y) * nx;
      for (std::size_t x = 0; x < nx; ++x) {
        to[x] = line[x + rows.shift()];
        ++counts[length_key(to[x])];
      }
    }
  // Vectors of key 0 count as zero.
  std::size_t total = 0;
  std::uint32_t lowest = kLengthKeys;
  while (lowest > 1 && total < most) total += counts[--lowest];
  std::vector<BrickVector> vectors(total);
  std::size_t start = 0;
  for (std::uint32_t key = kLengthKeys; key-- > lowest;)
    start += std::exchange(counts[key], static_cast<std::uint32_t>(start));
  for (std::uint32_t z = 0; z < core.size[2]; ++z)
    for (std::uint32_t y = 0; y < core.size[1]; ++y) {
      const GradientRow row = rows.row(core.first[1] + y, core.first[2] + z);
      for (std::uint32_t x = 0; x < core.size[0]; ++x) {
        const std::size_t place = (z * ny + y) * nx + x;
        const std::uint32_t key = length_key(lengths[place]);
        if (key < lowest) continue;
        const std::uint32_t at = x + rows.shift();
        vectors[counts[key]++] = {static_cast<std::uint32_t>(place), lengths[place], row.here[at],
                                  glm::vec3(glm::normalize(gradient_at(row, at, to_world)))};
      }
    }
  return vectors;
}

}  // namespace gs::qnv::values
