#pragma once

#include "base/noncopyable.h"
#include "base/parallel.h"
#include "qnv/base/description.h"
#include "qnv/base/fixed_sum.h"
#include "qnv/base/triangles.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// Cube that an octree divides. Level 0 is the whole cube; level L has 2^L voxels along an edge.
struct Cube {
  glm::vec3 lower{0};
  float edge = 1;  // units of the source

  /// Returns a cube centred on `box` and slightly larger, so that no point of the box is on a face of the cube.
  static Cube around(const Box& box);
};
constexpr int kDeepestLevel = 16;

/// Integrals over the part of a surface inside one voxel. Lengths are in voxel edges; positions are relative to the
/// voxel's centre.
struct SurfaceMoments {
  float area = 0;
  glm::vec3 position{0};          // integral of the position
  glm::vec3 normal{0};            // integral of the unit shading normal
  glm::vec3 color{0};             // integral of the colour, 0..255
  std::array<float, 6> spread{};  // integral of n n^T, where n is the face normal; order xx xy xz yy yz zz

  void add(const SurfaceMoments& other);
};

struct Voxel {
  std::uint64_t key = 0;  // Morton code at the voxel's level
  SurfaceMoments moments;
};

/// Moments of a voxel as sums. They do not depend on the order of triangles, nor on their division into processes.
struct MomentSums {
  using Sum = FixedSum<40>;  // range: areas of 2^23 full faces
  Sum area;
  std::array<Sum, 3> position, normal;
  std::array<FixedSum<28>, 3> color;
  std::array<Sum, 6> spread;

  void add(const MomentSums& other);
  [[nodiscard]] SurfaceMoments moments() const;
};

/// Voxel with the sums of a part of a surface.
struct VoxelSums {
  std::uint64_t key = 0;  // Morton code at the voxel's level
  MomentSums sums;

  [[nodiscard]] std::uint64_t hash() const { return key * 0x9e3779b97f4a7c15ULL >> 20; }
  void add(const VoxelSums& other) { sums.add(other.sums); }
};

/// Returns the lower corner of a voxel, in voxel edges from the cube's lower corner.
[[nodiscard]] glm::vec3 voxel_cell(std::uint64_t key);

/// Integrates triangles over the voxels of one level. Clips triangles exactly at voxel faces, so that no area is lost
/// or counted twice. Memory grows with the number of voxels that the surface intersects, not with the number of
/// triangles. The result is the same, bit by bit, for any number of threads and any order of triangles.
class SurfaceVoxelizer : NonCopyable {
 public:
  /// Creates a voxelizer; `level` is 1 to kDeepestLevel.
  SurfaceVoxelizer(const Cube& cube, int level, unsigned threads = 0);
  ~SurfaceVoxelizer();

  /// Adds triangles. Skips a triangle if a corner is not finite or is outside the cube.
  void add(std::span<const Triangle> triangles);
  /// Returns the voxels that contain parts of the surface, by ascending key. Call it once, at the end.
  [[nodiscard]] std::vector<VoxelSums> sums();
  /// Returns the moments of sums(). Call either function, only once.
  [[nodiscard]] std::vector<Voxel> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the voxels with these sums, in order. Omits a voxel if its area is too small for the precision of the sums.
[[nodiscard]] std::vector<Voxel> voxels_of(std::span<const VoxelSums> sums);

/// Returns the voxels of the next coarser level.
[[nodiscard]] std::vector<Voxel> coarsen(std::span<const Voxel> voxels);

}  // namespace gs::qnv
