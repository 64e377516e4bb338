#pragma once

#include "render/splat/software/splat_raster.h"
#include "render/volume/volume_raster.h"

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace gs::render {

/// Function that rasterizes one content of an image: splats beyond the near plane of the view, up to the stops. Its
/// layer may omit the depths.
using LayerRaster = std::function<VolumeLayer(const SplatView& view, const VolumeStops& stops)>;

/// Depths along the view axis, in camera units.
struct DepthRange {
  float nearest = 0, farthest = 0;
};
/// Depths that two contents share, and the number of slabs that they need.
struct SharedDepths {
  DepthRange range;
  std::size_t slabs = 1;
};

constexpr std::size_t kSlabs = 8;  // maximum slabs of a range in which two contents overlap

/// Part of one of two contents: its splats with depths above `nearest` and up to `farthest`.
struct DepthSlab {
  std::size_t content = 0;
  float nearest = 0, farthest = 0;
};

/// Divides two contents that overlap in a range of depths into slabs, from near to far. Slabs of the second content are
/// shifted by half a slab. So splats of different contents that are half a slab apart or more have the right order. The
/// first slab of each content begins at 0, and its last one has no end.
[[nodiscard]] std::vector<DepthSlab> depth_slabs(const DepthRange& range, std::size_t slabs = kSlabs);

/// Rasterizes two contents that overlap in a range of depths: blends their slabs in depth order. The layer has no
/// depths. Returns an empty layer if nothing is in view.
[[nodiscard]] VolumeLayer rasterize_together(const std::array<LayerRaster, 2>& contents, const SplatView& view,
                                             const VolumeStops& stops, const DepthRange& range,
                                             std::size_t slabs = kSlabs);

}  // namespace gs::render
