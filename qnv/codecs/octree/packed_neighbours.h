#pragma once

#include "qnv/codecs/octree/packed_layout.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

// Prediction of children from the planes of neighbouring voxels, where a surface continues. The neighbours belong to
// the parent's cluster, so they are always available when a cluster is decoded. FORMAT.md, "Neighbours".

/// Edge of a neighbour block, in voxels. Two voxels are neighbours only inside the same block.
constexpr int kNeighbourBlock = 32;
/// Maximum difference of normals, in octahedral units, between neighbours on one surface. A larger difference means two
/// surfaces or a sharp edge.
constexpr int kLargestTurn = 700;
/// Highest bit of a packed plane; it is set if there is a plane. A packed plane has 32 bits, which one instruction
/// loads: u + 1024 (12 bits), v + 1024 (12), offset + 32 (7), and this bit. The value 0 means no voxel, or a two-sided
/// sheet.
constexpr std::uint32_t kThere = 0x80000000;

/// Planes of the voxels of one block. An empty border replaces bounds checks in neighbour lookups.
struct PlaneBlock {
  static constexpr std::size_t kStrideY = kNeighbourBlock + 2, kStrideZ = kStrideY * kStrideY,
                               kSize = kStrideZ * kStrideY;
  const std::uint32_t* planes = nullptr;  // planes by index in the block
  const std::uint16_t* places = nullptr;  // indices in the block, for a run of voxels
  /// Returns the planes of the neighbours at the faces -x, +x, -y, +y, -z, +z, then the voxel's own plane.
  [[nodiscard]] std::array<std::uint32_t, 7> around(std::size_t voxel) const {
    const std::uint32_t* const at = planes + places[voxel];
    return {at[-1], at[1], *(at - kStrideY), at[kStrideY], *(at - kStrideZ), at[kStrideZ], at[0]};
  }
};

/// Buffer that holds one block of planes at a time.
class PlaneBlocks {
 public:
  /// Fills the buffer with the block that contains voxel `first`. Returns the number of voxels from `first` on in that
  /// block, at most `count`; at least 1 if count > 0. Time is proportional to the number of voxels in the block.
  std::size_t fill(const PackedVoxels& from, std::size_t first, std::size_t count);
  [[nodiscard]] PlaneBlock block() const { return {planes_.data(), places_.data() + before_}; }

 private:
  std::vector<std::uint32_t> planes_ = std::vector<std::uint32_t>(PlaneBlock::kSize);
  std::vector<std::uint16_t> places_;  // index in the block of each filled voxel
  std::size_t before_ = 0;  // number of filled voxels before voxel `first`
};
/// Returns the PlaneBlocks of the calling thread. They hold 160 kB, which need not be cleared for each cluster.
[[nodiscard]] PlaneBlocks& plane_blocks();

/// Changes of the predictions for a voxel's children. A child adds the changes of the three faces that it touches.
struct FaceChanges {
  std::array<int, 6> u{}, v{};  // in 1/16 of an octahedral unit
  std::array<int, 6> offset{};  // in 1/4 of an offset unit
};
[[nodiscard]] FaceChanges face_changes(int u, int v, int offset, const std::array<std::uint32_t, 7>& around);

struct PredictedPlane {
  int u, v, offset;
};

/// Returns the predicted plane of child `c` of a voxel. `normals` and `offsets` select what neighbours help to predict.
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
