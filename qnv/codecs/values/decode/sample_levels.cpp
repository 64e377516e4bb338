#include "qnv/codecs/values/decode/sample_levels.h"

#include "base/parallel.h"
#include "qnv/codecs/values/decode/split_lifting.h"

#include <algorithm>
#include <cstring>

namespace gs::qnv::values {

namespace {

// Maximum units of a box per axis. Its samples stay in the processor's cache.
constexpr Extent kMostUnits{32, 8, 8};
// Boxes with fewer samples are not worth a thread.
constexpr std::size_t kThreadSamples = std::size_t{1} << 16;

}  // namespace

SampleLevels::SampleLevels(Extent extent, int levels) : extent_(extent), levels_(levels) {
  all_.resize(static_cast<std::size_t>(levels) + 1);
}

void SampleLevels::begin(int level) {
  Level& own = level_of(level);
  if (own.begun) return;
  const Extent part = low_extent(extent_, level);
  own.samples = SampleBricks(part);
  own.old = UnitMask(part, kUnit);
  own.changed = UnitMask(part, kUnit);
  own.old.mark_all();
  own.changed.mark_all();
  own.begun = true;
}

void SampleLevels::note(const Block& block, std::size_t first, std::size_t steps) {
  if (block.level() >= levels_ && all_.back().begun) all_.back().old.mark_all();
  Level& finer = all_[static_cast<std::size_t>(std::max(block.level() - 1, 0))];
  if (!finer.begun || levels_ == 0) return;
  block.visit_known(first, steps, [&](const Extent& at) {
    std::array<std::int64_t, 3> low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = 2 * std::int64_t{at[a]} - kLiftReach;
      high[a] = 2 * (std::int64_t{at[a]} + kCubeEdge) + kLiftReach;
    }
    finer.old.mark(low, high);
  });
}

void SampleLevels::update_top(const BlockChain& blocks) {
  Level& top = all_.back();
  const std::vector<SampleBox> boxes = top.old.take(top.samples.extent());
  if (boxes.empty()) return;
  const Extent part = top.samples.extent();
  std::vector<std::int32_t> dense(sample_count(part), 0);
  for (const Block* const block : blocks) block->write_low(dense, part);
  top.samples.open(boxes);
  for (std::uint32_t z = 0; z < part[2]; ++z)
    for (std::uint32_t y = 0; y < part[1]; ++y)
      top.samples.write(0, y, z, part[0], dense.data() + (std::size_t{z} * part[1] + y) * part[0], top.changed);
}

void SampleLevels::update(int level, const BlockLayout& layout, const FindBlocks& find) {
  begin(levels_);
  update_top(find(0));
  for (int to = levels_ - 1; to >= level; --to) {
    begin(to);
    Level& own = level_of(to);
    (void)take(to + 1);
    const std::vector<SampleBox> boxes = own.old.take_for(kMostUnits, kLiftReach);
    own.samples.open(boxes);
    std::size_t work = 0;
    for (const SampleBox& box : boxes) work += sample_count(box.size);
    parallel_for(
        boxes.size(), [&](std::size_t i) { lift_box(to, boxes[i], layout, find); }, work < kThreadSamples ? 1 : 0);
  }
}

SampleBricks SampleLevels::copy(int level) {
  SampleBricks& samples = level_of(level).samples;
  samples.share();
  return samples;
}

std::vector<SampleBox> SampleLevels::take(int level) {
  constexpr Extent kAny{1u << 31, 1u << 31, 1u << 31};
  const std::vector<SampleBox> boxes = level_of(level).changed.take(kAny);
  if (level == 0 || !level_of(level - 1).begun) return boxes;
  for (const SampleBox& box : boxes) {
    std::array<std::int64_t, 3> low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = 2 * std::int64_t{box.first[a]} - kLiftReach;
      high[a] = 2 * (std::int64_t{box.first[a]} + box.size[a]) + kLiftReach;
    }
    level_of(level - 1).old.mark(low, high);
  }
  return boxes;
}

void SampleLevels::lift_box(int level, const SampleBox& box, const BlockLayout& layout, const FindBlocks& find) {
  Level& own = level_of(level);
  thread_local std::vector<std::int32_t> samples;
  const SplitWindow window = window_around(box, own.samples.extent(), samples);
  const SampleBox low = low_box(window);
  level_of(level + 1).samples.read(low, window.samples, 2 * window.row, 2 * window.row * window.size[1]);
  Extent block_first{}, block_last{};
  for (std::size_t a = 0; a < 3; ++a) {
    block_first[a] = low.first[a] / kBlockEdge;
    block_last[a] = (low.first[a] + low.size[a] - 1) / kBlockEdge;
  }
  for (std::uint32_t z = block_first[2]; z <= block_last[2]; ++z)
    for (std::uint32_t y = block_first[1]; y <= block_last[1]; ++y)
      for (std::uint32_t x = block_first[0]; x <= block_last[0]; ++x)
        for (const Block* const block : find(layout.number(level + 1, {x, y, z}))) block->write_split(window);
  unlift_window(window, box, [&](std::uint32_t y, std::uint32_t z, const std::int32_t* row) {
    own.samples.write(box.first[0], y, z, box.size[0], row, own.changed);
  });
}

}  // namespace gs::qnv::values
