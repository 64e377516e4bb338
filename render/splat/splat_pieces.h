#pragma once

#include "qnv/codecs/octree/lod/lod.h"
#include "render/scene/splat_style.h"
#include "render/splat/software/splat_raster.h"
#include "render/splat/splat_gl.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gs::render {

/// Size and colours of the part of a geometry that a view draws.
struct CutOptions {
  std::size_t budget = 0;        // maximum vectors; 0 means unlimited
  std::size_t most_decoded = 0;  // maximum vectors to decode now; 0 means unlimited
  float detail = 1;              // streams are refined until voxels have 1 / detail pixels
  std::uint32_t viewport = 0;    // index of the viewport
  ColorBy color_by = ColorBy::own;
};

struct SplatCut {
  std::vector<SharedSplatPiece> pieces;
  bool pending = false;     // the next call with this view would give more detail
  std::size_t decoded = 0;  // vectors that were decoded for this cut
};

/// Selects the part of a geometry that a view draws. For a stream with levels, this is a cut. For other geometries, it
/// is the prefix of the progressive order within the budget, enlarged to keep its area.
///
/// If colours distinguish levels, chunks or order of receipt, each piece has a tint of color_ramps.h. A level has one
/// colour in all streams. In geometries without levels, octaves of the order replace levels, and blocks replace chunks.
///
/// Returns no pieces if the view is not finite.
[[nodiscard]] SplatCut cut_splats(const std::shared_ptr<const qnv::Geometry>& geometry, const SplatView& view,
                                  const CutOptions& options);

/// Returns the view for the cut of a stream, without budget and error. Returns nullopt if the view is not finite.
[[nodiscard]] std::optional<qnv::LodView> lod_view(const SplatView& view);

}  // namespace gs::render
