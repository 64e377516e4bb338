#pragma once

#include "render/splat/software/splat_raster.h"
#include "render/volume/volume_model.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::render {

/// Volume that is part of an image.
struct VolumeItem {
  const qnv::Volume* volume = nullptr;
  const VolumeModel* model = nullptr;  // model of the volume
  glm::mat4 camera_from_node{1.0f};    // any affine matrix
  std::size_t count = 0;               // number of vectors to draw, from index 0 on; at most model->spacing.size()
  VolumeOptions options;               // with lights in camera space
};

/// Depths of the existing image, which hide content behind them. Distances along the view axis in camera units, one per
/// pixel, rows from the bottom. Infinite for empty pixels. Empty spans mean that nothing is hidden.
struct VolumeStops {
  std::span<const float> near, far;  // nearest and farthest sample of each pixel; an empty `far` equals `near`
};

/// Rectangle of pixels.
struct PixelBox {
  int left = 0, bottom = 0, width = 0, height = 0;
};

/// Rasterized volumes, rows from the bottom.
struct VolumeLayer {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // RGBA, premultiplied, for the farthest samples
  /// Like `pixels`, but for the nearest samples. Empty if near and far are equal everywhere.
  std::vector<std::uint8_t> edge_pixels;
  /// View-space depth where the opacity reaches 0.5, otherwise of the nearest vector: distance along the view axis in
  /// camera units. 0 means an empty pixel. The array is empty if no depths were requested.
  std::vector<float> depth;
  PixelBox used;            // pixels outside of it are transparent
  std::size_t vectors = 0;  // vectors in view that have an opacity

  [[nodiscard]] bool empty() const { return pixels.empty(); }
};

/// Splats volumes on the CPU: equation (1) of the paper with the model of volume_model.h. Footprints end where they
/// fall to a hundredth. Colours of vectors have 8 bits. The vectors of all volumes are merged by depth; at equal depth,
/// earlier items are in front. Vectors behind the stop of a pixel are not blended. Ignores the matrix and `supersample`
/// of `view`, because footprints are smooth.
///
/// Sorts each tile by depth (radix sort). Blends it from front to back until it is opaque. Gives identical bits for any
/// number of threads. Memory is bounded by the numbers of vectors and pixels. Returns an empty layer if nothing is in
/// view. Thread-safe; accepts any numbers.
[[nodiscard]] VolumeLayer rasterize_volumes(std::span<const VolumeItem> items, const SplatView& view,
                                            const VolumeStops& stops = {});

/// Estimates for the vectors of volumes in a view, from a sample.
struct VolumeSurvey {
  std::size_t vectors = 0;  // vectors in view that have an opacity
  double pixels = 0;        // sum of the pixels that their footprints cover
};
/// Estimates from about `most` vectors, evenly spread. If there are fewer vectors, the result is exact.
[[nodiscard]] VolumeSurvey survey_volumes(std::span<const VolumeItem> items, const SplatView& view, std::size_t most);

}  // namespace gs::render
