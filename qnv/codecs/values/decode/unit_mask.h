#pragma once

#include "qnv/codecs/values/lifting.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Cuboid of samples of one level.
struct SampleBox {
  Extent first{}, size{};
  friend bool operator==(const SampleBox&, const SampleBox&) = default;
};

/// Set of samples that changed, in cubes of a few samples per axis.
class UnitMask {
 public:
  UnitMask() = default;
  /// Makes an empty set for samples of an extent. `edge` is the edge of a unit in samples.
  UnitMask(Extent extent, std::uint32_t edge);

  /// Adds the units that a box touches: samples from `first` to before `last`. Clamps it to the extent.
  void mark(std::array<std::int64_t, 3> first, std::array<std::int64_t, 3> last);
  void mark_all();
  /// Adds the unit of one sample. Threads may add different units at once.
  void mark(std::uint32_t x, std::uint32_t y, std::uint32_t z) { *flag(x, y, z) = 1; }
  [[nodiscard]] std::uint32_t edge() const { return edge_; }
  /// Returns the flag of the unit of a sample. Those of the next units along x follow. Threads may set different flags.
  [[nodiscard]] std::uint8_t* flag(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return units_.data() + (std::size_t{z / edge_} * count_[1] + y / edge_) * count_[0] + x / edge_;
  }
  /// Removes all units. Returns them as disjoint boxes, each with at most `most` units per axis.
  [[nodiscard]] std::vector<SampleBox> take(Extent most);
  /// Removes all units like take(), for work that also reads `margin` samples around each box. Returns boxes that cover
  /// the whole extent if fewer samples are read for these.
  [[nodiscard]] std::vector<SampleBox> take_for(Extent most, std::uint32_t margin);

 private:
  [[nodiscard]] bool full(Extent first, Extent size) const;

  Extent extent_{}, count_{};
  std::uint32_t edge_ = 1;
  std::vector<std::uint8_t> units_;
};

}  // namespace gs::qnv::values
