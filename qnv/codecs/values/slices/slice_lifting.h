#pragma once

#include "qnv/codecs/values/lifting.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::values {

// The transform of lifting.h slice by slice, for volumes larger than memory. The samples are the same.

/// One operation of lifting: sample `target` changes by its neighbours `before` and `after`.
struct LiftOperation {
  std::uint32_t target = 0, before = 0, after = 0, step = 0;
};

/// Order of the operations along an axis, of which samples arrive one after the other.
class LiftOrder {
 public:
  LiftOrder(std::uint32_t samples, bool undo);

  /// Adds the operations that are possible when the first `ready` samples have arrived.
  void advance(std::uint32_t ready, std::vector<LiftOperation>& operations);
  /// Returns the number of samples from the first one on that have their final values.
  [[nodiscard]] std::uint32_t finished() const;
  /// Returns the number of samples from the first one on that no later operation needs.
  [[nodiscard]] std::uint32_t released() const;

 private:
  std::uint32_t samples_, ready_ = 0;
  bool undo_;
  std::array<std::uint32_t, 4> next_{};  // sample that a step changes next
};

/// Rows of numbers. Consecutive rows are `stride` apart.
struct SliceRows {
  std::int32_t* first = nullptr;
  std::size_t stride = 0;
};

/// Copies the rows of a slice.
void copy_slice(SliceRows from, SliceRows to, const Extent& size);

/// Buffers of a thread.
struct SliceScratch {
  std::vector<std::int32_t> line;
  std::vector<LiftOperation> operations;
};

/// Transforms a slice along x and y. Low bands come first on both axes. `from` and `bands` must not overlap.
void split_slice(SliceRows from, SliceRows bands, std::uint32_t nx, std::uint32_t ny, SliceScratch& scratch);
/// Reverts split_slice(). Changes `bands`.
void join_slice(SliceRows bands, SliceRows to, std::uint32_t nx, std::uint32_t ny, SliceScratch& scratch);

}  // namespace gs::qnv::values
