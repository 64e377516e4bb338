#pragma once

#include "qnv/sampling/volume/gradient_row.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Window over neighbouring slices of a volume that is too large for memory. Only one thread at a time may load slices;
/// any thread may read the loaded values.
class VolumeWindow {
 public:
  /// `source` must outlive the window and have a valid layout.
  VolumeWindow(const VolumeSource& source, unsigned threads) : source_(source), threads_(threads) {}

  /// Returns the number of slices to process at a time, so that they fit into the processor's caches.
  [[nodiscard]] std::uint32_t batch() const;

  /// Loads the slices from `first` to `last`, clamped to the volume. Does not load slices again. Returns false if the
  /// source fails.
  [[nodiscard]] bool move_to(std::int64_t first, std::int64_t last);

  /// Returns the values of a loaded slice; x varies fastest.
  [[nodiscard]] const float* slice(std::uint32_t z) const { return slots_[z % slots_.size()].values.data(); }

  /// Returns a row of a loaded slice. Both adjacent slices must be loaded, too.
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
