#include "qnv/codecs/values/slices/level_slices.h"

#include "base/parallel.h"
#include "qnv/codecs/values/lifting_kernel.h"

#include <algorithm>
#include <utility>

namespace gs::qnv::values {

namespace {

// Rows that a thread lifts at once.
constexpr std::size_t kRowsAtOnce = 64;

}  // namespace

unsigned threads_for(std::size_t samples, unsigned threads) {
  constexpr std::size_t kLittle = std::size_t{1} << 16;
  return samples < kLittle ? 1 : threads;
}

LevelSlices::LevelSlices(Extent extent, int levels, int level, bool undo, SliceWindow window)
    : whole_(low_extent(extent, level - 1)),
      low_(levels == 0 ? whole_ : low_extent(extent, level)),
      window_{window.first, std::min(window.end, whole_[2])},
      transformed_(levels > 0),
      undo_(undo),
      order_(transformed_ ? window_.end - window_.first : 1, undo),
      first_(window_.first) {}

void LevelSlices::add(std::uint32_t count, bool clear) {
  for (; count > 0; --count) {
    if (unused_.empty()) {
      slices_.emplace_back(std::size_t{whole_[0]} * whole_[1]);
    } else {
      slices_.push_back(std::move(unused_.back()));
      unused_.pop_back();
      if (clear) std::ranges::fill(slices_.back(), 0);
    }
  }
}

void LevelSlices::lift_depth(unsigned threads) {
  if (!transformed_) return;
  std::vector<LiftOperation> operations;
  order_.advance(added() - window_.first, operations);
  if (operations.empty()) return;
  const std::size_t row = whole_[0], rows = whole_[1], dropped = first_ - window_.first;
  (void)parallel_for((rows + kRowsAtOnce - 1) / kRowsAtOnce,
                     [&](std::size_t part) {
                       for (std::size_t y = part * kRowsAtOnce; y < std::min(rows, (part + 1) * kRowsAtOnce); ++y)
                         for (const LiftOperation& one : operations)
                           lift(slices_[one.target - dropped].data() + y * row,
                                slices_[one.before - dropped].data() + y * row,
                                slices_[one.after - dropped].data() + y * row, row, one.step, undo_);
                     },
                     threads_for(operations.size() * row * rows, threads));
}

void LevelSlices::add_samples(std::span<const SliceRows> slices, unsigned threads) {
  const std::uint32_t first = added();
  add(static_cast<std::uint32_t>(slices.size()), false);
  (void)parallel_for(
      slices.size(),
      [&](std::size_t i) {
        const SliceRows to = slice(first + static_cast<std::uint32_t>(i));
        if (!transformed_) return copy_slice(slices[i], to, whole_);
        thread_local SliceScratch scratch;
        split_slice(slices[i], to, whole_[0], whole_[1], scratch);
      },
      threads_for(slices.size() * whole_[0] * whole_[1], threads));
  lift_depth(threads);
}

void LevelSlices::drop(std::uint32_t z) {
  z = std::min(z, released());
  for (; first_ < z && !slices_.empty(); ++first_) {
    unused_.push_back(std::move(slices_.front()));
    slices_.pop_front();
  }
}

std::uint32_t LevelSlices::slices_of_rows(std::uint32_t rows) const {
  return std::min(whole_[2], rows * kBlockEdge * (transformed_ ? 2 : 1));
}

BlockBands LevelSlices::bands_of(const BlockPlace& place) {
  BlockBands bands;
  for (std::uint32_t i = 0; i < place.band_count; ++i) {
    const BandPart& part = place.bands[i];
    for (std::uint32_t z = 0; z < part.size[2]; ++z) {
      const std::uint32_t at = part.first[2] + z;
      const std::uint32_t slice = !transformed_ ? at : at < low_[2] ? 2 * at : 2 * (at - low_[2]) + 1;
      bands.parts[i][z] = slices_[slice - first_].data() + std::size_t{part.first[1]} * whole_[0] + part.first[0];
    }
  }
  bands.row = whole_[0];
  return bands;
}

}  // namespace gs::qnv::values
