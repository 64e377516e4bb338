#pragma once

#include "render/gaussians/gaussian_gl.h"
#include "render/gaussians/gaussian_levels.h"
#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/volume/volume_overlay.h"
#include "render/volume/volume_pass.h"
#include "render/volume/volume_target.h"

#include <memory>
#include <optional>

namespace gs::render {

struct GaussianScene;

/// Pass for the Gaussians of a RenderList (only SplatItems with qnv::Gaussians). Blends all splats in depth order, with
/// OpenGL or on the CPU, over the existing image, which hides splats behind it per sample. Uses only the transparency
/// of the material. Applies fog, but no lights. Writes no depth, so that later transparent polygons blend over splats.
class GaussianPass {
 public:
  explicit GaussianPass(const Gl& gl, SortMethod sort = SortMethod::automatic);
  ~GaussianPass();

  /// Draws the Gaussians. Call it after all opaque content; `any_opaque` is false if there is none. `camera` must have
  /// near and far planes. Leaves blending and the depth test off, and depth writes on.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            FrameStatistics& statistics, bool any_opaque = true);

  /// Returns the Gaussians if some of them are inside of volumes, so that the pass of the volumes must draw both.
  /// Otherwise returns nullopt; then the next draw() must have the same arguments. Valid until the list or the pass
  /// changes.
  [[nodiscard]] std::optional<VolumePass::Overlap> overlap(const RenderList& list, const Camera& camera,
                                                           const Projection& projection, const DrawOptions& options,
                                                           FrameStatistics& statistics);

  /// Returns the method that sorted for the last OpenGL image.
  [[nodiscard]] SortMethod sorted_by() const { return gaussian_gl_.sorted_by(); }
  /// Reports whether compute shaders projected the splats of the last image.
  [[nodiscard]] bool projected_once() const { return gaussian_gl_.projected_once(); }

 private:
  [[nodiscard]] bool with_gl(const DrawOptions& options) const;
  [[nodiscard]] std::shared_ptr<const GaussianScene> collect(const RenderList& list, const Camera& camera,
                                                             const DrawOptions& options, const SplatView& view);

  const Gl& gl_;
  GaussianLevels levels_;
  std::shared_ptr<const GaussianScene> collected_;  // Gaussians for the next draw(), from overlap(); else null
  VolumeTarget target_;
  GaussianGl gaussian_gl_;
  TargetDepths depths_;
  VolumeOverlay overlay_;
};

}  // namespace gs::render
