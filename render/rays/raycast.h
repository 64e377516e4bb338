#pragma once

#include "render/splat/splat_raster.h"
#include "render/volume/volume_model.h"

#include <glm/vec4.hpp>

#include <cstddef>
#include <vector>

namespace gs::render {

/// Result of casting a ray per pixel of the viewport, rows from the bottom.
struct RayImage {
  int width = 0, height = 0;
  std::vector<glm::vec4> color;  // RGBA 0..1, premultiplied
  std::vector<float> depth;      // along the view axis, camera units; 0 means no hit

  [[nodiscard]] bool empty() const { return color.empty(); }
};

/// Result of casting rays at a surface, rows from the bottom.
struct RaySurface {
  int width = 0, height = 0;
  std::vector<glm::vec4> normal;  // camera space, unit; w is the covered fraction of the pixel's samples
  std::vector<glm::vec4> color;   // RGB 0..1
  std::vector<float> depth;       // along the view axis, camera units, of the nearest sample; 0 means no hit

  [[nodiscard]] bool empty() const { return normal.empty(); }
};

/// Evaluates equation (1) of the paper for a volume, exactly and slowly. For each pixel's ray it sums over all vectors
/// in double precision, for the model of volume_model.h. Footprints are unbounded, and only vectors that the model
/// excludes are skipped. This is the reference for rasterize_volume. The depth is that of the vector at which the
/// opacity from the front reaches 0.5; 0 if it never does.
///
/// Takes time proportional to pixels times vectors. Thread-safe; accepts any numbers. Empty if nothing is in view.
[[nodiscard]] RayImage raycast_volume(const qnv::Cloud& cloud, const SplatView& view, const VolumeOptions& options);

/// Implements the definition of rasterize_surface, exactly and slowly, in double precision.
///
/// For each sample's ray, it finds the nearest splat that covers the ray's intersection with its plane. A splat from an
/// octree covers its cube plus a margin on each side: kCubeMargin of the edge (kBackMargin if its back is visible), or
/// kSampleMargin samples. Any other splat covers kDiscCover times its radius; if the point set has cubes, it covers a
/// cube of that half edge. All splats cover at least kLeastReach samples. Back-facing splats count only if the point
/// set is two-sided. Splats seen edge-on, up to a cosine of kGrazing, never count. splat_constants.h defines the
/// constants.
///
/// At that point p, normals and colours are weighted means over all splats that show the same side. The weights are
/// bells (1 - |p - x_k|^2 / (4 R_k^2))^4. These approximate the paper's exp(-|p - x_k|^2 / A_k) with A_k = 0.83 R_k^2
/// and are zero beyond two R_k. R_k is kDiscBell times the splat's radius; for cubes it is kCubeBell times the radius,
/// at least half the edge; for both at least kLeastReach samples.
///
/// With `smooth`, kSmoothing times the slope of the blended surface is added to the normal. That surface is the zero
/// set of the weighted mean height over the splats' planes. rasterize_surface does so if survey_surface says so.
///
/// Takes time proportional to samples times splats. Thread-safe; accepts any numbers. Empty if the point set or the
/// view is.
[[nodiscard]] RaySurface raycast_surface(const qnv::Cloud& cloud, const SplatView& view, bool smooth);

}  // namespace gs::render
