#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/parallel.h"
#include "qnv/base/triangles.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// The cube that an octree divides: level 0 is the whole, level L has 2^L voxels along an edge.
struct Cube {
  glm::vec3 lower{0};
  float edge = 1;  // units of the source

  /// The smallest cube around a box, centred on it, a little larger so that nothing lies on its faces.
  static Cube around(const Box& box);
};
constexpr int kDeepestLevel = 16;

/// Integrals over the part of a surface inside one voxel. Lengths are in voxel edges, positions from the
/// centre of the voxel.
struct SurfaceMoments {
  float area = 0;
  glm::vec3 position{0};          // integral of the position
  glm::vec3 normal{0};            // of the unit shading normal
  glm::vec3 color{0};             // of the colour, 0..255
  std::array<float, 6> spread{};  // of n n^T with the face's normal n: xx xy xz yy yz zz

  void add(const SurfaceMoments& other);
};

struct Voxel {
  std::uint64_t key = 0;  // Morton code at the level
  SurfaceMoments moments;
};

/// Lower corner of a voxel in voxels from the cube's.
[[nodiscard]] glm::vec3 voxel_cell(std::uint64_t key);

/// Cuts triangles exactly at the faces of the voxels of one level and integrates over the pieces, so that
/// no area is lost or counted twice however large or small the triangles are. Memory grows with the number of
/// voxels that the surface meets, not with the number of triangles. The same triangles in the same order
/// give the same bits whatever the number of threads.
class SurfaceVoxelizer {
 public:
  /// `level` from 1 to kDeepestLevel.
  SurfaceVoxelizer(const Cube& cube, int level, unsigned threads = 0);
  ~SurfaceVoxelizer();
  SurfaceVoxelizer(const SurfaceVoxelizer&) = delete;
  SurfaceVoxelizer& operator=(const SurfaceVoxelizer&) = delete;

  /// Adds triangles; those with a corner that is not finite or outside the cube are left out.
  void add(std::span<const Triangle> triangles);
  /// The voxels with some surface in them, by ascending key. Ends the voxelizer.
  [[nodiscard]] std::vector<Voxel> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The voxels of the next coarser level.
[[nodiscard]] std::vector<Voxel> coarsen(std::span<const Voxel> voxels);

}  // namespace gs::qnv
