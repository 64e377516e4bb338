#pragma once

#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/slices/slice_lifting.h"

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Range of slices.
struct SliceWindow {
  std::uint32_t first = 0, end = ~std::uint32_t{0};  // a larger end means the end of the volume
};
/// Maximum distance along an axis between a sample and the coefficients that depend on it.
inline constexpr std::uint32_t kSliceReach = 4;

/// Transformed slices of one level that are in memory: those in the window of the lifting along z, and those of the
/// current blocks. A slice holds the bands that x and y give. One thread at a time.
class LevelSlices {
 public:
  /// `level` counts from 1, the finest. Without levels, the slices are those of the volume. With a window, only its
  /// slices are added, and slices within kSliceReach of its ends are wrong unless the volume ends there. A window
  /// begins at an even slice.
  LevelSlices(Extent extent, int levels, int level, bool undo, SliceWindow window = {});

  [[nodiscard]] const Extent& whole() const { return whole_; }
  [[nodiscard]] const Extent& low() const { return low_; }
  [[nodiscard]] bool transformed() const { return transformed_; }
  /// Returns the end of the slices that can be added.
  [[nodiscard]] std::uint32_t end() const { return window_.end; }
  /// Returns the end of the slices added so far.
  [[nodiscard]] std::uint32_t added() const { return first_ + static_cast<std::uint32_t>(slices_.size()); }
  /// Returns the end of the slices that are completely lifted along z.
  [[nodiscard]] std::uint32_t finished() const { return transformed_ ? window_.first + order_.finished() : added(); }
  /// Returns the end of the slices that lifting along z no longer needs.
  [[nodiscard]] std::uint32_t released() const { return transformed_ ? window_.first + order_.released() : added(); }
  /// Adds slices of the level below, or of the volume. Transforms all slices for which enough neighbours are present.
  void add_samples(std::span<const SliceRows> slices, unsigned threads);
  /// Adds slices. Their content is undefined, or 0 if `clear`.
  void add(std::uint32_t count, bool clear);
  [[nodiscard]] SliceRows slice(std::uint32_t z) { return {slices_[z - first_].data(), whole_[0]}; }
  /// Lifts along z what the added slices permit.
  void lift_depth(unsigned threads);
  /// Drops the slices before `z` that lifting does not need any more.
  void drop(std::uint32_t z);

  /// Returns the number of rows of blocks along z, and that of the slices that the first `rows` of them need.
  [[nodiscard]] std::uint32_t block_rows() const { return (low_[2] + kBlockEdge - 1) / kBlockEdge; }
  [[nodiscard]] std::uint32_t slices_of_rows(std::uint32_t rows) const;
  /// Returns the coefficients of a block. Its slices must be in memory.
  [[nodiscard]] BlockBands bands_of(const BlockPlace& place);

 private:
  Extent whole_, low_;
  SliceWindow window_;
  bool transformed_, undo_;
  LiftOrder order_;      // of the window
  std::uint32_t first_;  // slice in slices_[0]
  std::deque<std::vector<std::int32_t>> slices_;
  std::vector<std::vector<std::int32_t>> unused_;
};

/// Returns a number of threads that suits the work on `samples` samples: one for little work.
[[nodiscard]] unsigned threads_for(std::size_t samples, unsigned threads);

}  // namespace gs::qnv::values
