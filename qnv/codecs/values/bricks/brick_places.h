#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/decode/unit_mask.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace gs::qnv::values {

/// Edge of a brick in samples, and the samples around it that it also has. Two blocks per axis are a brick. The margin
/// is the reach of the inverse lifting, so that finer bricks depend only on the brick that contains them.
inline constexpr std::uint32_t kBrickEdge = 64, kBrickMargin = 4;
inline constexpr std::uint32_t kBrickBlocks = 2;

/// Cube of samples of one level, from `at` * kBrickEdge on.
struct BrickName {
  int level = 0;
  Extent at{};
  friend auto operator<=>(const BrickName&, const BrickName&) = default;

  /// Returns the brick of the next coarser level that contains this one.
  [[nodiscard]] BrickName parent() const { return {level + 1, {at[0] / 2, at[1] / 2, at[2] / 2}}; }
};
struct BrickNameHash {
  [[nodiscard]] std::size_t operator()(const BrickName& name) const {
    std::uint64_t h = static_cast<std::uint64_t>(name.level);
    for (const std::uint32_t n : name.at) h = (h ^ n) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    return static_cast<std::size_t>(h);
  }
};

/// Bricks of the levels below `base`. Viewers have the samples of `base` as a whole.
class BrickLayout {
 public:
  BrickLayout(Extent extent, int base);

  [[nodiscard]] int base() const { return base_; }
  [[nodiscard]] const BlockLayout& blocks() const { return blocks_; }
  /// Returns the samples of a level per axis, for levels 0 to base().
  [[nodiscard]] const Extent& extent(int level) const { return extents_[static_cast<std::size_t>(level)]; }
  /// Returns the bricks of a level per axis.
  [[nodiscard]] Extent bricks(int level) const;
  [[nodiscard]] bool contains(const BrickName& name) const;
  /// Returns the samples of a brick, without and with its margin, as far as the level has them.
  [[nodiscard]] SampleBox core(const BrickName& name) const;
  [[nodiscard]] SampleBox extended(const BrickName& name) const;
  /// Calls visit(child) for each brick of the next finer level in this one.
  void children(const BrickName& name, const std::function<void(const BrickName&)>& visit) const;
  /// Calls visit(block) for each block of coefficients in the brick, and around it if `around`.
  void visit_blocks(const BrickName& name, bool around, const std::function<void(std::uint64_t)>& visit) const;
  /// Calls visit(block) for each block of all levels below base() that the samples of a brick with its margin depend
  /// on.
  void visit_sources(const BrickName& name, const std::function<void(std::uint64_t)>& visit) const;

 private:
  int base_;
  BlockLayout blocks_;
  std::vector<Extent> extents_;
};

}  // namespace gs::qnv::values
