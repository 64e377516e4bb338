#include "qnv/codecs/values/decode/sample_levels.h"

#include "base/parallel.h"
#include "qnv/codecs/values/lifting_kernel.h"

#include <algorithm>
#include <cstring>

namespace gs::qnv::values {

namespace {

// Number of samples that the inverse lifting of one axis reaches.
constexpr std::uint32_t kReach = 4;
// Maximum units of a box per axis. Its samples stay in the processor's cache.
constexpr Extent kMostUnits{32, 8, 8};
// Boxes with fewer samples are not worth a thread.
constexpr std::size_t kThreadSamples = std::size_t{1} << 16;

// Rows of x that are lifted together. They stay in the fastest cache.
constexpr std::size_t kLinesAtOnce = 8;

// Reverts the lifting of `count` rows along x. Each row has its even samples first, and the odd ones from `odd` on.
// There is room for a sample after the even ones, and before and after the odd ones.
void unlift_lines(std::int32_t* first, std::size_t count, const SplitWindow& window) {
  const std::size_t evens = (window.size[0] + 1) / 2, odds = window.size[0] / 2;
  if (odds == 0) return;
  for (std::size_t step = 4; step-- > 0;)
    for (std::size_t i = 0; i < count; ++i) {
      std::int32_t* const even = first + i * window.row;
      std::int32_t* const odd = even + window.odd;
      if (step % 2 == 0) {
        even[evens] = even[evens - 1];
        lift(odd, even, even + 1, odds, step, true);
      } else {
        odd[-1] = odd[0];
        odd[odds] = odd[odds - 1];
        lift(even, odd - 1, odd, evens, step, true);
      }
    }
}

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
      low[a] = 2 * std::int64_t{at[a]} - kReach;
      high[a] = 2 * (std::int64_t{at[a]} + kCubeEdge) + kReach;
    }
    finer.old.mark(low, high);
  });
}

void SampleLevels::update_top(const Block* block) {
  Level& top = all_.back();
  const std::vector<SampleBox> boxes = top.old.take(top.samples.extent());
  if (boxes.empty()) return;
  const Extent part = top.samples.extent();
  std::vector<std::int32_t> dense(sample_count(part), 0);
  if (block) block->write_low(dense, part);
  top.samples.open(boxes);
  for (std::uint32_t z = 0; z < part[2]; ++z)
    for (std::uint32_t y = 0; y < part[1]; ++y)
      top.samples.write(0, y, z, part[0], dense.data() + (std::size_t{z} * part[1] + y) * part[0], top.changed);
}

void SampleLevels::update(int level, const BlockLayout& layout, const FindBlock& find) {
  begin(levels_);
  update_top(find(0));
  for (int to = levels_ - 1; to >= level; --to) {
    begin(to);
    Level& own = level_of(to);
    (void)take(to + 1);
    const std::vector<SampleBox> boxes = own.old.take_for(kMostUnits, kReach);
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
      low[a] = 2 * std::int64_t{box.first[a]} - kReach;
      high[a] = 2 * (std::int64_t{box.first[a]} + box.size[a]) + kReach;
    }
    level_of(level - 1).old.mark(low, high);
  }
  return boxes;
}

void SampleLevels::lift_box(int level, const SampleBox& box, const BlockLayout& layout, const FindBlock& find) {
  Level& own = level_of(level);
  const Extent whole = own.samples.extent();
  SplitWindow window;
  Extent lows{};
  for (std::size_t a = 0; a < 3; ++a) {
    window.first[a] = box.first[a] - std::min(box.first[a], kReach);
    const std::uint32_t last = std::min(whole[a], box.first[a] + box.size[a] + kReach);
    window.size[a] = last - window.first[a];
    lows[a] = (window.size[a] + 1) / 2;
  }
  thread_local std::vector<std::int32_t> samples, joined;
  window.odd = (lows[0] + 2 + 7) / 8 * 8;
  window.row = (window.odd + window.size[0] / 2 + 1 + 7) / 8 * 8;
  const std::size_t row = window.row, slice = row * window.size[1];
  samples.assign(slice * window.size[2], 0);
  joined.resize(window.size[0] + 1);
  window.samples = samples.data();
  const SampleBox low{{window.first[0] / 2, window.first[1] / 2, window.first[2] / 2}, lows};
  level_of(level + 1).samples.read(low, samples.data(), 2 * row, 2 * slice);
  Extent block_first{}, block_last{};
  for (std::size_t a = 0; a < 3; ++a) {
    block_first[a] = low.first[a] / kBlockEdge;
    block_last[a] = (low.first[a] + lows[a] - 1) / kBlockEdge;
  }
  for (std::uint32_t z = block_first[2]; z <= block_last[2]; ++z)
    for (std::uint32_t y = block_first[1]; y <= block_last[1]; ++y)
      for (std::uint32_t x = block_first[0]; x <= block_last[0]; ++x)
        if (const Block* const block = find(layout.number(level + 1, {x, y, z}))) block->write_split(window);
  // Later axes need only the samples of the box.
  const std::size_t y0 = box.first[1] - window.first[1], z0 = box.first[2] - window.first[2];
  unlift_rows(samples.data(), window.size[2], slice, slice);
  for (std::size_t z = z0; z < z0 + box.size[2]; ++z) {
    std::int32_t* const at = samples.data() + z * slice;
    unlift_rows(at, window.size[1], row, row);
    for (std::size_t y = y0; y < y0 + box.size[1]; ++y) {
      std::int32_t* const line = at + y * row;
      if ((y - y0) % kLinesAtOnce == 0) unlift_lines(line, std::min(kLinesAtOnce, y0 + box.size[1] - y), window);
      interleave(line, line + window.odd, window.size[0] / 2, joined.data());
      if (window.size[0] % 2 != 0) joined[window.size[0] - 1] = line[lows[0] - 1];
      own.samples.write(box.first[0], box.first[1] + static_cast<std::uint32_t>(y - y0),
                        box.first[2] + static_cast<std::uint32_t>(z - z0), box.size[0],
                        joined.data() + (box.first[0] - window.first[0]), own.changed);
    }
  }
}

}  // namespace gs::qnv::values
