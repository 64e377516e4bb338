#pragma once

#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/decode/unit_mask.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Samples of a cuboid of one level, x first. Never changes once other threads have it.
struct BrickSamples {
  int level = 0;
  SampleBox box;
  std::vector<std::int32_t> samples;

  [[nodiscard]] bool contains(const SampleBox& part) const;
  /// Copies a part of the box to `to`, with these distances between its rows and slices, in samples.
  void read(const SampleBox& part, std::int32_t* to, std::size_t row, std::size_t slice) const;
  [[nodiscard]] std::size_t bytes() const { return samples.size() * sizeof(std::int32_t); }
};

/// Computes the samples of `box` by one inverse step. `coarser` has the samples of the next coarser level, as far as
/// the step reaches: kBrickMargin / 2 beyond both ends. `blocks` are the blocks of coefficients around the box; all
/// others are zero. `extent` is that of the level. The samples are those of restore().
[[nodiscard]] BrickSamples lift_brick(int level, const SampleBox& box, const Extent& extent,
                                      const BrickSamples& coarser, std::span<const Block* const> blocks);

}  // namespace gs::qnv::values
