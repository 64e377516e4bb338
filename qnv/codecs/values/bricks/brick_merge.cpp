#include "qnv/codecs/values/bricks/brick_merge.h"

#include "qnv/codecs/values/decode/level_layout.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::qnv::values {

namespace {

using Names = std::unordered_set<BrickName, BrickNameHash>;

/// Lowest keys of the vectors to show, by level.
std::vector<std::uint32_t> lowest_keys(const BrickLayout& layout, std::span<const BrickName> chosen,
                                       const BrickCache& cache) {
  std::vector<std::uint32_t> lowest(static_cast<std::size_t>(layout.base()), 1);
  std::vector<std::uint64_t> counts(kLengthKeys);
  for (int level = 0; level < layout.base(); ++level) {
    std::ranges::fill(counts, 0);
    double wanted = 0;
    for (const BrickName& name : chosen) {
      const Brick* const brick = name.level == level ? cache.find(name) : nullptr;
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

/// Calls visit(list, index, key) for all vectors to show, list by list. List 0 is the base; others are bricks.
class MergedLists {
 public:
  MergedLists(const Volume& base, const BrickLayout& layout, const VolumeLayout& base_layout,
              std::span<const BrickName> chosen, const BrickCache& cache)
      : base_(base),
        layout_(layout),
        names_(chosen.begin(), chosen.end()),
        lowest_(lowest_keys(layout, chosen, cache)),
        base_extent_(base_layout.dimensions),
        voxels_(voxels_of_vectors(base, base_layout)) {
    for (const BrickName& name : chosen)
      if (const Brick* const brick = cache.find(name); brick && brick->samples) bricks_.push_back(brick);
  }

  [[nodiscard]] const std::vector<const Brick*>& bricks() const { return bricks_; }

  template <class OfBase, class OfBrick>
  void visit(const OfBase& of_base, const OfBrick& of_brick) const {
    for (std::size_t i = 0; i < voxels_.size(); ++i) {
      const std::uint32_t x = voxels_[i] % base_extent_[0], y = voxels_[i] / base_extent_[0] % base_extent_[1],
                          z = voxels_[i] / base_extent_[0] / base_extent_[1];
      if (!covered(layout_.base(), {x, y, z})) of_base(i, length_key(base_.weights[i]));
    }
    for (const Brick* const brick : bricks_) {
      const SampleBox core = layout_.core(brick->name);
      const int level = brick->name.level;
      for (const BrickVector& vector : brick->vectors) {
        const std::uint32_t key = length_key(vector.length);
        if (key < lowest_[static_cast<std::size_t>(level)]) break;
        const Extent at{core.first[0] + vector.place % core.size[0],
                        core.first[1] + vector.place / core.size[0] % core.size[1],
                        core.first[2] + vector.place / core.size[0] / core.size[1]};
        if (level == 0 || !covered(level, at)) of_brick(*brick, vector, at, key);
      }
    }
  }

 private:
  /// Reports whether a brick of the next finer level covers a sample.
  [[nodiscard]] bool covered(int level, const Extent& at) const {
    constexpr std::uint32_t kHalf = kBrickEdge / 2;
    return names_.contains({level - 1, {at[0] / kHalf, at[1] / kHalf, at[2] / kHalf}});
  }

  const Volume& base_;
  const BrickLayout& layout_;
  Names names_;
  std::vector<std::uint32_t> lowest_;
  Extent base_extent_;
  std::vector<std::uint32_t> voxels_;  // of the base's vectors
  std::vector<const Brick*> bricks_;
};

}  // namespace

Volume merge_bricks(const Volume& base, const BrickLayout& layout, std::span<const VolumeLayout> levels,
                    std::span<const BrickName> chosen, const BrickCache& cache) {
  const VolumeLayout& base_layout = levels[static_cast<std::size_t>(layout.base())];
  const MergedLists lists(base, layout, base_layout, chosen, cache);
  std::vector<std::uint64_t> starts(kLengthKeys);
  const auto count = [&](std::uint32_t key) { ++starts[key]; };
  lists.visit([&](std::size_t, std::uint32_t key) { count(key); },
              [&](const Brick&, const BrickVector&, const Extent&, std::uint32_t key) { count(key); });
  std::uint64_t size = 0;
  for (std::size_t key = kLengthKeys; key-- > 0;) size += std::exchange(starts[key], size);
  Volume merged(static_cast<GeometryBase>(base));
  merged.requests.reset();
  for (const Brick* const brick : lists.bricks())
    merged.description.spacing = std::min(merged.description.spacing,
                                          smallest_step(levels[static_cast<std::size_t>(brick->name.level)]));
  merged.positions.resize(size);
  merged.normals.resize(size);
  merged.weights.resize(size);
  merged.classes.resize(size);
  merged.cells.resize(size);
  std::vector<float> edges;
  for (const VolumeLayout& level : levels) edges.push_back(smallest_step(level));
  const double least = static_cast<double>(base.description.value_range.first),
               range = static_cast<double>(base.description.value_range.second) - least,
               scale = range > 0 ? 255 / range : 0;
  lists.visit(
      [&](std::size_t i, std::uint32_t key) {
        const std::size_t to = starts[key]++;
        merged.positions[to] = base.positions[i];
        merged.normals[to] = base.normals[i];
        merged.weights[to] = base.weights[i];
        merged.classes[to] = base.classes[i];
        merged.cells[to] = {edges.back(), 0};
      },
      [&](const Brick& brick, const BrickVector& vector, const Extent& at, std::uint32_t key) {
        const std::size_t to = starts[key]++;
        const auto level = static_cast<std::size_t>(brick.name.level);
        merged.positions[to] = voxel_position(levels[level], at[0], at[1], at[2]);
        merged.normals[to] = vector.normal;
        merged.weights[to] = vector.length;
        const double part = (static_cast<double>(vector.value) - least) * scale;
        merged.classes[to] = static_cast<std::uint8_t>(std::clamp(part, 0.0, 255.0) + 0.5);
        merged.cells[to] = {edges[level], 0};
      });
  return merged;
}

}  // namespace gs::qnv::values
