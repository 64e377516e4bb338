#include "qnv/codecs/values/bricks/brick_cache.h"

#include "base/parallel.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace gs::qnv::values {

namespace {

// Number of vectors that a brick keeps, relative to its own share. Others have fewer, so that all together have theirs.
constexpr double kKeptVectors = 1.5;
// Part of the memory that blocks may need. They are decoded again if a neighbour of their bricks changes.
constexpr double kBlockPart = 0.25;

std::uint64_t mixed(std::uint64_t key, std::uint64_t with) {
  key = (key ^ with) * 0x9e3779b97f4a7c15u;
  return key ^ key >> 32;
}

}  // namespace

const Brick* BrickCache::find(const BrickName& name) const {
  const auto found = bricks_.find(name);
  return found != bricks_.end() ? &found->second.brick : nullptr;
}

std::uint64_t BrickCache::key_of(const BrickName& name, const BrickBase& base, const ClusterChunks& chunks,
                                 const GapRuns& gaps, std::vector<std::uint64_t>& blocks) const {
  const auto parent = bricks_.find(name.parent());
  std::uint64_t key = parent != bricks_.end() ? parent->second.key : mixed(1, base.version);
  if (name.level == 0) key = mixed(key, gaps.count());
  blocks.clear();
  layout_.visit_blocks(name, true, [&](std::uint64_t block) {
    if (!used_blocks_.contains(block)) return;
    const std::uint32_t received = BlockCache::received(block, chunks);
    if (received == 0) return;
    key = mixed(mixed(key, block), received);
    blocks.push_back(block);
  });
  return key;
}

void BrickCache::compute(const Work& work, const BrickBase& base, const GapRuns& gaps) const {
  Brick& brick = work.state->brick;
  const int level = brick.name.level;
  std::vector<const Block*> blocks;
  for (const std::uint64_t number : work.blocks)
    if (const Block* const block = blocks_.find(number)) blocks.push_back(block);
  BrickSamples made = lift_brick(level, layout_.extended(brick.name), layout_.extent(level), *work.coarser, blocks);
  VolumeLayout layout = levels_[static_cast<std::size_t>(level)];
  if (level == 0) base.limits.apply(made.samples);
  if (level == 0 && gaps.mark(made.box, kMissingInBrick, made.samples)) layout.missing = kMissingInBrick;
  const SampleBox core = layout_.core(brick.name);
  brick.wanted = base.shares.of(brick.name) * static_cast<double>(sample_count(core.size));
  brick.vectors = longest_vectors(made, core, layout, static_cast<std::size_t>(std::ceil(kKeptVectors * brick.wanted)));
  brick.samples = std::make_shared<const BrickSamples>(std::move(made));
}

bool BrickCache::update(std::span<const BrickName> chosen, const BrickBase& base, const ClusterChunks& chunks,
                        const GapRuns& gaps, std::size_t most_bytes, const std::atomic<bool>& stop) {
  ++time_;
  computed_ = 0;
  used_blocks_.clear();
  for (const BrickName& name : chosen)
    layout_.visit_blocks(name, false, [&](std::uint64_t block) { used_blocks_.insert(block); });
  for (int level = layout_.base() - 1; level >= 0; --level) {
    std::vector<Work> works;
    std::vector<std::uint64_t> blocks, needed;
    for (const BrickName& name : chosen) {
      if (name.level != level) continue;
      const std::uint64_t key = key_of(name, base, chunks, gaps, blocks);
      State& state = bricks_[name];
      state.used = time_;
      if (state.brick.samples && state.key == key) continue;
      state.key = key;
      if (state.brick.samples) bytes_ -= state.brick.bytes();
      state.brick.name = name;
      state.brick.samples.reset();
      const Brick* const parent = level + 1 < layout_.base() ? find(name.parent()) : nullptr;
      works.push_back({&state, parent ? parent->samples.get() : &base.samples, blocks});
      needed.insert(needed.end(), blocks.begin(), blocks.end());
    }
    blocks_.decode(needed, chunks);
    // Bricks are computed side by side, and each needs only the coarser one.
    (void)parallel_for(works.size(), [&](std::size_t i) {
      if (!stop) compute(works[i], base, gaps);
    });
    for (const Work& work : works)
      if (work.state->brick.samples) bytes_ += work.state->brick.bytes();
    computed_ += works.size();
    blocks_.trim(static_cast<std::size_t>(kBlockPart * static_cast<double>(most_bytes)));
    if (stop) return false;
  }
  trim(most_bytes);
  return true;
}

void BrickCache::trim(std::size_t most_bytes) {
  std::vector<std::tuple<std::uint64_t, BrickName>> order;
  for (const auto& [name, state] : bricks_)
    if (state.used != time_) order.emplace_back(state.used, name);
  std::ranges::sort(order);
  for (const auto& [used, name] : order) {
    if (bytes() <= most_bytes) break;
    const auto found = bricks_.find(name);
    if (found->second.brick.samples) bytes_ -= found->second.brick.bytes();
    bricks_.erase(found);
  }
}

}  // namespace gs::qnv::values
