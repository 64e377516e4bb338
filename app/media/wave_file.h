#pragma once

#include "app/media/mixer.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::app {

/// Recorder of a mixer's output as a 16-bit stereo WAV file.
class WaveFile {
 public:
  /// Maximum recorded length in seconds. Later samples are dropped.
  static constexpr double kLongest = 3600;

  void add(std::span<const float> pairs);
  /// Returns the whole WAV file.
  [[nodiscard]] std::vector<std::byte> bytes() const;

 private:
  std::vector<std::int16_t> samples_;
};

}  // namespace gs::app
