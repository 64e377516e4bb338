#pragma once

#include "render/splat/splat_raster.h"
#include "render/volume/volume_model.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::render {

/// Volume of an image.
struct VolumeItem {
  const qnv::Volume* volume = nullptr;
  const VolumeModel* model = nullptr;  // model of the point set
  glm::mat4 camera_from_node{1.0f};    // any affine matrix
  std::size_t count = 0;               // number of vectors to draw, from the first, at most model->spacing.size()
  VolumeOptions options;               // lights in camera space
};

/// Depths of the existing image that hide content behind them: distances along the view axis in camera units, one per
/// pixel, rows from the bottom; infinite for empty pixels. Empty means no depths.
struct VolumeStops {
  std::span<const float> near, far;  // of the nearest and farthest sample of a pixel; an empty far equals near
};

/// Result of rasterizing volumes, rows from the bottom.
struct VolumeLayer {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // RGBA, premultiplied
  /// The same for the nearest samples of the pixels; empty if near and far are equal everywhere.
  std::vector<std::uint8_t> edge_pixels;
  /// View-space depth where opacity reaches 0.5, else of the nearest sample, along the view axis in camera units. 0
  /// means empty.
  std::vector<float> depth;
  std::size_t vectors = 0;  // in view with an opacity

  [[nodiscard]] bool empty() const { return pixels.empty(); }
};

/// Splats volumes on the CPU: equation (1) of the paper for the model of volume_model.h. Footprints end at a hundredth
/// of their peak; colours of vectors have 8 bits. Vectors of all volumes are merged by depth; at equal depth, earlier
/// items come first. Vectors behind a pixel's stop are not blended. Ignores the matrix and `supersample` of `view`,
/// since footprints are smooth.
///
/// Each tile is sorted by depth (radix sort) and blended from front to back until it is opaque. Gives the same bits for
/// any number of threads. Thread-safe; accepts any numbers. Memory is bounded by the numbers of vectors and pixels.
/// Empty if nothing is in view.
[[nodiscard]] VolumeLayer rasterize_volumes(std::span<const VolumeItem> items, const SplatView& view,
                                            const VolumeStops& stops = {});

/// Rasterizes one complete volume.
[[nodiscard]] VolumeLayer rasterize_volume(const qnv::Volume& volume, const VolumeModel& model, const SplatView& view,
                                           const VolumeOptions& options);

/// Estimates for volumes in a view, from a sample of their vectors.
struct VolumeSurvey {
  std::size_t vectors = 0;  // in view with an opacity
  double pixels = 0;        // covered in total by their footprints
};
/// Examines about `most` vectors, evenly spread; exact if there are no more.
[[nodiscard]] VolumeSurvey survey_volumes(std::span<const VolumeItem> items, const SplatView& view, std::size_t most);

}  // namespace gs::render
