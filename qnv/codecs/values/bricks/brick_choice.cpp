#include "qnv/codecs/values/bricks/brick_choice.h"

#include "qnv/base/geometry.h"
#include "qnv/codecs/values/decode/level_layout.h"
#include "qnv/sampling/volume/gradients.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

namespace gs::qnv::values {

namespace {

// Bytes of a vector: in its brick, among all that are drawn, and in two copies of a renderer.
constexpr double kVectorBytes = 28 + 41 + 32;
// Bytes of the coefficients per sample, as measured on noisy volumes of 16 bits.
constexpr double kCoefficientBytes = 2;
// Factor of the wish for bricks in which the transfer function shows nothing.
constexpr double kHiddenFactor = 1.0 / 64;
// Priority factor of bricks that a slice shows. They count as three levels coarser.
constexpr double kSliceFactor = 8;

// Priority factor of bricks that have a point of the view. They count as nine levels coarser.
constexpr double kPointFactor = 512;

struct Wish {
  double size = 0;  // of a voxel of the next coarser level, in pixels
  BrickName name;
  bool operator<(const Wish& other) const {
    // Among equals, the first name is the most wanted.
    return size != other.size ? size < other.size : other.name < name;
  }
};

// Returns the least and the largest distance of the corners of a box from a plane, times the length of its normal.
std::pair<float, float> distances(const Box& box, const glm::vec4& plane) {
  const glm::vec3 normal(plane), a = normal * box.lower, b = normal * box.upper;
  const glm::vec3 least = glm::min(a, b), most = glm::max(a, b);
  return {least.x + least.y + least.z + plane.w, most.x + most.y + most.z + plane.w};
}

// Reports whether a plane hides a whole box.
bool below(const Box& box, const glm::vec4& plane) { return plane != glm::vec4(0) && distances(box, plane).second < 0; }

// Reports whether a view wants the values at a point of a box.
bool has_point(const Box& box, const VolumeNeeds& needs) {
  return std::ranges::any_of(needs.points, [&](const std::optional<glm::vec3>& point) {
    return point && glm::all(glm::lessThanEqual(box.lower, *point)) && glm::all(glm::lessThanEqual(*point, box.upper));
  });
}

bool shows(std::span<const TransferPoint> transfer, float value) {
  const auto next = std::ranges::find_if(transfer, [&](const TransferPoint& p) { return p.value >= value; });
  if (next == transfer.end()) return transfer.empty() || transfer.back().opacity > 0;
  return next->opacity > 0 || (next != transfer.begin() && std::prev(next)->opacity > 0);
}

}  // namespace

std::vector<std::uint32_t> voxels_of_vectors(const Volume& vectors, const VolumeLayout& layout) {
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(layout.axes[0], layout.axes[1], layout.axes[2]));
  std::vector<std::uint32_t> voxels;
  voxels.reserve(vectors.size());
  for (const glm::vec3& position : vectors.positions) {
    const glm::dvec3 at = inverse * (glm::dvec3(position) - layout.origin);
    std::uint64_t voxel = 0;
    for (int a = 3; a-- > 0;) {
      const std::uint32_t n = layout.dimensions[static_cast<std::size_t>(a)];
      // Numbers that are not finite become indices, too.
      const double place = std::round(at[a]);
      voxel = voxel * n + (place > 0 ? static_cast<std::uint32_t>(std::min(place, n - 1.0)) : 0u);
    }
    voxels.push_back(static_cast<std::uint32_t>(voxel));
  }
  return voxels;
}

VectorShares::VectorShares(const Volume& vectors, const VolumeLayout& layout, int level)
    : level_(level), extent_(layout.dimensions) {
  for (std::size_t a = 0; a < 3; ++a) cells_[a] = (extent_[a] - 1) / kCell + 1;
  counts_.resize(sample_count(cells_));
  classes_.resize(counts_.size());
  for (std::size_t i = 0; i < hidden_.size(); ++i)
    hidden_[i] = !shows(vectors.description.transfer, static_cast<float>(i) / 255);
  const std::vector<std::uint32_t> voxels = voxels_of_vectors(vectors, layout);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const std::uint32_t x = voxels[i] % extent_[0], y = voxels[i] / extent_[0] % extent_[1],
                        z = voxels[i] / extent_[0] / extent_[1];
    const std::size_t cell = (std::size_t{z / kCell} * cells_[1] + y / kCell) * cells_[0] + x / kCell;
    ++counts_[cell];
    classes_[cell].set(vectors.classes.empty() ? 255u : vectors.classes[i]);
  }
}

VectorShares::Range VectorShares::cells_of(const BrickName& name) const {
  // Sample i of a level lies at sample i / 2^n of the level that is n coarser.
  const int shift = level_ - name.level;
  Range range;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint64_t first = (std::uint64_t{name.at[a]} * kBrickEdge) >> shift,
                        last = ((std::uint64_t{name.at[a]} + 1) * kBrickEdge - 1) >> shift;
    range.first[a] = static_cast<std::uint32_t>(std::min<std::uint64_t>(first / kCell, cells_[a] - 1));
    range.last[a] = static_cast<std::uint32_t>(std::min<std::uint64_t>(last / kCell, cells_[a] - 1));
  }
  return range;
}

