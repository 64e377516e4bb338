#include "qnv/codecs/voxels/encode/visibility.h"

#include "base/parallel.h"
#include "qnv/base/morton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace gs::qnv {
namespace {

constexpr int kGridLevel = 6;  // level of the grid: 64 cells per axis
constexpr float kMinSeen = 0.04f;  // minimum of TrueVoxel::seen; users may clip the volume to look inside
constexpr int kDirections = 26;

using Grid = std::vector<float>;

// Returns one of the 26 directions to adjacent cells, by index.
std::array<int, 3> direction_of(std::size_t number) {
  const int n = static_cast<int>(number) + (number >= 13 ? 1 : 0);
  return {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
}

// Returns for each cell the light that reaches it from outside along one direction.
Grid light_along(const Grid& clear, int size, const std::array<int, 3>& d) {
  Grid light(clear.size(), 1.0f);
  const auto at = [&](int x, int y, int z) { return static_cast<std::size_t>((z * size + y) * size + x); };
  const auto order = [&](int axis, int i) { return d[static_cast<unsigned>(axis)] < 0 ? size - 1 - i : i; };
  for (int k = 0; k < size; ++k)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        const int x = order(0, i), y = order(1, j), z = order(2, k);
        const int px = x - d[0], py = y - d[1], pz = z - d[2];
        if (px < 0 || py < 0 || pz < 0 || px >= size || py >= size || pz >= size) continue;
        light[at(x, y, z)] = light[at(px, py, pz)] * clear[at(px, py, pz)];
      }
  return light;
}

}  // namespace

void find_seen(std::span<TrueVoxel> voxels, const VoxelLattice& lattice, std::span<const float> depth_of_class,
               unsigned threads) {
  const int level = std::min<int>(lattice.depth, kGridLevel), size = 1 << level;
  const int shift = lattice.depth - level;
  const auto cell_of = [&](const TrueVoxel& voxel) {
    const auto [x, y, z] = morton_decode(voxel.key >> (3 * shift));
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size) + y) * static_cast<std::size_t>(size) + x;
  };
  Grid clear(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const float face = std::ldexp(1.0f, -2 * shift);  // fraction of a cell face that one vector covers
  for (const TrueVoxel& voxel : voxels) {
    const auto value = static_cast<std::size_t>(voxel.value + 0.5f);
    clear[cell_of(voxel)] += face * depth_of_class[std::min(value, depth_of_class.size() - 1)];
  }
  for (float& depth : clear) depth = std::exp(-depth);
  std::array<Grid, kDirections> light;
  parallel_for(
      kDirections, [&](std::size_t i) { light[i] = light_along(clear, size, direction_of(i)); }, threads);
  // A surface receives light from half of all directions.
  for (TrueVoxel& voxel : voxels) {
    const std::size_t cell = cell_of(voxel);
    float sum = 0;
    for (const Grid& one : light) sum += one[cell];
    voxel.seen = std::clamp(sum * 2 / kDirections, kMinSeen, 1.0f);
  }
}

}  // namespace gs::qnv
