#pragma once

#include "qnv/codecs/values/bricks/brick_samples.h"
#include "qnv/sampling/volume/volume.h"

#include <glm/vec3.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Number by which vectors are ordered: the upper bits of the length, which sort like the lengths. Keys of lengths of
/// equal binary logarithm differ by at most 1/128.
[[nodiscard]] inline std::uint32_t length_key(float length) { return std::bit_cast<std::uint32_t>(length) >> 16; }
inline constexpr std::size_t kLengthKeys = std::size_t{1} << 15;

/// Gradient vector of a brick.
struct BrickVector {
  std::uint32_t place = 0;  // index in the core of the brick, x first
  float length = 0, value = 0;
  glm::vec3 normal{0};
};

/// Returns at least `most` longest gradient vectors of the samples in `core`, or all that are not zero: those of the
/// `most` largest keys, and others with the lowest of these keys. Keys fall; equal keys are in the order of the places.
/// The gradients have the same bits as those of gradient_vectors(). `layout` is that of the level.
[[nodiscard]] std::vector<BrickVector> longest_vectors(const BrickSamples& samples, const SampleBox& core,
                                                       const VolumeLayout& layout, std::size_t most);

}  // namespace gs::qnv::values
