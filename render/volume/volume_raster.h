#pragma once

#include "render/splat/splat_raster.h"
#include "render/volume/volume_model.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::render {

/// One volume of a picture.
struct VolumeItem {
  const qnv::Cloud* cloud = nullptr;
  const VolumeModel* model = nullptr;  // the cloud's
  glm::mat4 camera_from_node{1.0f};    // any affine matrix
  std::size_t count = 0;               // the first so many vectors, no more than model->spacing.size()
  VolumeOptions options;               // lights in camera space
};

/// What was drawn before and hides what lies behind it: distances along the view axis, camera units, one a pixel, rows
/// from the bottom; infinite where nothing is. Empty: nothing anywhere.
struct VolumeStops {
  std::span<const float> near, far;  // of the nearest and the farthest sample of a pixel; far empty: the same
};

/// What volumes leave in the pixels of the viewport, rows from the bottom.
struct VolumeLayer {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // RGBA, colours times alpha
  /// Likewise as seen in the nearest samples of the pixels; empty when near and far nowhere differ.
  std::vector<std::uint8_t> edge_pixels;
  /// Along the view axis, camera units: of the vector with which the opacity comes to a half; where it never does, of
  /// the nearest one. 0: nothing here.
  std::vector<float> depth;
  std::size_t vectors = 0;  // that lay in view and had an opacity

  [[nodiscard]] bool empty() const { return pixels.empty(); }
};

/// Volume splatting on the processor: equation (1) of the paper for the model of volume_model.h, with footprints that
/// end at a hundredth of their middle and colours of vectors in eight bits. The vectors of all volumes are mixed by
/// depth; of those of the same depth the ones of earlier items come first. A vector that lies behind the stop of a
/// pixel is not blended there. Of `view` the matrix and `supersample` are left aside: the footprints are smooth.
///
/// Tiles of the picture are sorted by depth each for itself (radix sort) and blended from front to back until
/// nothing shows through. The same bits whatever the number of threads. Any thread; safe for any numbers;
/// memory is bounded by the numbers of vectors and pixels. Empty when nothing is in view.
[[nodiscard]] VolumeLayer rasterize_volumes(std::span<const VolumeItem> items, const SplatView& view,
                                            const VolumeStops& stops = {});

/// One volume, all of it.
[[nodiscard]] VolumeLayer rasterize_volume(const qnv::Cloud& cloud, const VolumeModel& model, const SplatView& view,
                                           const VolumeOptions& options);

/// What can be told of volumes in a view from some of their vectors.
struct VolumeSurvey {
  std::size_t vectors = 0;  // in view, with an opacity
  double pixels = 0;        // that their footprints cover together
};
/// Looks at about `most` vectors, evenly spread; exact when there are no more.
[[nodiscard]] VolumeSurvey survey_volumes(std::span<const VolumeItem> items, const SplatView& view, std::size_t most);

}  // namespace gs::render
