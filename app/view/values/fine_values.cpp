#include "app/view/values/fine_values.h"

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

// Voxels of the grid per sample of a finer part: a power of two.
std::uint32_t fineness(const qnv::ValueBrick& brick, std::size_t axis) {
  return static_cast<std::uint32_t>(std::lround(1 / brick.steps[axis]));
}

}  // namespace

FineValues::FineValues(const VolumeGrid& grid, std::uint32_t factor) : grid_(grid) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (grid.kept(a) > 1) factors_[a] = factor;
    size_[a] = grid.kept(a) * factors_[a];
  }
}

std::uint32_t FineValues::factor_for(const VolumeGrid& grid, std::size_t most, int without) {
  // The parts refer to all voxels.
  if (grid.step() != 1) return 1;
  std::uint32_t finest = 1;
  for (const qnv::ValueBrick& brick : grid.bricks())
    for (std::size_t a = 0; a < 3; ++a) finest = std::max(finest, fineness(brick, a));
  std::uint32_t factor = 1;
  const auto samples = [&](std::uint32_t of) {
    const FineValues fine(grid, of);
    double count = 1;
    for (int a = 0; a < 3; ++a)
      if (a != without) count *= fine.size()[static_cast<std::size_t>(a)];
    return count;
  };
  while (factor < finest && samples(2 * factor) <= static_cast<double>(most)) factor *= 2;
  return factor;
}

void FineValues::read(const std::array<std::uint32_t, 3>& first, const std::array<std::uint32_t, 3>& count,
                      std::vector<float>& values) const {
  values.resize(std::size_t{count[0]} * count[1] * count[2]);
  // Indices of the nearest stored voxels.
  std::array<std::vector<std::uint32_t>, 3> at;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::uint32_t i = 0; i < count[a]; ++i)
      at[a].push_back(std::min((first[a] + i + factors_[a] / 2) / factors_[a], grid_.kept(a) - 1));
  float* to = values.data();
  for (const std::uint32_t z : at[2])
    for (const std::uint32_t y : at[1])
      for (const std::uint32_t x : at[0]) *to++ = grid_.kept_value(x, y, z);
  if (grid_.step() != 1) return;
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  // The coarsest parts come first, so that finer ones replace them.
  for (auto brick = grid_.bricks().rbegin(); brick != grid_.bricks().rend(); ++brick) {
    bool inside = true;
    for (std::size_t a = 0; inside && a < 3; ++a) {
      const std::uint32_t fine = fineness(*brick, a);
      at[a].assign(count[a], kNone);
      inside = false;
      for (std::uint32_t i = 0; i < count[a]; ++i) {
        const std::uint64_t place = (std::uint64_t{first[a]} + i) * fine / factors_[a];
        if (place < brick->core_first[a] || place >= std::uint64_t{brick->core_first[a]} + brick->core_size[a])
          continue;
        at[a][i] = static_cast<std::uint32_t>(place);
        inside = true;
      }
    }
    if (!inside) continue;
    for (std::size_t z = 0; z < count[2]; ++z)
      for (std::size_t y = 0; y < count[1]; ++y) {
        if (at[2][z] == kNone || at[1][y] == kNone) continue;
        float* const row = values.data() + (z * count[1] + y) * count[0];
        for (std::size_t x = 0; x < count[0]; ++x)
          if (at[0][x] != kNone) row[x] = brick->value(at[0][x], at[1][y], at[2][z]);
      }
  }
}

}  // namespace gs::app