double VectorShares::of(const BrickName& name) const {
  if (counts_.empty()) return 0;
  const Range range = cells_of(name);
  std::uint64_t vectors = 0, voxels = 0;
  for (std::uint32_t z = range.first[2]; z <= range.last[2]; ++z)
    for (std::uint32_t y = range.first[1]; y <= range.last[1]; ++y)
      for (std::uint32_t x = range.first[0]; x <= range.last[0]; ++x) {
        vectors += counts_[(std::size_t{z} * cells_[1] + y) * cells_[0] + x];
        std::uint64_t size = 1;
        const Extent cell{x, y, z};
        for (std::size_t a = 0; a < 3; ++a) size *= std::min(kCell, extent_[a] - cell[a] * kCell);
        voxels += size;
      }
  return static_cast<double>(vectors) / static_cast<double>(voxels);
}

bool VectorShares::visible(const BrickName& name, const std::optional<std::bitset<256>>& hidden) const {
  if (counts_.empty()) return false;
  const std::bitset<256> shown = ~(hidden ? *hidden : hidden_);
  const Range range = cells_of(name);
  for (std::uint32_t z = range.first[2]; z <= range.last[2]; ++z)
    for (std::uint32_t y = range.first[1]; y <= range.last[1]; ++y)
      for (std::uint32_t x = range.first[0]; x <= range.last[0]; ++x)
        if ((classes_[(std::size_t{z} * cells_[1] + y) * cells_[0] + x] & shown).any()) return true;
  return false;
}

bool touches_slice(const Box& box, float margin, const VolumeNeeds& needs) {
  return std::ranges::any_of(needs.slices, [&](const glm::vec4& plane) {
    const auto [least, most] = distances(box, plane);
    const float near = margin * glm::length(glm::vec3(plane));
    return plane != glm::vec4(0) && least <= near && most >= -near;
  });
}

Box samples_box(const SampleBox& samples, const VolumeLayout& level) {
  Box box;
  for (unsigned c = 0; c < 8; ++c) {
    glm::dvec3 at;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      // The box ends in the middle between its last voxel and the next one.
      at[a] = (c >> i & 1) != 0 ? samples.first[i] + samples.size[i] - 0.5 : samples.first[i] - 0.5;
    }
    box.add(voxel_position(level, at.x, at.y, at.z));
  }
  return box;
}

Box brick_box(const BrickLayout& layout, const BrickName& name, const VolumeLayout& level) {
  return samples_box(layout.core(name), level);
}

std::size_t brick_bytes(const BrickLayout& layout, const BrickName& name, double share) {
  const auto samples = static_cast<double>(sample_count(layout.extended(name).size)),
             own = static_cast<double>(sample_count(layout.core(name).size));
  return static_cast<std::size_t>(samples * sizeof(std::int32_t) + own * (kCoefficientBytes + share * kVectorBytes)) +
         1024;
}

std::vector<BrickName> choose_bricks(const BrickChoice& choice) {
  const BrickLayout& layout = choice.layout;
  std::priority_queue<Wish> wishes;
  const auto consider = [&](const BrickName& name) {
    const Box box = brick_box(layout, name, choice.levels[static_cast<std::size_t>(name.level)]);
    const float coarse = smallest_step(choice.levels[static_cast<std::size_t>(name.level) + 1]);
    const bool has_vectors = choice.shares.of(name) > 0;
    double size = 0;
    for (const LodView& view : choice.views) {
      const VolumeNeeds& needs = view.volume;
      const bool vectors = has_vectors && !needs.only_slices && !below(box, needs.clip),
                 slice = touches_slice(box, coarse, needs);
      const bool point = has_point(box, needs);
      if (!point && ((!vectors && !slice) || outside(box, view))) continue;
      const float distance = glm::length(view.eye - glm::clamp(view.eye, box.lower, box.upper));
      const double pixels = static_cast<double>(coarse) * view.pixels / std::max(distance, coarse);
      if (!point && !(pixels > view.error_pixels)) continue;
      const bool visible = vectors && choice.shares.visible(name, needs.hidden_classes);
      size = std::max(size, pixels * (point ? kPointFactor : slice ? kSliceFactor : visible ? 1 : kHiddenFactor));
    }
    if (size > 0) wishes.push({size, name});
  };
  if (layout.base() > 0) {
    const Extent count = layout.bricks(layout.base() - 1);
    for (std::uint32_t z = 0; z < count[2]; ++z)
      for (std::uint32_t y = 0; y < count[1]; ++y)
        for (std::uint32_t x = 0; x < count[0]; ++x) consider({layout.base() - 1, {x, y, z}});
  }
  std::vector<BrickName> chosen;
  std::size_t bytes = 0;
  while (!wishes.empty()) {
    const BrickName name = wishes.top().name;
    wishes.pop();
    bytes += brick_bytes(layout, name, choice.shares.of(name));
    if (bytes > choice.most_bytes) break;
    chosen.push_back(name);
    if (name.level > 0) layout.children(name, consider);
  }
  return chosen;
}

}  // namespace gs::qnv::values
