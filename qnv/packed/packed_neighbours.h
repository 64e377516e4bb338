#pragma once

#include "qnv/packed/packed_layout.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

// Where a surface goes on, its planes say beforehand: what children are predicted from besides their parent, its
// neighbours in the parent's cluster. All of them are there when the cluster can be decoded at all. FORMAT.md,
// "Neighbours".

/// Neighbours share a block of so many voxels an axis.
constexpr int kNeighbourBlock = 32;
/// Normals that differ by more than this belong to two surfaces, or to both sides of an edge.
constexpr int kLargestTurn = 700;
/// A plane in 32 bits, so that one load tells all: u + 1024 (12 bits), v + 1024 (12), offset + 32 (7), kThere. 0: none,
/// or one of a double voxel, of which chance decides what side it names.
constexpr std::uint32_t kThere = 0x80000000;

/// The planes of the voxels of one block, and of nothing all around it, so that no neighbour needs a question of its
/// own.
struct PlaneBlock {
  static constexpr std::size_t kStrideY = kNeighbourBlock + 2, kStrideZ = kStrideY * kStrideY,
                               kSize = kStrideZ * kStrideY;
  const std::uint32_t* planes = nullptr;  // by place
  const std::uint16_t* places = nullptr;  // of the voxels of a run
  /// Across the faces -x, +x, -y, +y, -z, +z, and that of the voxel itself.
  [[nodiscard]] std::array<std::uint32_t, 7> around(std::size_t voxel) const {
    const std::uint32_t* const at = planes + places[voxel];
    return {at[-1], at[1], *(at - kStrideY), at[kStrideY], *(at - kStrideZ), at[kStrideZ], at[0]};
  }
};

/// Fills blocks of planes one after the other.
class PlaneBlocks {
 public:
  /// Of voxels `first` to `first + count` those that share the first one's block: their number, 1 at least where count
  /// is. Time proportional to the voxels of the block.
  std::size_t fill(const PackedVoxels& from, std::size_t first, std::size_t count);
  [[nodiscard]] PlaneBlock block() const { return {planes_.data(), places_.data() + before_}; }

 private:
  std::vector<std::uint32_t> planes_ = std::vector<std::uint32_t>(PlaneBlock::kSize);
  std::vector<std::uint16_t> places_;  // of what is filled
  std::size_t before_ = 0;             // of these, how many are not asked for
};
/// That of this thread: 160 kB that need not be cleared again for each cluster.
[[nodiscard]] PlaneBlocks& plane_blocks();

/// What the neighbours of one voxel change in the predictions for its children, by the face that a child touches.
struct FaceChanges {
  std::array<int, 6> u{}, v{};  // in 1/16
  std::array<int, 6> offset{};  // in 1/4
};
[[nodiscard]] FaceChanges face_changes(int u, int v, int offset, const std::array<std::uint32_t, 7>& around);

struct PredictedPlane {
  int u, v, offset;
};

/// The plane that is expected of child `c` of a voxel: its normal and offset each from the neighbours too, or not.
inline PredictedPlane predicted_plane(int u, int v, int offset, const FaceChanges& changes, unsigned c, bool normals,
                                      bool offsets) {
  const unsigned x = c & 1, y = 2 + (c >> 1 & 1), z = 4 + (c >> 2);
  PredictedPlane plane{u, v, 0};
  if (normals) {
    plane.u += (changes.u[x] + changes.u[y] + changes.u[z] + 8) >> 4;
    plane.v += (changes.v[x] + changes.v[y] + changes.v[z] + 8) >> 4;
    wrap_octahedral(plane.u, plane.v);
  }
  if (!offsets) {
    plane.offset = predicted_offset(along(octahedral_normal(u, v), c), offset);
    return plane;
  }
  const int distance = along(octahedral_normal(plane.u, plane.v), c);
  plane.offset = clamp_offset(2 * offset - ((distance * (kOffsetUnits / 2) + kOctahedral / 2) >> 10) +
                              ((changes.offset[x] + changes.offset[y] + changes.offset[z] + 2) >> 2));
  return plane;
}

}  // namespace gs::qnv
