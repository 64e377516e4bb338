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

std::uint64_t BrickCache::key_of(const BrickName& name, const BrickNeeds& needs, const BrickSources& sources,
                                 std::vector<std::uint64_t>& blocks) const {
  const auto parent = bricks_.find(name.parent());
  std::uint64_t key =
      parent != bricks_.end() ? parent->second.key : mixed(mixed(1, sources.base.version), sources.base.final ? 1 : 0);
  if (name.level == 0) key = mixed(key, sources.gaps.count());
  if (name.level == 0 && needs.exact.contains(name)) {
    key = mixed(key, ~std::uint64_t{0});
    sources.remainders.visit(layout_.extended(name), [&](const RunPlace& run) {
      if (sources.remainders.has(run)) key = mixed(key, run.first);
    });
  }
  blocks.clear();
  layout_.visit_blocks(name, true, [&](std::uint64_t block) {
    if (!needs.blocks.contains(block)) return;
    for (std::uint32_t step = sources.chain.first; step <= sources.chain.last; ++step) {
      const std::uint64_t number = sources.chain.number(step, block);
      const std::uint32_t received = BlockCache::received(number, sources.chunks);
      if (received == 0) continue;
      key = mixed(mixed(key, number), received);
      blocks.push_back(number);
    }
  });
  return key;
}

// Returns the blocks that add up to the coefficients of the last step: at each place, the last one that is no
// difference, and those after it.
std::vector<const Block*> BrickCache::parts_of(std::span<const std::uint64_t> blocks) const {
  const std::uint64_t count = layout_.blocks().count();
  std::vector<const Block*> parts;
  for (std::size_t end = blocks.size(); end > 0;) {
    const std::uint64_t place = blocks[end - 1] % count;
    bool refers = true;
    for (; end > 0 && blocks[end - 1] % count == place; --end) {
      const Block* const block = refers ? blocks_.find(blocks[end - 1]) : nullptr;
      if (!block) continue;
      parts.push_back(block);
      refers = blocks_.differs(blocks[end - 1]);
    }
  }
  return parts;
}

void BrickCache::compute(const Work& work, const BrickNeeds& needs, const BrickSources& sources) const {
  Brick& brick = work.state->brick;
  const int level = brick.name.level;
  const BrickBase& base = sources.base;
  const std::vector<const Block*> blocks = parts_of(work.blocks);
  BrickSamples made = lift_brick(level, layout_.extended(brick.name), layout_.extent(level),
                                 work.parent ? *work.parent->samples : *base.samples, blocks);
  brick.final = {};
  if (base.final)
    brick.final =
        final_cubes(layout_, brick.name, work.parent ? &work.parent->final : nullptr, [&](std::uint64_t block) {
          return sources.chunks.known(block) == 0 ||
                 (needs.blocks.contains(block) && blocks_.whole(block, sources.chunks));
        });
  std::vector<std::int32_t> raw;
  const bool exact = work.exact && base.final;
  if (exact) raw = made.samples;
  VolumeLayout layout = levels_[static_cast<std::size_t>(level)];
  if (level == 0) base.limits.apply(made.samples);
  if (level == 0 && sources.gaps.mark(made.box, kMissingInBrick, made.samples)) layout.missing = kMissingInBrick;
  const SampleBox core = layout_.core(brick.name);
  brick.wanted = base.shares.of(brick.name) * static_cast<double>(sample_count(core.size));
  brick.vectors = longest_vectors(made, core, layout, static_cast<std::size_t>(std::ceil(kKeptVectors * brick.wanted)));
  if (level == 0) finish(brick, made, raw, sources);
  brick.samples = std::make_shared<const BrickSamples>(std::move(made));
}

// Applies remainders to the samples of a brick of level 0. `raw` are the samples without limits, or empty.
void BrickCache::finish(Brick& brick, BrickSamples& made, std::span<const std::int32_t> raw,
                        const BrickSources& sources) const {
  brick.stored = false;
  if (!grid_.exact && grid_.correction == 0) return;
  if (raw.empty()) {
    brick.final = {};
    return;
  }
  std::vector<std::uint32_t> remainders(made.samples.size());
  sources.remainders.add(brick.final, remainders);
  apply_remainders(grid_, brick.final, raw, remainders, made.samples);
  brick.stored = grid_.exact;
}

bool BrickCache::update(const BrickNeeds& needs, const BrickSources& sources, std::size_t most_bytes,
                        const std::atomic<bool>& stop, const std::function<void()>& before_change) {
  ++time_;
  computed_ = 0;
  make_room(needs, sources.base, most_bytes);
  for (int level = layout_.base() - 1; level >= 0; --level) {
    std::vector<Work> works;
    std::vector<std::uint64_t> blocks, needed;
    for (const BrickName& name : needs.chosen) {
      if (name.level != level) continue;
      const std::uint64_t key = key_of(name, needs, sources, blocks);
      State& state = bricks_[name];
      state.used = time_;
      if (state.brick.samples && state.key == key) continue;
      if (computed_ == 0 && works.empty()) before_change();
      state.key = key;
      if (state.brick.samples) bytes_ -= state.brick.bytes();
      state.brick.name = name;
      state.brick.samples.reset();
      const Brick* const parent = level + 1 < layout_.base() ? find(name.parent()) : nullptr;
      works.push_back({&state, parent, blocks, needs.exact.contains(name)});
      needed.insert(needed.end(), blocks.begin(), blocks.end());
    }
    blocks_.decode(needed, sources.chunks);
    // Bricks are computed side by side, and each needs only the coarser one.
    (void)parallel_for(works.size(), [&](std::size_t i) {
      if (!stop) compute(works[i], needs, sources);
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

// Drops bricks that are not chosen before new ones need their memory.
void BrickCache::make_room(const BrickNeeds& needs, const BrickBase& base, std::size_t most_bytes) {
  std::size_t coming = 0;
  for (const BrickName& name : needs.chosen) {
    const auto known = bricks_.find(name);
    if (known != bricks_.end())
      known->second.used = time_;
    else
      coming += brick_bytes(layout_, name, base.shares.of(name));
  }
  trim(most_bytes - std::min(coming, most_bytes));
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
