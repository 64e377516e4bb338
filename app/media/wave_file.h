#pragma once

#include "app/media/mixer.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::app {

/// What a mixer mixes, as a WAV of 16 bits and two channels.
class WaveFile {
 public:
  /// So much is kept at most, in seconds; what comes later is left out.
  static constexpr double kLongest = 3600;

  void add(std::span<const float> pairs);
  /// The whole file.
  [[nodiscard]] std::vector<std::byte> bytes() const;

 private:
  std::vector<std::int16_t> samples_;
};

}  // namespace gs::app
