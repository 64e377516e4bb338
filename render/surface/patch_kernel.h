#pragma once

#include "qnv/codecs/displaced/tessellation/patch_mesh.h"
#include "render/splat/software/splat_kernel.h"
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

/// Lists of triangle indexes, reused for each patch.
struct SiftedTriangles {
  // Triangles with samples in their bounding box, by its width and height in samples: at most two; at most
  // kSmallTriangle; more. Triangles that must be clipped are also in the last list. The vectors have spare elements at
  // the end.
  std::vector<std::uint32_t> narrow, wide, large;
  std::size_t narrows = 0, wides = 0, larges = 0;
};

/// Array to which samples are written; `colors` only if vertices have colours. Needs kPatchRoom spare elements.
struct PatchSamples {
  SampleKey* keys;
  std::uint32_t *samples, *colors;
};
inline constexpr std::size_t kPatchRoom = 8;

/// Inner loops of the patch rasterizer for one instruction set. All kernels give identical bits.
struct PatchKernel {
  std::string_view name;
  /// Projects vertices. Both arrays need kPatchRoom spare elements.
  void (*project)(const qnv::PatchVertex* from, std::size_t count, const PatchLens& lens, ScreenVertex* to);
  /// Sorts triangles into lists. Drops triangles without a sample in their bounding box, and back faces of one-sided
  /// surfaces.
  void (*sift)(const ScreenVertex* vertices, std::span<const PatchTriangle> triangles, const PatchLook& look,
               SiftedTriangles& out);
  /// Draws triangles with bounding boxes of at most `side` x `side` samples; `side` is at most kSmallTriangle. Returns
  /// the number of samples.
  std::size_t (*draw_small)(const ScreenVertex* vertices, const PatchTriangle* triangles,
                            std::span<const std::uint32_t> chosen, int side, const PatchGrid& grid,
                            const PatchLook& look, const PatchSamples& out);
  /// Draws the samples of a triangle in a tile. (left, bottom) is the lower left sample of the tile.
  void (*draw_large)(const ScreenTriangle& triangle, int left, int bottom, const PatchGrid& grid, const PatchLook& look,
                     PatchTile& tile);
  /// Averages the samples of each pixel of a tile. (left, bottom) is the lower left sample of the tile in the target.
  void (*resolve)(const PatchTile& tile, const glm::mat3& normal_matrix, int left, int bottom,
                  const SplatTarget& target);
  /// Clears the pixels of a tile that no triangle touches.
  void (*leave_empty)(int left, int bottom, const SplatTarget& target);
};

/// Returns the kernels that this CPU supports, fastest first. The last kernel runs on any CPU.
[[nodiscard]] std::span<const PatchKernel> patch_kernels();

/// Rasterizes patches with the given kernel.
[[nodiscard]] SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut,
                                           const SplatView& view, const PatchRasterOptions& options,
                                           const PatchKernel& kernel);

}  // namespace gs::render
