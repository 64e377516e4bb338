#pragma once

#include "qnv/base/geometry.h"
#include "render/gaussians/gaussian_tile.h"
#include "render/scene/fog.h"
#include "render/splat/software/splat_raster.h"
#include "render/volume/volume_raster.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gs::render {

constexpr float kGaussianLowPass = 0.3f;          // added to the variances, in pixels^2 (3DGS)
constexpr float kGaussianFarthestTangent = 1.3f;  // of the half view; the projection is linearised at most there (3DGS)
constexpr float kGaussianFadeGain = 2.8f;         // factor in faded_opacity()
constexpr float kGaussianMostReach = 1e5f;        // pixels; larger splats are not drawn

/// Gaussian splats that are part of an image.
struct GaussianItem {
  const qnv::Gaussians* gaussians = nullptr;
  glm::mat4 camera_from_node{1.0f};  // any affine matrix
  std::size_t count = 0;             // number of splats to draw, from index `first` on
  float opacity = 1;                 // factor of all opacities
  std::optional<glm::vec4> clip;     // in node space: a splat is drawn if dot(clip, (centre, 1)) is at least 0
  CameraFog fog;
  std::size_t first = 0;  // at most the number of splats
  float presence = 1;     // share of the opacity; below 1 for splats that fade in or out
};

/// Returns the opacity of a splat that fades in or out. Two splats with shares that sum to 1 have together about the
/// opacity of the whole splat. The visible part of each changes evenly with its share, whichever is in front.
[[nodiscard]] inline float faded_opacity(float opacity, float presence) {
  if (!(presence < 1)) return opacity;
  const float most = std::min(opacity, kGaussianMostAlpha);
  return 1 - std::pow(1 - most * presence, 1 + kGaussianFadeGain * presence * (1 - presence) * most);
}

/// Splats in view, unordered.
struct ProjectedGaussians {
  std::vector<GaussianSplat> splats;
  std::vector<float> distances;  // squared, from the eye
  std::vector<GaussianSurfel> surfels;
};

/// Projects splats by EWA: the covariance in the picture is J W Sigma W^T J^T + 0.3 pixels^2 (Zwicker et al. 2002;
/// Kerbl et al. 2023). Splats without a third scale become surfels, which rays intersect (Huang et al. 2024), unless
/// they reach the plane of the eye. Appends those of [first, last) of the item that are in view, unordered, without
/// splats fainter than kGaussianLeastAlpha. Callers sort splats by distance from the eye, so that turning the view
/// keeps the order.
void project_gaussians(const GaussianItem& item, const SplatView& view, std::size_t first, std::size_t last,
                       ProjectedGaussians& out);

/// Splats Gaussians on the CPU: projects them, sorts those of all items by distance from the eye, and blends each tile
/// from front to back until it is opaque. Splats behind the stop of a pixel are not blended. Ignores the matrix and
/// `supersample` of `view`. Colours are blended as they are, without conversion (KHR_gaussian_splatting).
///
/// Gives identical bits for any number of threads. Memory is bounded by the numbers of splats and pixels. Returns an
/// empty layer if nothing is in view. If `with_depths` is false, omits the depths of the layer, which saves time.
/// Thread-safe; accepts any numbers.
[[nodiscard]] VolumeLayer rasterize_gaussians(std::span<const GaussianItem> items, const SplatView& view,
                                              const VolumeStops& stops = {}, bool with_depths = true);

/// Records a picture without Gaussians. After several such pictures in a row, frees the arrays that are kept for the
/// next picture with Gaussians. Thread-safe.
void note_picture_without_gaussians();

}  // namespace gs::render
