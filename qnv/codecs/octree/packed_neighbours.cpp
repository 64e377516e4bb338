#include "qnv/codecs/octree/packed_neighbours.h"

#include <algorithm>
#include <cstdlib>

namespace gs::qnv {
std::size_t PlaneBlocks::fill(const PackedVoxels& from, std::size_t first, std::size_t count) {
  // Clears only the entries written before, which is cheaper than clearing the whole block.
  for (const std::uint16_t place : places_) planes_[place] = 0;
  places_.clear();
  const unsigned bx = from.x[first], by = from.y[first], bz = from.z[first];
  const auto inside = [&](std::size_t i) {
    return ((from.x[i] ^ bx) | (from.y[i] ^ by) | (from.z[i] ^ bz)) < static_cast<unsigned>(kNeighbourBlock);
  };
  // The voxels of a block are one run, because voxels are in Morton order.
  std::size_t begin = first, end = first + 1;
  while (begin > 0 && inside(begin - 1)) --begin;
  while (end < from.size() && inside(end)) ++end;
  before_ = first - begin;
  places_.resize(end - begin);
  constexpr unsigned kInside = kNeighbourBlock - 1;
  constexpr auto kY = static_cast<unsigned>(PlaneBlock::kStrideY), kZ = static_cast<unsigned>(PlaneBlock::kStrideZ);
  std::uint32_t* const planes = planes_.data();
  std::uint16_t* const places = places_.data();
  for (std::size_t i = begin; i < end; ++i) {
    const unsigned place =
        ((from.z[i] & kInside) + 1) * kZ + ((from.y[i] & kInside) + 1) * kY + (from.x[i] & kInside) + 1;
    const std::uint32_t plane = static_cast<std::uint32_t>(from.u[i] + kOctahedral) |
                                static_cast<std::uint32_t>(from.v[i] + kOctahedral) << 12 |
                                static_cast<std::uint32_t>(from.offset[i] + kOffsetUnits / 2) << 24 | kThere;
    places[i - begin] = static_cast<std::uint16_t>(place);
    planes[place] = (from.state[i] & kDouble) != 0 ? 0 : plane;
  }
  return std::min(end - first, count);
}

PlaneBlocks& plane_blocks() {
  thread_local PlaneBlocks blocks;
  return blocks;
}

FaceChanges face_changes(int u, int v, int offset, const std::array<std::uint32_t, 7>& around) {
  FaceChanges changes;
  if (around[6] == 0) return changes;  // a two-sided sheet is predicted from itself alone
  std::array<int, 6> du{}, dv{};
  for (std::size_t face = 0; face < 6; ++face) {
    if ((around[face] & kThere) == 0) continue;
    const int nu = static_cast<int>(around[face] & 0xfff) - kOctahedral,
              nv = static_cast<int>(around[face] >> 12 & 0xfff) - kOctahedral,
              no = static_cast<int>(around[face] >> 24 & 0x7f) - kOffsetUnits / 2;
    // The octahedral square wraps at its edges. Uses the image of the neighbour's normal that is nearest.
    const int su = (nu < 0 ? -2 : 2) * kOctahedral - nu, sv = (nv < 0 ? -2 : 2) * kOctahedral - nv;
    const std::array<std::array<int, 2>, 3> images{{{nu - u, nv - v}, {su - u, -nv - v}, {-nu - u, sv - v}}};
    int least = kLargestTurn + 1;
    for (const auto& [a, b] : images) {
      if (std::abs(a) + std::abs(b) >= least) continue;
      least = std::abs(a) + std::abs(b);
      du[face] = a;
      dv[face] = b;
    }
    if (least > kLargestTurn) continue;
    const int towards = octahedral_normal(nu, nv)[face / 2] * ((face & 1) != 0 ? 1 : -1);
    changes.offset[face] = 2 * (no - offset) + (towards >> 3);
  }
  for (std::size_t face = 0; face < 6; ++face) {
    changes.u[face] = 3 * du[face] - du[face ^ 1];
    changes.v[face] = 3 * dv[face] - dv[face ^ 1];
  }
  return changes;
}

}  // namespace gs::qnv
