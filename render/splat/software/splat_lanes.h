#pragma once

#include <array>
#include <cstdint>

namespace gs::render {

/// Indexes of the set bits in a byte, by the byte.
inline constexpr std::array<std::array<std::uint8_t, 8>, 256> kPackings = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (unsigned lanes = 0; lanes < 256; ++lanes)
    for (std::uint8_t lane = 0, next = 0; lane < 8; ++lane)
      if (lanes >> lane & 1u) table[lanes][next++] = lane;
  return table;
}();

}  // namespace gs::render
