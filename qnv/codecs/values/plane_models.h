#pragma once

#include "qnv/codecs/values/plane_range.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::values {

/// Adaptive probability of a 1: the mean of a fast and of a slow estimate.
struct Estimate {
  std::uint32_t both = 0x80008000;  // the fast estimate in the lower half, the slow one in the upper half; of 65536
  std::uint32_t seen = 0;           // number of decisions, at most kSteady

  void start(std::uint32_t probability) { both = probability | probability << 16; }
  [[nodiscard]] std::uint32_t probability() const {
    return std::clamp<std::uint32_t>(((both & 65535) + (both >> 16)) >> 1, 48, 65536 - 48);
  }
  void learn(bool bit) {
    if (seen < kSteady) [[unlikely]]
      return learn_early(bit);
    const std::uint32_t fast = both & 65535, slow = both >> 16;
    // Without a branch.
    const std::uint32_t more = (fast + ((65535 - fast) >> 4)) | (slow + ((65535 - slow) >> 7)) << 16,
                        less = (fast - ((fast + 15) >> 4)) | (slow - ((slow + 127) >> 7)) << 16;
    both = less ^ ((less ^ more) & (0u - static_cast<std::uint32_t>(bit)));
  }

 private:
  static constexpr std::uint32_t kSteady = 40;
  // Early decisions change both estimates fast; later ones change the slow one less.
  void learn_early(bool bit) {
    const int quick = seen < 3 ? 2 : seen < 8 ? 3 : 4, late = seen < 3 ? 2 : seen < 8 ? 3 : seen < 18 ? 4 : 5;
    const std::int32_t target = bit ? 65535 : 0;
    const auto fast = static_cast<std::int32_t>(both & 65535), slow = static_cast<std::int32_t>(both >> 16);
    both = static_cast<std::uint32_t>(fast + ((target - fast) >> quick)) |
           static_cast<std::uint32_t>(slow + ((target - slow) >> late)) << 16;
    ++seen;
  }
};

/// Estimates of a block, which encoder and decoder learn alike (FORMAT.md, "Values payload").
struct PlaneModels {
  std::array<Estimate, 15> cubes;
  std::array<std::array<Estimate, 16>, 4> ones;  // by the number of axes on which the band is high, and context
  std::array<Estimate, 4> lines, more;

  /// Starts with probabilities that suit most volumes: they grow with the neighbours.
  PlaneModels() {
    for (std::uint32_t i = 0; i < cubes.size(); ++i)
      cubes[i].start(std::min<std::uint32_t>(9000 + 5500 * (i / 3) + 6000 * (i % 3), 58000));
    for (Estimate& model : lines) model.start(6000);
    for (auto& models : ones)
      for (std::uint32_t i = 0; i < models.size(); ++i)
        models[i].start(std::min<std::uint32_t>(1700 + 2300 * i, 34000));
    for (std::uint32_t i = 0; i < more.size(); ++i) more[i].start(26000 + 900 * i);
  }
};

}  // namespace gs::qnv::values
