#include "qnv/codecs/values/plane_coding.h"

#include <bit>
#include <cstring>
#include <utility>

namespace gs::qnv::values {

namespace {

// Context of a coefficient that is zero so far, by the sum of its neighbours' sizes.
constexpr std::array<std::uint8_t, 128> kContexts = [] {
  std::array<std::uint8_t, 128> contexts{};
  constexpr std::array<int, 16> kFirst{0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 19, 24, 32, 42};
  for (int sum = 0; sum < 128; ++sum) {
    std::uint8_t context = 0;
    while (context < 15 && sum >= kFirst[context + 1u]) ++context;
    contexts[static_cast<std::size_t>(sum)] = context;
  }
  return contexts;
}();

/// Line of at most 4 coefficients. Numbers with a byte per coefficient: its size, the sum of its neighbours' sizes, and
/// the growth of its size.
struct Line {
  std::uint32_t sizes = 0, sums = 0, growth = 0;
};

template <bool whole, class Side>
inline void code_line(Side& side, Estimate* ones, PlaneModels& models, std::uint32_t highs, std::size_t at,
                      std::uint32_t count, Line& line) {
  // A line of zeros without neighbours takes one decision.
  std::uint32_t known_one = kCubeEdge;
  if ((whole || count == kCubeEdge) && (line.sums | line.sizes) == 0) {
    if (!side.code(models.lines.data()[highs], side.any(at))) return;
    known_one = kCubeEdge - 1;
  }
  const auto code = [&]<std::uint32_t x>(std::integral_constant<std::uint32_t, x>) {
    if (!whole && x >= count) return;
    const std::uint32_t size = line.sizes >> 8 * x & 255, sum = line.sums >> 8 * x & 255;
    constexpr std::uint32_t kNext = x < 3 ? 2u << 8 * (x + 1) % 32 : 0;
    const bool one = side.bit(at + x);
    if (size == 0) {
      if ((x == 3 && known_one == 3) || side.code(ones[kContexts.data()[sum]], one)) {
        side.start(at + x);
        line.growth |= 1u << 8 * x;
        line.sums += kNext;
        known_one = kCubeEdge;
      }
    } else if (size == 2) {
      // Only the first bit after the highest one is worth an estimate. It makes the size 3.
      const std::uint32_t bit = side.code_even(models.more.data()[sum < 32 ? sum >> 3 : 3], one);
      side.add(at + x, bit);
      line.growth |= bit << 8 * x;
      line.sums += bit * kNext;
    } else {
      side.add(at + x, side.code_bit(one));
    }
  };
  [&]<std::uint32_t... x>(std::integer_sequence<std::uint32_t, x...>) {
    (code(std::integral_constant<std::uint32_t, x>()), ...);
  }
  (std::make_integer_sequence<std::uint32_t, kCubeEdge>());
}

std::uint64_t eight_bytes(const std::uint8_t* at) {
  std::uint64_t bytes;
  std::memcpy(&bytes, at, 8);
  if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
  return bytes;
}

template <bool whole, class Side>
void code_planes(Side& outer, PlaneModels& models, std::uint32_t highs, const CubeSizes& cube) {
  Side side = outer;  // a local copy stays in registers
  Estimate* const ones = models.ones.data()[highs].data();
  // Each number has the sizes of a row: that before the line, those of the line, that after it.
  constexpr std::size_t kRows = kCubeEdge + 2;
  std::uint64_t before[kRows], here[kRows], after[kRows], around[kRows];
  const std::uint32_t row = cube.row, slice = cube.slice;
  const std::uint8_t* from = cube.first - 1 - row - slice;
  for (std::size_t y = 0; y < kRows; ++y) {
    before[y] = eight_bytes(from + y * row);
    here[y] = eight_bytes(from + slice + y * row);
  }
  from += 2 * slice;
  std::uint8_t* to = cube.first;
  for (std::uint32_t z = 0; z < (whole ? kCubeEdge : cube.size[2]); ++z, from += slice, to += slice) {
    for (std::size_t y = 0; y < kRows; ++y) {
      after[y] = eight_bytes(from + y * row);
      around[y] = before[y] + after[y];
    }
    for (std::uint32_t y = 0; y < (whole ? kCubeEdge : cube.size[1]); ++y) {
      // Faces count twice, edges once.
      const std::uint64_t own = here[y + 1], faces = here[y] + here[y + 2] + around[y + 1],
                          edges = around[y] + around[y + 2];
      const std::uint64_t sums = faces + ((2 * faces + edges) >> 8) + (faces >> 16) + 2 * (own + (own >> 16));
      Line line{static_cast<std::uint32_t>(own >> 8), static_cast<std::uint32_t>(sums)};
      code_line<whole>(side, ones, models, highs, (z * kCubeEdge + y) * kCubeEdge, cube.size[0], line);
      here[y + 1] = own + (std::uint64_t{line.growth} << 8);
    }
    for (std::size_t y = 0; y < kCubeEdge; ++y) {
      std::uint32_t sizes = static_cast<std::uint32_t>(here[y + 1] >> 8);
      if constexpr (std::endian::native == std::endian::big) sizes = __builtin_bswap32(sizes);
      std::memcpy(to + y * row, &sizes, sizeof sizes);
    }
    for (std::size_t y = 0; y < kRows; ++y) {
      before[y] = here[y];
      here[y] = after[y];
    }
  }
  outer = side;
}

template <class Side>
void code_any(Side& side, PlaneModels& models, std::uint32_t highs, const CubeSizes& cube) {
  constexpr std::array<std::uint8_t, 3> kWhole{kCubeEdge, kCubeEdge, kCubeEdge};
  if (cube.size == kWhole)
    code_planes<true>(side, models, highs, cube);
  else
    code_planes<false>(side, models, highs, cube);
}

}  // namespace

void code_cube(EncodingSide& side, PlaneModels& models, std::uint32_t highs, const CubeSizes& cube) {
  code_any(side, models, highs, cube);
}
void code_cube(DecodingSide& side, PlaneModels& models, std::uint32_t highs, const CubeSizes& cube) {
  code_any(side, models, highs, cube);
}

}  // namespace gs::qnv::values
