#pragma once

#include "qnv/surface/patch_mesh.h"
#include "render/splat/splat_kernel.h"
#include "render/surface/patch_raster.h"
#include "render/surface/patch_screen.h"

#include <glm/mat3x3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gs::render {

using PatchTriangle = qnv::PatchMesh::Triangle;

/// Numbers of triangles, kept from patch to patch.
struct SiftedTriangles {
  // Those whose box holds samples, by how many of them it is wide and high: two at most, kSmallTriangle at most, more;
  // those that must be cut are among the last, too. Behind the last one there is room.
  std::vector<std::uint32_t> narrow, wide, large;
  std::size_t narrows = 0, wides = 0, larges = 0;
};

/// Where samples go; `colors` only where vertices have some. With room for all, and kPatchRoom more.
struct PatchSamples {
  SampleKey* keys;
  std::uint32_t *samples, *colors;
};
inline constexpr std::size_t kPatchRoom = 8;

/// The inner loops of the patch rasteriser with one set of vector instructions. All give the same bits.
struct PatchKernel {
  std::string_view name;
  /// Both have room for kPatchRoom more than there are.
  void (*project)(const qnv::PatchVertex* from, std::size_t count, const PatchLens& lens, ScreenVertex* to);
  /// Leaves out who is seen from behind where backs are not, and who has no sample in the box around it.
  void (*sift)(const ScreenVertex* vertices, std::span<const PatchTriangle> triangles, const PatchLook& look,
               SiftedTriangles& out);
  /// The samples of triangles whose boxes are `side` samples wide and high at most, which is kSmallTriangle at most;
  /// returns how many they are.
  std::size_t (*draw_small)(const ScreenVertex* vertices, const PatchTriangle* triangles,
                            std::span<const std::uint32_t> chosen, int side, const PatchGrid& grid,
                            const PatchLook& look, const PatchSamples& out);
  /// The samples of a triangle in the tile whose lower left one is (left, bottom).
  void (*draw_large)(const ScreenTriangle& triangle, int left, int bottom, const PatchGrid& grid, const PatchLook& look,
                     PatchTile& tile);
  /// The means of the samples of each pixel of a tile; (left, bottom): where its lower left sample is in the target.
  void (*resolve)(const PatchTile& tile, const glm::mat3& normal_matrix, int left, int bottom,
                  const SplatTarget& target);
  /// A tile that nothing touches.
  void (*leave_empty)(int left, int bottom, const SplatTarget& target);
};

/// Those that run here, the fastest first; the last runs everywhere.
[[nodiscard]] std::span<const PatchKernel> patch_kernels();

/// rasterize_patches with a certain one.
[[nodiscard]] SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut,
                                           const SplatView& view, const PatchRasterOptions& options,
                                           const PatchKernel& kernel);

}  // namespace gs::render
