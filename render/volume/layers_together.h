#pragma once

#include "render/splat/software/splat_raster.h"
#include "render/volume/volume_raster.h"

#include <array>
#include <cstddef>
#include <functional>

namespace gs::render {

/// Function that rasterizes one content of an image: splats beyond the near plane of the view, up to the stops. Its
/// layer may omit the depths.
using LayerRaster = std::function<VolumeLayer(const SplatView& view, const VolumeStops& stops)>;

/// Depths along the view axis, in camera units.
struct DepthRange {
  float nearest = 0, farthest = 0;
};

constexpr std::size_t kSlabs = 8;  // slabs of a range in which two contents overlap

/// Rasterizes two contents that overlap in a range of depths. Divides the range into slabs, and blends the slabs in
/// depth order. Slabs of the second content are shifted by half a slab. So splats of different contents that are half a
/// slab apart or more have the right order. The layer has no depths. Returns an empty layer if nothing is in view.
[[nodiscard]] VolumeLayer rasterize_together(const std::array<LayerRaster, 2>& contents, const SplatView& view,
                                             const VolumeStops& stops, const DepthRange& range,
                                             std::size_t slabs = kSlabs);

}  // namespace gs::render
