#pragma once

#include "qnv/codecs/octree/packed_layout.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

// Prediction of children from neighbouring planes, where a surface continues. The neighbours are in the parent's
// cluster, so all of them are available when the cluster is decoded. FORMAT.md, "Neighbours".

/// Edge of a neighbour block in voxels; only voxels of the same block are neighbours.
constexpr int kNeighbourBlock = 32;
/// Maximum normal difference of neighbours. Larger differences mean two surfaces, or two sides of an edge.
constexpr int kLargestTurn = 700;
/// Plane in 32 bits, for single loads: u + 1024 (12 bits), v + 1024 (12), offset + 32 (7), kThere. 0 means no voxel, or
/// a double one, which has no definite side.
constexpr std::uint32_t kThere = 0x80000000;

/// Planes of the voxels of one block, with an empty border, so that neighbour lookups need no bounds check.
struct PlaneBlock {
  static constexpr std::size_t kStrideY = kNeighbourBlock + 2, kStrideZ = kStrideY * kStrideY,
                               kSize = kStrideZ * kStrideY;
  const std::uint32_t* planes = nullptr;  // by index in the block
  const std::uint16_t* places = nullptr;  // block indices of the voxels of a run
  /// Returns the planes across the faces -x, +x, -y, +y, -z, +z, then the voxel's own plane.
  [[nodiscard]] std::array<std::uint32_t, 7> around(std::size_t voxel) const {
    const std::uint32_t* const at = planes + places[voxel];
    return {at[-1], at[1], *(at - kStrideY), at[kStrideY], *(at - kStrideZ), at[kStrideZ], at[0]};
  }
};

/// Fills blocks of planes one after another.
class PlaneBlocks {
 public:
  /// Fills the block of voxel `first`, and returns the number of voxels from `first` on that lie in it: at most
  /// `count`, and at least 1 if count > 0. Runs in time proportional to the block's voxels.
  std::size_t fill(const PackedVoxels& from, std::size_t first, std::size_t count);
  [[nodiscard]] PlaneBlock block() const { return {planes_.data(), places_.data() + before_}; }

 private:
  std::vector<std::uint32_t> planes_ = std::vector<std::uint32_t>(PlaneBlock::kSize);
  std::vector<std::uint16_t> places_;  // block indices of all filled voxels
  std::size_t before_ = 0;             // filled voxels before the requested ones
};
/// Returns the calling thread's PlaneBlocks: 160 kB that need no clearing per cluster.
[[nodiscard]] PlaneBlocks& plane_blocks();

/// Changes to the predictions for a voxel's children, for each face that a child touches.
struct FaceChanges {
  std::array<int, 6> u{}, v{};  // in 1/16
  std::array<int, 6> offset{};  // in 1/4
};
[[nodiscard]] FaceChanges face_changes(int u, int v, int offset, const std::array<std::uint32_t, 7>& around);

struct PredictedPlane {
  int u, v, offset;
};

/// Returns the predicted plane of child `c` of a voxel. `normals` and `offsets` select prediction from neighbours.
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
