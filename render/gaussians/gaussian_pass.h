#pragma once

#include "render/gaussians/gaussian_gl.h"
#include "render/gaussians/gaussian_levels.h"
#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/volume/layers_together.h"
#include "render/volume/volume_overlay.h"
#include "render/volume/volume_target.h"

#include <glm/vec3.hpp>

#include <optional>

namespace gs::render {

/// Returns true if the Gaussians of a list are behind its volumes, as seen from `eye` in world space. If a plane across
/// an axis separates their boxes, the volumes must be on the side of the eye. Otherwise the box with the nearer centre
/// is in front. Returns false if Gaussians or volumes are missing.
[[nodiscard]] bool are_gaussians_behind_volumes(const RenderList& list, const glm::dvec3& eye);
/// Returns the depths in which the boxes of the Gaussians and the volumes of a list overlap. Returns nullopt if they do
/// not.
[[nodiscard]] std::optional<DepthRange> overlap_of_gaussians_and_volumes(const RenderList& list, const Camera& camera);

/// Pass for the Gaussians of a RenderList (only SplatItems with qnv::Gaussians). Blends all splats in depth order, with
/// OpenGL or on the CPU, over the existing image, which hides splats behind it per sample. Uses only the transparency
/// of the material. Applies fog, but no lights. Writes no depth, so that later transparent polygons blend over splats.
class GaussianPass {
 public:
  explicit GaussianPass(const Gl& gl, SortMethod sort = SortMethod::automatic);

  /// Draws the Gaussians. Call it after all opaque content; `any_opaque` is false if there is none. `camera` must have
  /// near and far planes. Leaves blending and the depth test off, and depth writes on.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            FrameStatistics& statistics, bool any_opaque = true);

  /// Returns a rasterizer, or nullopt with OpenGL or without Gaussians. Valid until the list or the pass changes.
  [[nodiscard]] std::optional<LayerRaster> rasterizer(const RenderList& list, const Camera& camera,
                                                      const Projection& projection, const DrawOptions& options,
                                                      FrameStatistics& statistics);

  /// Returns the method that sorted for the last OpenGL image.
  [[nodiscard]] SortMethod sorted_by() const { return gaussian_gl_.sorted_by(); }

 private:
  [[nodiscard]] bool with_gl(const DrawOptions& options) const;

  const Gl& gl_;
  GaussianLevels levels_;
  VolumeTarget target_;
  GaussianGl gaussian_gl_;
  TargetDepths depths_;
  VolumeOverlay overlay_;
};

}  // namespace gs::render
