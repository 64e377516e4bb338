#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/values/decode/unit_mask.h"
#include "qnv/sampling/volume/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

namespace gs::qnv::values {

/// Levels of a volume in a file. The samples of level n are 2^n voxels apart on each axis, until an axis has one sample.
/// They come from the coarsest suitable version of the file, and from the whole volume if there is none. Their values
/// have slope and intercept; missing ones are NaN. Any thread.
class ArrayLevels : NonCopyable {
 public:
  /// Makes the levels 0 to `base`.
  ArrayLevels(VolumeSource source, int base);

  [[nodiscard]] int base() const { return static_cast<int>(levels_.size()) - 1; }
  [[nodiscard]] const Extent& extent() const { return source_.layout.dimensions; }
  /// Returns the layouts of all levels. Their numbers are float values.
  [[nodiscard]] const std::vector<VolumeLayout>& layouts() const { return layouts_; }
  /// Returns the samples per axis in one chunk of the file, at least 1; 0 on all axes if the file has no chunks.
  [[nodiscard]] Extent chunk(int level) const;
  /// Reports whether a level comes from a coarse version of the file.
  [[nodiscard]] bool has_version(int level) const {
    return levels_[static_cast<std::size_t>(level)].from != &source_;
  }
  /// Reports whether every chunk of the whole volume has samples of a level, so that reading it decodes them all.
  [[nodiscard]] bool decodes_all(int level) const;
  /// Reads the values of a box of samples, x first. Returns false if the file cannot be read.
  [[nodiscard]] bool read(int level, const SampleBox& box, std::vector<float>& values) const;
  [[nodiscard]] const VolumeSource& source() const { return source_; }

 private:
  /// Version of the volume that has the samples of a level, `step` of its voxels apart.
  struct Level {
    const VolumeSource* from = nullptr;
    std::array<std::uint32_t, 3> step{1, 1, 1};
  };
  VolumeSource source_;
  mutable std::mutex mutex_;  // of the functions of the source
  std::vector<Level> levels_;
  std::vector<VolumeLayout> layouts_;
};

}  // namespace gs::qnv::values
