#pragma once

#include "qnv/lod/lod.h"
#include "qnv/surface/patch_surface.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// How finely a patch is drawn. Details are levels with what lies between them: at 3.25 the new vertices of level 4 are
/// a quarter of the way from the middle of their parents to their own places, so that none ever jumps.
struct PatchCut {
  std::uint32_t part = 0, patch = 0;
  float detail = 0;
  std::uint8_t level = 0;                     // of its inner triangles
  std::array<std::uint8_t, 3> edge_levels{};  // so many halvings an edge has, at least `level`: as the patch beside has
  std::array<float, 3> edge_details{};        // of the edges: the same for the patches on both sides
};

/// What of a surface a view draws.
struct SurfaceCut {
  std::vector<PatchCut> patches;
  std::size_t vertices = 0;  // about
};

/// Takes the patches that may be seen, each as finely as its edges are seen: until they are `view.error_pixels` long,
/// or as far as `view.budget` vertices go; never coarser than the base. What is taken has no cracks between levels, and
/// changes without jumps when the eye moves. `view.leave_backs`: of patches that face away, none.
[[nodiscard]] SurfaceCut cut_surface(const SurfacePatches& surface, const LodView& view);

/// One patch as it is in a cut without a budget.
[[nodiscard]] PatchCut cut_patch(const SurfacePatches& surface, std::uint32_t part, std::uint32_t patch,
                                 const LodView& view);

/// All of it at one level, the deepest at which there are no more than `most_triangles`, or that of the base.
[[nodiscard]] SurfaceCut even_cut(const SurfacePatches& surface, std::size_t most_triangles);

}  // namespace gs::qnv
