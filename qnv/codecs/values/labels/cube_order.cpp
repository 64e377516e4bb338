#include "qnv/codecs/values/labels/cube_order.h"

#include "qnv/codecs/values/cube_runs.h"

#include <algorithm>
#include <bit>

namespace gs::qnv::values {

CubeOrder::CubeOrder(Extent extent) : cubes_(cube_extent(extent)) {
  for (std::size_t a = 0; a < 3; ++a) {
    bits_[a] = static_cast<int>(std::bit_width(cubes_[a] - 1));
    spread_[a].assign(cubes_[a], 0);
  }
  int at = 0;
  for (int bit = 0; bit < std::max({bits_[0], bits_[1], bits_[2]}); ++bit)
    for (std::size_t a = 0; a < 3; ++a) {
      if (bit >= bits_[a]) continue;
      for (std::uint32_t i = 0; i < cubes_[a]; ++i) spread_[a][i] |= std::uint64_t{i >> bit & 1} << at;
      ++at;
    }
}

Extent CubeOrder::place(std::uint64_t code) const {
  Extent cube{};
  for (int bit = 0; code != 0; ++bit)
    for (std::size_t a = 0; a < 3; ++a) {
      if (bit >= bits_[a]) continue;
      cube[a] |= static_cast<std::uint32_t>(code & 1) << bit;
      code >>= 1;
    }
  return cube;
}

int CubeOrder::bits_below(int bits) const {
  int sum = 0;
  for (const int all : bits_) sum += std::min(all, bits);
  return sum;
}

}  // namespace gs::qnv::values
