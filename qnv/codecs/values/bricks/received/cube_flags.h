#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/decode/unit_mask.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Flags of the cubes of a box of samples. The box begins at a cube.
struct CubeFlags {
  SampleBox box;
  Extent count{};                   // cubes per axis
  std::vector<std::uint8_t> flags;  // x first

  CubeFlags() = default;
  CubeFlags(const SampleBox& of, bool flag) : box(of) {
    for (std::size_t a = 0; a < 3; ++a) count[a] = (box.size[a] - 1) / kCubeEdge + 1;
    flags.assign(std::size_t{count[0]} * count[1] * count[2], flag ? 1 : 0);
  }
  /// Returns the flag of a sample of the box.
  [[nodiscard]] std::uint8_t& at(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return flags[index(x, y, z)];
  }
  [[nodiscard]] bool is_set(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return flags[index(x, y, z)] != 0;
  }

 private:
  [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{(z - box.first[2]) / kCubeEdge} * count[1] + (y - box.first[1]) / kCubeEdge) * count[0] +
           (x - box.first[0]) / kCubeEdge;
  }
};

}  // namespace gs::qnv::values
