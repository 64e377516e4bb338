#pragma once

#include "qnv/codecs/displaced/tessellation/patch_surface.h"
#include "qnv/codecs/shared/lod_view.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Detail of a patch in a cut. Details are levels with intermediate values. Example: at detail 3.25, the new vertices
/// of level 4 are a quarter of the way from their parents' midpoint to their own position. Therefore no vertex ever
/// jumps.
struct PatchCut {
  std::uint32_t part = 0, patch = 0;
  float detail = 0;
  std::uint8_t level = 0;  // level of the inner triangles
  std::array<std::uint8_t, 3> edge_levels{};  // halvings of each edge, at least `level`; adjacent patches agree
  std::array<float, 3> edge_details{};  // detail of each edge; adjacent patches agree
};

/// Part of a surface that a view draws.
struct SurfaceCut {
  std::vector<PatchCut> patches;
  std::size_t vertices = 0;  // approximate number
};

/// Returns the patches that may be visible, each as detailed as its edges require. An edge is halved until its parts
/// are at most `view.error_pixels` long, or until `view.budget` vertices are used. The result is never coarser than the
/// base mesh. The cut has no cracks between levels, and changes continuously with the eye's position. If
/// `view.leave_backs`, omits patches that face away.
[[nodiscard]] SurfaceCut cut_surface(const SurfacePatches& surface, const LodView& view);

/// Returns the detail of one patch, as in a cut without a budget.
[[nodiscard]] PatchCut cut_patch(const SurfacePatches& surface, std::uint32_t part, std::uint32_t patch,
                                 const LodView& view);

/// Returns the whole surface at one level: the finest level with at most `most_triangles` triangles, or else the base
/// mesh.
[[nodiscard]] SurfaceCut even_cut(const SurfacePatches& surface, std::size_t most_triangles);

}  // namespace gs::qnv
