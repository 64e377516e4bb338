#pragma once

#include "qnv/codecs/values/decode/unit_mask.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Edges of a brick in samples.
inline constexpr Extent kBrick{32, 16, 16};

/// Samples of one level, in bricks. Copies share their bricks. A change replaces bricks that a copy may have, so that
/// copies never change and any thread may read them.
class SampleBricks {
 public:
  SampleBricks() = default;
  /// Makes samples that are all 0. They take no memory.
  explicit SampleBricks(Extent extent);

  [[nodiscard]] const Extent& extent() const { return extent_; }
  /// Returns the bytes of all bricks.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Copies a box to `to`, with these distances between its rows and slices, in samples.
  void read(const SampleBox& box, std::int32_t* to, std::size_t row, std::size_t slice) const;

  /// Notes that a copy was made. Later changes replace its bricks.
  void share() { ++age_; }
  /// Prepares the bricks of these boxes for write().
  void open(std::span<const SampleBox> boxes);
  /// Writes `count` samples of a row. Adds units with changed samples to `changed`. Threads may write different units
  /// at once.
  void write(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t count, const std::int32_t* from,
             UnitMask& changed);

 private:
  static constexpr std::size_t kSamples = std::size_t{kBrick[0]} * kBrick[1] * kBrick[2];
  using Brick = std::array<std::int32_t, kSamples>;

  [[nodiscard]] std::size_t number(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{z / kBrick[2]} * count_[1] + y / kBrick[1]) * count_[0] + x / kBrick[0];
  }
  [[nodiscard]] static std::size_t place(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (std::size_t{z % kBrick[2]} * kBrick[1] + y % kBrick[1]) * kBrick[0] + x % kBrick[0];
  }

  Extent extent_{}, count_{};
  std::vector<std::shared_ptr<Brick>> bricks_;  // null means zeros
  std::vector<std::uint64_t> ages_;             // of the bricks: value of `age_` when they were made
  std::uint64_t age_ = 1;                       // number of copies so far, plus one
};

}  // namespace gs::qnv::values
