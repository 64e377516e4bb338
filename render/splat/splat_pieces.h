#pragma once

#include "qnv/lod/lod.h"
#include "render/scene/cloud_look.h"
#include "render/splat/splat_gl.h"
#include "render/splat/splat_raster.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gs::render {

/// How much of a cloud a view gets, and in which colours.
struct CutOptions {
  std::size_t budget = 0;        // vectors; 0: no limit
  std::size_t most_decoded = 0;  // that may be decoded now; 0: as many as are needed
  float detail = 1;              // what a stream is refined to: voxels of 1 / detail pixels
  std::uint32_t viewport = 0;    // which of those that look by turns
  ColorBy color_by = ColorBy::own;
};

struct SplatCut {
  std::vector<SharedSplatPiece> pieces;
  bool pending = false;     // the same view, asked again, would get more detail
  std::size_t decoded = 0;  // vectors, for this cut
};

/// What of a cloud is drawn in a view: of a stream with levels, its cut; of any other, the part of its progressive
/// order that the budget allows, grown so that its area stays the same. With colours by level, chunk or age, each piece
/// has the tint of color_ramps.h: a level has the same colour in all streams; of a cloud without levels the octaves of
/// the order stand for levels and blocks of it for chunks. Nothing for views that are not finite.
[[nodiscard]] SplatCut cut_cloud(const std::shared_ptr<const qnv::Cloud>& cloud, const SplatView& view,
                                 const CutOptions& options);

/// A view as who cuts a stream takes it, but for budget and error. Nothing for views that are not finite.
[[nodiscard]] std::optional<qnv::LodView> lod_view(const SplatView& view);

}  // namespace gs::render
