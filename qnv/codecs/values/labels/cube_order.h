#pragma once

#include "qnv/codecs/values/block_places.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Order of the cubes of kCubeEdge voxels of one level: a Morton code without the bits that an axis does not need.
/// Codes outside of the level have no cube. FORMAT.md, "Labels".
class CubeOrder {
 public:
  /// `extent` has at most kMaxLabelEdge voxels along each axis.
  explicit CubeOrder(Extent extent);

  /// Returns the number of codes.
  [[nodiscard]] std::uint64_t codes() const { return std::uint64_t{1} << (bits_[0] + bits_[1] + bits_[2]); }
  /// Returns the number of cubes per axis.
  [[nodiscard]] const Extent& cubes() const { return cubes_; }
  /// Returns the code of a cube.
  [[nodiscard]] std::uint64_t code(const Extent& cube) const {
    return spread_[0][cube[0]] | spread_[1][cube[1]] | spread_[2][cube[2]];
  }
  /// Returns the bits of a code that a place along an axis determines.
  [[nodiscard]] std::uint64_t part(std::size_t axis, std::uint32_t place) const { return spread_[axis][place]; }
  /// Returns the place of a code. It may be outside of the level.
  [[nodiscard]] Extent place(std::uint64_t code) const;
  /// Returns the number of low bits of a code that come from the lowest `bits` bits of the places.
  [[nodiscard]] int bits_below(int bits) const;
  [[nodiscard]] bool has(const Extent& cube) const {
    return cube[0] < cubes_[0] && cube[1] < cubes_[1] && cube[2] < cubes_[2];
  }

 private:
  Extent cubes_{};
  std::array<int, 3> bits_{};
  std::array<std::vector<std::uint64_t>, 3> spread_;
};

}  // namespace gs::qnv::values
