#pragma once

#include "render/splat_raster.h"
#include "render/volume_model.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::render {

/// What a volume leaves in the pixels of the viewport, rows from the bottom.
struct VolumeLayer {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // RGBA, colours times alpha
  /// Along the view axis, camera units: of the vector with which the opacity comes to a half; where it never does, of
  /// the nearest one. 0: nothing here.
  std::vector<float> depth;
  std::size_t vectors = 0;  // that lay in view and had an opacity

  [[nodiscard]] bool empty() const { return pixels.empty(); }
};

/// Volume splatting on the processor: equation (1) of the paper for the model of volume_model.h, with footprints that
/// end at a hundredth of their middle and colours of vectors in eight bits. `model` is the cloud's. Lights are in
/// camera space; `view.supersample` is left aside: the footprints are smooth.
///
/// Tiles of the picture are sorted by depth each for itself (radix sort) and blended from front to back until
/// nothing shows through. The same bits whatever the number of threads. Any thread; safe for any numbers;
/// memory is bounded by the numbers of vectors and pixels. Empty when nothing is in view.
[[nodiscard]] VolumeLayer rasterize_volume(const qnv::Cloud& cloud, const VolumeModel& model, const SplatView& view,
                                           const VolumeOptions& options);

}  // namespace gs::render
