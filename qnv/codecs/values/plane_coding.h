#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/plane_models.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace gs::qnv::values {

// Decisions about the coefficients of one cube in one plane (FORMAT.md, "Values payload"). Encoder and decoder share
// the code. Coefficients are magnitudes with their sign in the highest bit.

inline constexpr std::uint32_t kSign = std::uint32_t{1} << 31;
/// Maximum size of a coefficient in units of the plane, as a neighbour.
inline constexpr std::uint32_t kMaxSize = 4;

/// Context of a coefficient that is zero so far, by the sum of its neighbours' sizes.
inline constexpr std::array<std::uint8_t, 128> kContexts = [] {
  std::array<std::uint8_t, 128> contexts{};
  constexpr std::array<int, 16> kFirst{0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 19, 24, 32, 42};
  for (int sum = 0; sum < 128; ++sum) {
    std::uint8_t context = 0;
    while (context < 15 && sum >= kFirst[context + 1u]) ++context;
    contexts[static_cast<std::size_t>(sum)] = context;
  }
  return contexts;
}();

/// Encoder's side of a cube.
struct EncodingSide {
  RangeWriter coder;
  const std::uint32_t* values = nullptr;  // of the cube
  int plane = 0;

  bool code(Estimate& model, bool bit) {
    coder.put(model.probability(), bit);
    model.learn(bit);
    return bit;
  }
  [[nodiscard]] bool bit(std::size_t i) const { return (values[i] >> plane & 1) != 0; }
  /// Reports whether any of four coefficients that are zero so far gets its first bit.
  [[nodiscard]] bool any(std::size_t i) const {
    return ((values[i] | values[i + 1] | values[i + 2] | values[i + 3]) & ~kSign) >> plane != 0;
  }
  void start(std::size_t i) { coder.put_bit(values[i] >> 31 != 0); }
  bool code_bit(bool bit) {
    coder.put_bit(bit);
    return bit;
  }
  void add(std::size_t) {}
};

/// Decoder's side of a cube.
struct DecodingSide {
  RangeReader coder;
  std::uint32_t* values = nullptr;  // of the cube, with the bits known so far
  int plane = 0;

  bool code(Estimate& model, bool) {
    const bool bit = coder.get(model.probability());
    model.learn(bit);
    return bit;
  }
  [[nodiscard]] bool bit(std::size_t) const { return false; }
  [[nodiscard]] bool any(std::size_t) const { return false; }
  void start(std::size_t i) { values[i] = 1u << plane | coder.get_bit() << 31; }
  bool code_bit(bool) { return coder.get_bit() != 0; }
  void add(std::size_t i) { values[i] |= 1u << plane; }
};

/// Codes a line of at most 4 coefficients from `at` on. `sizes` and `sums` have a byte per coefficient: its size, and
/// the sum of its neighbours' sizes. Returns the growth of the sizes.
template <bool whole, class Side>
inline std::uint32_t code_line(Side& side, PlaneModels& models, std::uint32_t highs, std::size_t at, std::uint32_t count,
                               std::uint32_t sizes, std::uint32_t sums) {
  // A line of zeros without neighbours takes one decision.
  std::uint32_t known_one = kCubeEdge;
  if ((whole || count == kCubeEdge) && (sums | sizes) == 0) {
    if (!side.code(models.lines.data()[highs], side.any(at))) return 0;
    known_one = kCubeEdge - 1;
  }
  Estimate* const ones = models.ones.data()[highs].data();
  std::uint32_t growth = 0;
  for (std::uint32_t x = 0; x < (whole ? kCubeEdge : count); ++x, sizes >>= 8, sums >>= 8) {
    const std::uint32_t size = sizes & 255, sum = sums & 255;
    const bool one = side.bit(at + x);
    if (size == 0) {
      if (x == known_one || side.code(ones[kContexts.data()[sum]], one)) {
        side.start(at + x);
        growth |= 1u << 8 * x;
        known_one = kCubeEdge;
        sums += 2u << 8;
      }
    } else if (size == 2 ? side.code(models.more.data()[sum < 32 ? sum >> 3 : 3], one) : side.code_bit(one)) {
      // Only the first bit after the highest one is worth an estimate.
      side.add(at + x);
      if (size < kMaxSize) {
        growth |= 1u << 8 * x;
        sums += 2u << 8;
      }
    }
  }
  return growth;
}

inline std::uint64_t eight_bytes(const std::uint8_t* at) {
  std::uint64_t bytes;
  std::memcpy(&bytes, at, 8);
  if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
  return bytes;
}

/// Sizes of the coefficients of a cube in the buffer of their block.
struct CubeSizes {
  std::uint8_t* first = nullptr;  // of the first coefficient
  std::uint32_t row = 0, slice = 0;
  std::array<std::uint8_t, 3> size{};
};

/// Codes one plane of a cube.
template <bool whole, class Side>
void code_cube(Side& outer, PlaneModels& models, std::uint32_t highs, const CubeSizes& cube) {
  Side side = outer;  // a local copy stays in registers
  // Each number has the sizes of a row: that before the line, those of the line, that after it.
  constexpr std::size_t kRows = kCubeEdge + 2;
  std::uint64_t before[kRows], here[kRows], after[kRows], around[kRows];
  const std::uint8_t* from = cube.first - 1 - cube.row - cube.slice;
  for (std::size_t y = 0; y < kRows; ++y) {
    before[y] = eight_bytes(from + y * cube.row);
    here[y] = eight_bytes(from + cube.slice + y * cube.row);
  }
  from += 2 * cube.slice;
  for (std::uint32_t z = 0; z < (whole ? kCubeEdge : cube.size[2]); ++z, from += cube.slice) {
    for (std::size_t y = 0; y < kRows; ++y) {
      after[y] = eight_bytes(from + y * cube.row);
      around[y] = before[y] + after[y];
    }
    for (std::uint32_t y = 0; y < (whole ? kCubeEdge : cube.size[1]); ++y) {
      // Faces count twice, edges once.
      const std::uint64_t own = here[y + 1], faces = here[y] + here[y + 2] + around[y + 1],
                          edges = around[y] + around[y + 2];
      const std::uint64_t sums = faces + ((2 * faces + edges) >> 8) + (faces >> 16) + 2 * (own + (own >> 16));
      const std::uint32_t growth =
          code_line<whole>(side, models, highs, (z * kCubeEdge + y) * kCubeEdge, cube.size[0],
                           static_cast<std::uint32_t>(own >> 8), static_cast<std::uint32_t>(sums));
      here[y + 1] = own + (std::uint64_t{growth} << 8);
    }
    for (std::size_t y = 1; y <= kCubeEdge; ++y) {
      std::uint32_t sizes = static_cast<std::uint32_t>(here[y] >> 8);
      if constexpr (std::endian::native == std::endian::big) sizes = __builtin_bswap32(sizes);
      std::memcpy(cube.first + z * cube.slice + (y - 1) * cube.row, &sizes, sizeof sizes);
    }
    for (std::size_t y = 0; y < kRows; ++y) {
      before[y] = here[y];
      here[y] = after[y];
    }
  }
  outer = side;
}

}  // namespace gs::qnv::values
