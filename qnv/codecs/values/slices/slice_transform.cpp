#include "qnv/codecs/values/slices/slice_transform.h"

#include "base/parallel.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gs::qnv::values {

namespace {

void copy_slice(SliceRows from, SliceRows to, const Extent& size) {
  for (std::uint32_t y = 0; y < size[1]; ++y)
    std::memcpy(to.first + y * to.stride, from.first + y * from.stride, size[0] * sizeof(std::int32_t));
}

// Makes a level of either class for each level of the volume.
template <class Level>
std::vector<Level> levels_of(Extent extent, bool undo) {
  const int levels = level_count(extent);
  const BlockLayout layout(extent, levels);
  std::vector<Level> all;
  for (int level = 1; level <= std::max(levels, 1); ++level) {
    const Extent blocks = layout.blocks_of(level);
    all.push_back({LevelSlices(extent, levels, level, undo), layout.first_of(level), blocks[0] * blocks[1]});
  }
  return all;
}

}  // namespace

SliceTransform::SliceTransform(Extent extent, unsigned threads, TakeBlocks take)
    : threads_(threads),
      transformed_(level_count(extent) > 0),
      take_(std::move(take)),
      levels_(levels_of<Level>(extent, false)) {}

bool SliceTransform::add(std::size_t level, std::span<const SliceRows> slices) {
  Level& one = levels_[level];
  const Extent& whole = one.slices.whole();
  const std::uint32_t first = one.slices.added(), before = one.slices.finished();
  one.slices.add(static_cast<std::uint32_t>(slices.size()), false);
  (void)parallel_for(
      slices.size(),
      [&](std::size_t i) {
        const SliceRows to = one.slices.slice(first + static_cast<std::uint32_t>(i));
        if (!transformed_) return copy_slice(slices[i], to, whole);
        thread_local SliceScratch scratch;
        split_slice(slices[i], to, whole[0], whole[1], scratch);
      },
      threads_for(slices.size() * whole[0] * whole[1], threads_));
  one.slices.lift_depth(threads_);
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

SliceRestorer::SliceRestorer(Extent extent, unsigned threads, WriteBlock write)
    : threads_(threads),
      transformed_(level_count(extent) > 0),
      write_(std::move(write)),
      layout_(extent, level_count(extent)),
      levels_(levels_of<Level>(extent, true)) {}

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
  while (one.slices.released() < one.given && one.rows < one.slices.block_rows()) decode_row(level);
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
