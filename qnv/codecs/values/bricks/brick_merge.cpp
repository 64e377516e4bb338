#include "qnv/codecs/values/bricks/brick_merge.h"

#include "qnv/codecs/values/decode/level_layout.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::qnv::values {

namespace {

using Names = std::unordered_set<BrickName, BrickNameHash>;

/// Lowest keys of the vectors to show, by level.
std::vector<std::uint32_t> lowest_keys(const BrickLayout& layout, std::span<const BrickName> chosen,
                                       const FindBrick& find) {
  std::vector<std::uint32_t> lowest(static_cast<std::size_t>(layout.base()), 1);
  std::vector<std::uint64_t> counts(kLengthKeys);
  for (int level = 0; level < layout.base(); ++level) {
    std::ranges::fill(counts, 0);
    double wanted = 0;
    for (const BrickName& name : chosen) {
      const Brick* const brick = name.level == level ? find(name) : nullptr;
      if (!brick) continue;
      wanted += brick->wanted;
      for (const BrickVector& vector : brick->vectors) ++counts[length_key(vector.length)];
    }
    std::uint64_t above = 0;
    std::uint32_t key = kLengthKeys;
    while (key > 1 && static_cast<double>(above) < wanted) above += counts[--key];
    lowest[static_cast<std::size_t>(level)] = key;
  }
  return lowest;
}

/// All vectors to show, list by list: those of the whole volume, and those of each brick.
class MergedLists {
 public:
  MergedLists(const Volume& base, const BrickLayout& layout, const VolumeLayout& base_layout,
              std::span<const BrickName> chosen, const FindBrick& find)
      : base_(base),
        layout_(layout),
        names_(chosen.begin(), chosen.end()),
        lowest_(lowest_keys(layout, chosen, find)),
        base_extent_(base_layout.dimensions),
        voxels_(voxels_of_vectors(base, base_layout)) {
    for (const BrickName& name : chosen)
      if (const Brick* const brick = find(name); brick && brick->samples) bricks_.push_back(brick);
    find_factors();
  }

  [[nodiscard]] const std::vector<const Brick*>& bricks() const { return bricks_; }
  template <class OfBase, class OfBrick>
  void visit(const OfBase& of_base, const OfBrick& of_brick) const {
    for (std::size_t i = 0; i < voxels_.size(); ++i) {
      const std::uint32_t x = voxels_[i] % base_extent_[0], y = voxels_[i] / base_extent_[0] % base_extent_[1],
                          z = voxels_[i] / base_extent_[0] / base_extent_[1];
      if (!covered(layout_.base(), {x, y, z})) of_base(i, scaled(base_.weights[i], layout_.base()));
    }
    for (const Brick* const brick : bricks_) {
      const SampleBox core = layout_.core(brick->name);
      const int level = brick->name.level;
      for (const BrickVector& vector : brick->vectors) {
        if (length_key(vector.length) < lowest_[static_cast<std::size_t>(level)]) break;
        const Extent at{core.first[0] + vector.place % core.size[0],
                        core.first[1] + vector.place / core.size[0] % core.size[1],
                        core.first[2] + vector.place / core.size[0] / core.size[1]};
        if (level == 0 || !covered(level, at)) of_brick(*brick, vector, at, scaled(vector.length, level));
      }
    }
  }

 private:
  // Sets factors for the lengths of all levels, after which their shortest vectors are as long as those of the finest
  // one. Renderers compare lengths with their median, and coarse voxels have weaker gradients.
  void find_factors() {
    const auto length_of = [](std::uint32_t key) { return std::bit_cast<float>(key << 16); };
    std::vector<float> shortest;
    for (const std::uint32_t key : lowest_) shortest.push_back(length_of(key));
    shortest.push_back(base_.weights.empty() ? 0 : length_of(length_key(base_.weights.back())));
    std::size_t finest = lowest_.size();
    for (const Brick* const brick : bricks_) finest = std::min(finest, static_cast<std::size_t>(brick->name.level));
    for (const float length : shortest) {
      const float factor = shortest[finest] / length;
      factors_.push_back(factor > 0 && std::isfinite(factor) ? std::clamp(factor, 1.0f / 64, 64.0f) : 1.0f);
    }
  }
  [[nodiscard]] float scaled(float length, int level) const {
    return std::clamp(length * factors_[static_cast<std::size_t>(level)], std::numeric_limits<float>::min(),
                      std::numeric_limits<float>::max());
  }
  /// Reports whether a brick of the next finer level covers a sample.
  [[nodiscard]] bool covered(int level, const Extent& at) const {
    constexpr std::uint32_t kHalf = kBrickEdge / 2;
    return names_.contains({level - 1, {at[0] / kHalf, at[1] / kHalf, at[2] / kHalf}});
  }

  const Volume& base_;
  const BrickLayout& layout_;
  Names names_;
  std::vector<std::uint32_t> lowest_;  // keys, by level
  std::vector<float> factors_;         // by level
  Extent base_extent_;
  std::vector<std::uint32_t> voxels_;  // of the base's vectors
  std::vector<const Brick*> bricks_;
};

}  // namespace

Volume merge_bricks(const Volume& base, const BrickLayout& layout, std::span<const VolumeLayout> levels,
                    std::span<const BrickName> chosen, const FindBrick& find) {
  const VolumeLayout& base_layout = levels[static_cast<std::size_t>(layout.base())];
  const MergedLists lists(base, layout, base_layout, chosen, find);
  std::vector<std::uint64_t> starts(kLengthKeys);
  const auto count = [&](float length) { ++starts[length_key(length)]; };
  lists.visit([&](std::size_t, float length) { count(length); },
              [&](const Brick&, const BrickVector&, const Extent&, float length) { count(length); });
  std::uint64_t size = 0;
  for (std::size_t key = kLengthKeys; key-- > 0;) size += std::exchange(starts[key], size);
  Volume merged(static_cast<GeometryBase>(base));
  merged.requests.reset();
  for (const Brick* const brick : lists.bricks())
    merged.description.spacing =
        std::min(merged.description.spacing, smallest_step(levels[static_cast<std::size_t>(brick->name.level)]));
  merged.positions.resize(size);
  merged.normals.resize(size);
  merged.weights.resize(size);
  merged.classes.resize(size);
  merged.cells.resize(size);
  std::vector<float> edges;
  for (const VolumeLayout& level : levels) edges.push_back(largest_step(level));
  const double least = static_cast<double>(base.description.value_range.first),
               range = static_cast<double>(base.description.value_range.second) - least,
               scale = range > 0 ? 255 / range : 0;
  lists.visit(
      [&](std::size_t i, float length) {
        const std::size_t to = starts[length_key(length)]++;
        merged.positions[to] = base.positions[i];
        merged.normals[to] = base.normals[i];
        merged.weights[to] = length;
        merged.classes[to] = base.classes[i];
        merged.cells[to] = {edges.back(), 0};
      },
      [&](const Brick& brick, const BrickVector& vector, const Extent& at, float length) {
        const std::size_t to = starts[length_key(length)]++;
        const auto level = static_cast<std::size_t>(brick.name.level);
        merged.positions[to] = voxel_position(levels[level], at[0], at[1], at[2]);
        merged.normals[to] = vector.normal;
        merged.weights[to] = length;
        const double part = (static_cast<double>(vector.value) - least) * scale;
        merged.classes[to] = static_cast<std::uint8_t>(std::clamp(part, 0.0, 255.0) + 0.5);
        merged.cells[to] = {edges[level], 0};
      });
  return merged;
}

}  // namespace gs::qnv::values
