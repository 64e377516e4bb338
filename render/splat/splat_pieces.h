#pragma once

#include "qnv/codecs/octree/lod/lod.h"
#include "render/scene/cloud_look.h"
#include "render/splat/splat_gl.h"
#include "render/splat/splat_raster.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gs::render {

/// Size and colours of a point set's part for one view.
struct CutOptions {
  std::size_t budget = 0;        // vectors; 0 means unlimited
  std::size_t most_decoded = 0;  // vectors that may be decoded now; 0 means unlimited
  float detail = 1;              // streams are refined to voxels of 1 / detail pixels
  std::uint32_t viewport = 0;    // number of the viewport
  ColorBy color_by = ColorBy::own;
};

struct SplatCut {
  std::vector<SharedSplatPiece> pieces;
  bool pending = false;     // the same view would get more detail on the next call
  std::size_t decoded = 0;  // vectors decoded for this cut
};

/// Selects the part of a point set to draw in a view: for a stream with levels, its cut; for others, the prefix of the
/// progressive order within the budget, enlarged to keep its area. With colours by level, chunk or age, each piece has
/// a tint of color_ramps.h; a level has the same colour in all streams. In point sets without levels, octaves of the
/// order stand for levels and blocks for chunks. Returns nothing for non-finite views.
[[nodiscard]] SplatCut cut_splats(const std::shared_ptr<const qnv::Geometry>& geometry, const SplatView& view,
                                  const CutOptions& options);

/// Returns the view for cutting a stream, except budget and error; nullopt for non-finite views.
[[nodiscard]] std::optional<qnv::LodView> lod_view(const SplatView& view);

}  // namespace gs::render
