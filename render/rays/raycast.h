#pragma once

#include "render/splat/splat_raster.h"
#include "render/volume/volume_model.h"

#include <glm/vec4.hpp>

#include <cstddef>
#include <vector>

namespace gs::render {

/// What the rays of all pixels of the viewport found, rows from the bottom.
struct RayImage {
  int width = 0, height = 0;
  std::vector<glm::vec4> color;  // RGBA 0..1, colours times alpha
  std::vector<float> depth;      // along the view axis, camera units; 0: nothing

  [[nodiscard]] bool empty() const { return color.empty(); }
};

/// Likewise of a surface.
struct RaySurface {
  int width = 0, height = 0;
  std::vector<glm::vec4> normal;  // camera space, unit; and the part of the pixel's samples that are covered
  std::vector<glm::vec4> color;   // RGB 0..1
  std::vector<float> depth;       // along the view axis, camera units, of the nearest sample; 0: nothing

  [[nodiscard]] bool empty() const { return normal.empty(); }
};

/// Equation (1) of the paper for a volume, exactly and slowly: for the ray of every pixel, the sum over all vectors
/// that is there, for the model that volume_model.h describes, in double precision, with footprints without
/// an end and no vector passed over but those that the model leaves out. What rasterize_volume is
/// measured against. The depth is that of the vector with which the opacity, seen from the front, comes to a
/// half; 0 where it never does.
///
/// Takes time in proportion to pixels times vectors. Any thread; safe for any numbers. Empty when nothing is in view.
[[nodiscard]] RayImage raycast_volume(const qnv::Cloud& cloud, const SplatView& view, const VolumeOptions& options);

/// The definition that rasterize_surface implements, exactly and slowly, in double precision.
///
/// For the ray of every sample: the nearest of all discs that cover the place where the ray meets their plane. A disc
/// from an octree covers its cube and kCubeMargin of its edge, or kSampleMargin samples, more on each side (kBackMargin
/// where it shows its back), any other kDiscCover times its radius (in a cloud that has cubes: a cube of that half
/// edge), and all at least kLeastReach samples. Discs that turn their back count only when the cloud is two-sided, and
/// those that are seen edge on, up to a cosine of kGrazing, never. The constants are those of splat_constants.h.
///
/// At that place p, normals and colours are the means of those of all discs that turn the same side to the viewer,
/// weighted by bells (1 - |p - x_k|^2 / (4 R_k^2))^4: nearly the paper's exp(-|p - x_k|^2 / A_k) with A_k =
/// 0.83 R_k^2, and nothing beyond two R_k. R_k is kDiscBell times the disc's radius; for cubes kCubeBell times it,
/// and at least half the edge; for both at least kLeastReach samples.
///
/// With `smooth` kSmoothing of the slope of the blended surface is added to the normal: of the surface where the mean
/// of the heights over the planes of the discs, with the same weights, is zero. rasterize_surface does so where
/// survey_surface says so.
///
/// Takes time in proportion to samples times discs. Any thread; safe for any numbers. Empty when the cloud or the
/// view is.
[[nodiscard]] RaySurface raycast_surface(const qnv::Cloud& cloud, const SplatView& view, bool smooth);

}  // namespace gs::render
