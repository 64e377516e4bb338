#pragma once

#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/volume/volume_gl.h"
#include "render/volume/volume_lights.h"
#include "render/volume/volume_raster.h"
#include "render/volume/volume_target.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Draws the volumes of a RenderList (SplatItems whose cloud's kind is Kind::volume, and no others): blends the
/// vectors of all of them by depth, with OpenGL or on the processor, over what has been drawn. Colours are those of
/// DrawOptions::clouds; of the material only the transparency counts. volume_lights() says how they are lit. A volume
/// of which the budget does not allow all vectors (share_budget) shows the first ones of its progressive order.
///
/// What has been drawn before hides the vectors that lie behind it, sample by sample, so that polygons in front
/// of a volume, inside it and behind it are right. Where depth cannot be read back on the way over the processor,
/// every pixel of the volumes has one depth, that where its opacity comes to a half, and is hidden as a whole. Writes
/// no depth, so that transparent polygons drawn later are blended over volumes.
class VolumePass {
 public:
  explicit VolumePass(const Gl& gl, VolumeSort sort = VolumeSort::automatic);

  /// `camera` must have its near and far planes set. Call when everything opaque has been drawn. Leaves blending and
  /// the depth test off, and depth writable.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            FrameStatistics& statistics);

  /// What sorted the last picture that OpenGL drew.
  [[nodiscard]] VolumeSort sorted_by() const { return volume_gl_.sorted_by(); }

 private:
  struct Held {
    std::weak_ptr<const qnv::Cloud> cloud;
    std::size_t counted = 0;
    std::shared_ptr<const VolumeModel> model;
    std::uint64_t used = 0;
  };
  /// The volumes of one picture; items point into the other members.
  struct Scene {
    std::vector<SharedVolume> held;
    std::vector<VolumeItem> items;
    std::vector<std::vector<VolumeLight>> lights;
    VolumeTransfer transfer{};
  };
  struct Overlay {
    Program program;
    GLint pixels = -1, depths = -1, origin = -1, nearest = -1;
  };

  std::shared_ptr<const VolumeModel> model_of(const std::shared_ptr<const qnv::Cloud>& cloud, std::size_t counted);
  void forget_models();
  void gather(const RenderList& list, const Camera& camera, const SplatView& view,
              const DrawOptions& options, Scene& scene);
  void on_processor(const Scene& scene, const SplatView& view, const Projection& projection, const DrawOptions& options,
                    FrameStatistics& statistics);
  void lay_over(const VolumeLayer& layer, const std::vector<float>& depths, const Projection& projection,
                const DrawOptions& options);
  void draw_overlay(const Overlay& overlay, const VolumeLayer& layer, const std::vector<std::uint8_t>& pixels,
                    const Projection& projection, const DrawOptions& options);
  Overlay make_overlay(const char* defines) const;

  const Gl& gl_;
  VolumeGl volume_gl_;
  VolumeTarget target_;
  TargetDepths depths_;
  VertexArray no_attributes_;
  Texture pixels_texture_, depths_texture_;
  Overlay overlay_, edge_overlay_;
  std::unordered_multimap<const qnv::Cloud*, Held> models_;  // of clouds that somebody else still holds
  std::uint64_t frame_ = 0;
};

}  // namespace gs::render
