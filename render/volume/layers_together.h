#pragma once

#include "render/splat/software/splat_raster.h"
#include "render/volume/volume_raster.h"

#include <array>
#include <cstddef>
#include <functional>

namespace gs::render {

/// Rasterizes a content of an image: splats beyond the near plane of the view, up to the stops. A layer without depths
/// suffices.
using LayerRaster = std::function<VolumeLayer(const SplatView& view, const VolumeStops& stops)>;

/// Depths along the view axis, in camera units.
struct DepthRange {
  float nearest = 0, farthest = 0;
};

constexpr std::size_t kSlabs = 8;  // slabs of a range in which two contents overlap

/// Rasterizes two contents that overlap in a range of depths. Divides the range into slabs. Blends the slabs of both in
/// the order of their depths; those of the second content are shifted by half a slab. So a splat is at most half a slab
/// too far in front or behind. The layer has no depths. Returns an empty layer if nothing is in view.
[[nodiscard]] VolumeLayer rasterize_together(const std::array<LayerRaster, 2>& contents, const SplatView& view,
                                             const VolumeStops& stops, const DepthRange& range,
                                             std::size_t slabs = kSlabs);

}  // namespace gs::render
