#include "qnv/codecs/values/slices/slice_transform.h"

#include "base/parallel.h"

#include <algorithm>
#include <utility>

namespace gs::qnv::values {

namespace {

// Extends a window of samples by the reach of the lifting, and to whole rows of blocks.
SliceWindow window_of_rows(SliceWindow samples, std::uint32_t slices, bool transformed) {
  const std::uint32_t edge = kBlockEdge * (transformed ? 2 : 1), reach = transformed ? kSliceReach : 0;
  samples.end = std::min(samples.end, slices);
  const std::uint32_t first = samples.first - std::min(samples.first, reach), end = samples.end + reach;
  return {first / edge * edge, std::min(slices, (end + edge - 1) / edge * edge)};
}

}  // namespace

SliceTransform::SliceTransform(Extent extent, unsigned threads, TakeBlocks take)
    : threads_(threads), take_(std::move(take)) {
  const int levels = level_count(extent);
  const BlockLayout layout(extent, levels);
  for (int level = 1; level <= std::max(levels, 1); ++level) {
    const Extent blocks = layout.blocks_of(level);
    levels_.push_back({LevelSlices(extent, levels, level, false), layout.first_of(level), blocks[0] * blocks[1]});
  }
}

RowTransform::RowTransform(Extent extent, int level, RankShare rows, unsigned threads, TakeRow take)
    : threads_(threads),
      rows_(rows),
      next_(static_cast<std::uint32_t>(rows.first)),
      take_(std::move(take)),
      slices_(extent, level_count(extent), level, false, window_of(extent, level, rows)) {}

SliceWindow RowTransform::window_of(Extent extent, int level, RankShare rows) {
  const LevelSlices all(extent, level_count(extent), level, false);
  const std::uint32_t reach = all.transformed() ? kSliceReach : 0;
  const std::uint32_t first = all.slices_of_rows(static_cast<std::uint32_t>(rows.first)),
                      end = all.slices_of_rows(static_cast<std::uint32_t>(rows.end));
  return {first - std::min(first, reach), std::min(all.whole()[2], end + reach)};
}

bool RowTransform::add(std::span<const SliceRows> slices) {
  slices_.add_samples(slices, threads_);
  for (; next_ < rows_.end && slices_.slices_of_rows(next_ + 1) <= slices_.finished(); ++next_)
    if (!take_(next_, slices_)) return false;
  slices_.drop(slices_.slices_of_rows(next_));
  return true;
}

bool SliceTransform::add(std::size_t level, std::span<const SliceRows> slices) {
  Level& one = levels_[level];
  const std::uint32_t before = one.slices.finished();
  one.slices.add_samples(slices, threads_);
  if (level + 1 < levels_.size()) {
    std::vector<SliceRows> lows;
    for (std::uint32_t z = before + before % 2; z < one.slices.finished(); z += 2) lows.push_back(one.slices.slice(z));
    if (!lows.empty() && !add(level + 1, lows)) return false;
  }
  for (; one.rows < one.slices.block_rows() && one.slices.slices_of_rows(one.rows + 1) <= one.slices.finished();
       ++one.rows)
    if (!take_(one.first_block + std::uint64_t{one.rows} * one.blocks_in_row, one.blocks_in_row, one.slices))
      return false;
  one.slices.drop(one.slices.slices_of_rows(one.rows));
  return true;
}

SliceRestorer::SliceRestorer(Extent extent, unsigned threads, WriteBlock write, SliceWindow window)
    : threads_(threads),
      transformed_(level_count(extent) > 0),
      write_(std::move(write)),
      layout_(extent, level_count(extent)) {
  const int levels = level_count(extent);
  const std::uint32_t edge = kBlockEdge * (transformed_ ? 2 : 1);
  for (int level = 1; level <= std::max(levels, 1); ++level) {
    const Extent blocks = layout_.blocks_of(level);
    const SliceWindow own = window_of_rows(window, low_extent(extent, level - 1)[2], transformed_);
    levels_.push_back({LevelSlices(extent, levels, level, true, own), layout_.first_of(level), blocks[0] * blocks[1],
                       own.first / edge, window.first});
    window = {own.first / 2, own.end / 2 + own.end % 2};
  }
}

void SliceRestorer::decode_row(std::size_t level) {
  Level& one = levels_[level];
  const std::uint32_t first = one.slices.slices_of_rows(one.rows), end = one.slices.slices_of_rows(one.rows + 1);
  one.slices.add(end - first, true);
  if (level + 1 < levels_.size()) {
    std::vector<SliceRows> lows;
    for (std::uint32_t z = first; z < end; z += 2) lows.push_back(one.slices.slice(z));
    next(level + 1, lows);
  }
  const std::uint64_t block = one.first_block + std::uint64_t{one.rows} * one.blocks_in_row;
  (void)parallel_for(
      one.blocks_in_row,
      [&](std::size_t i) {
        const BlockPlace place = layout_.place(block + i);
        write_(block + i, place, one.slices.bands_of(place));
      },
      threads_);
  one.slices.lift_depth(threads_);
  ++one.rows;
}

void SliceRestorer::next(std::size_t level, std::span<const SliceRows> slices) {
  Level& one = levels_[level];
  const Extent& whole = one.slices.whole();
  const std::uint32_t first = one.given;
  one.given += static_cast<std::uint32_t>(slices.size());
  while (one.slices.released() < one.given && one.slices.added() < one.slices.end()) decode_row(level);
  (void)parallel_for(
      slices.size(),
      [&](std::size_t i) {
        const SliceRows from = one.slices.slice(first + static_cast<std::uint32_t>(i));
        if (!transformed_) return copy_slice(from, slices[i], whole);
        thread_local SliceScratch scratch;
        join_slice(from, slices[i], whole[0], whole[1], scratch);
      },
      threads_for(slices.size() * whole[0] * whole[1], threads_));
  one.slices.drop(one.given);
}

}  // namespace gs::qnv::values
