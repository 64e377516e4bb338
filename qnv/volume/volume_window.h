#pragma once

#include "qnv/volume/gradient_row.h"
#include "qnv/volume/volume_slices.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// The values of some neighbouring slices of a volume that is too large to be had as a whole. Reading is
/// for one thread at a time; the values may be looked at by all.
class VolumeWindow {
 public:
  /// `source` must outlive the window and have a sound layout.
  VolumeWindow(const VolumeSource& source, unsigned threads) : source_(source), threads_(threads) {}

  /// How many slices to work on at a time, so that they fit the processor's caches.
  [[nodiscard]] std::uint32_t batch() const;

  /// Makes the slices first..last available (cut to those that there are); slices that were are not read
  /// again. False when the source does not give one.
  [[nodiscard]] bool move_to(std::int64_t first, std::int64_t last);

  /// The values of an available slice, x fastest.
  [[nodiscard]] const float* slice(std::uint32_t z) const { return slots_[z % slots_.size()].values.data(); }

  /// A row of an available slice whose two neighbours are available too.
  [[nodiscard]] GradientRow row(std::uint32_t y, std::uint32_t z) const;

 private:
  struct Slot {
    std::int64_t z = -1;
    std::vector<float> values;
  };
  const VolumeSource& source_;
  unsigned threads_;
  std::vector<Slot> slots_;
  std::vector<std::byte> stored_;
};

}  // namespace gs::qnv
