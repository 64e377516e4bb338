#include "qnv/codecs/values/bricks/brick_places.h"

#include <algorithm>

namespace gs::qnv::values {

BrickLayout::BrickLayout(Extent extent, int base) : base_(base), blocks_(extent, level_count(extent)) {
  for (int level = 0; level <= base; ++level) extents_.push_back(low_extent(extent, level));
}

Extent BrickLayout::bricks(int level) const {
  Extent count{};
  for (std::size_t a = 0; a < 3; ++a) count[a] = (extent(level)[a] - 1) / kBrickEdge + 1;
  return count;
}

bool BrickLayout::contains(const BrickName& name) const {
  if (name.level < 0 || name.level >= base_) return false;
  const Extent count = bricks(name.level);
  return name.at[0] < count[0] && name.at[1] < count[1] && name.at[2] < count[2];
}

SampleBox BrickLayout::core(const BrickName& name) const {
  SampleBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.first[a] = name.at[a] * kBrickEdge;
    box.size[a] = std::min(kBrickEdge, extent(name.level)[a] - box.first[a]);
  }
  return box;
}

SampleBox BrickLayout::extended(const BrickName& name) const {
  const SampleBox own = core(name);
  SampleBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.first[a] = own.first[a] - std::min(own.first[a], kBrickMargin);
    box.size[a] = std::min(extent(name.level)[a], own.first[a] + own.size[a] + kBrickMargin) - box.first[a];
  }
  return box;
}

void BrickLayout::children(const BrickName& name, const std::function<void(const BrickName&)>& visit) const {
  for (std::uint32_t z = 0; z < 2; ++z)
    for (std::uint32_t y = 0; y < 2; ++y)
      for (std::uint32_t x = 0; x < 2; ++x) {
        const BrickName child{name.level - 1, {2 * name.at[0] + x, 2 * name.at[1] + y, 2 * name.at[2] + z}};
        if (contains(child)) visit(child);
      }
}

void BrickLayout::visit_blocks(const BrickName& name, bool around,
                               const std::function<void(std::uint64_t)>& visit) const {
  const Extent count = blocks_.blocks_of(name.level + 1);
  Extent low{}, high{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t first = name.at[a] * kBrickBlocks, more = around ? 1 : 0;
    low[a] = first - std::min(first, more);
    high[a] = std::min(first + kBrickBlocks + more, count[a]);
  }
  for (std::uint32_t z = low[2]; z < high[2]; ++z)
    for (std::uint32_t y = low[1]; y < high[1]; ++y)
      for (std::uint32_t x = low[0]; x < high[0]; ++x) visit(blocks_.number(name.level + 1, {x, y, z}));
}

void BrickLayout::visit_sources(const BrickName& name, const std::function<void(std::uint64_t)>& visit) const {
  constexpr std::uint32_t kBlockSamples = 2 * kBlockEdge;
  const SampleBox box = extended(name);
  Extent first = box.first, last{};
  for (std::size_t a = 0; a < 3; ++a) last[a] = box.first[a] + box.size[a] - 1;
  for (int level = name.level; level < base_; ++level) {
    const Extent count = blocks_.blocks_of(level + 1);
    Extent low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] -= std::min(first[a], kBrickMargin);
      last[a] = std::min(last[a] + kBrickMargin, extent(level)[a] - 1);
      low[a] = first[a] / kBlockSamples;
      high[a] = std::min(last[a] / kBlockSamples, count[a] - 1);
      if (extent(level)[a] <= 1) continue;
      first[a] /= 2;
      last[a] = std::min((last[a] + 1) / 2, extent(level + 1)[a] - 1);
    }
    for (std::uint32_t z = low[2]; z <= high[2]; ++z)
      for (std::uint32_t y = low[1]; y <= high[1]; ++y)
        for (std::uint32_t x = low[0]; x <= high[0]; ++x) visit(blocks_.number(level + 1, {x, y, z}));
  }
}

}  // namespace gs::qnv::values
