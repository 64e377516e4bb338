#pragma once

#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/volume/layers_together.h"
#include "render/volume/volume_gl.h"
#include "render/volume/volume_lights.h"
#include "render/volume/volume_overlay.h"
#include "render/volume/volume_raster.h"
#include "render/volume/volume_target.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Draws the volumes of a RenderList (only SplatItems with a qnv::Volume): blends the vectors of all of
/// them by depth, with OpenGL or on the CPU, over the existing image. Colours are those of DrawOptions::splat_style; of
/// the material only the transparency counts. volume_lights() selects the lights. If the budget (share_budget) excludes
/// some vectors, a volume shows a prefix of its progressive order.
///
/// The existing image hides vectors behind it per sample, so that polygons before, inside and behind a volume are
/// correct. If the CPU path cannot read depth back, each volume pixel is hidden as a whole. Its depth is that at which
/// its opacity reaches 0.5. Writes no depth, so that later transparent polygons blend over volumes.
class VolumePass {
 public:
  explicit VolumePass(const Gl& gl, SortMethod sort = SortMethod::automatic);

  /// Content that shares depths with the volumes.
  struct Overlap {
    LayerRaster rasterize;
    PreparedSplats prepared;
    bool with_gl = false;  // `prepared` is valid
    float gain = 1;        // factor of the colours of the layer of OpenGL
    SharedDepths shared;
  };
  /// Draws the volumes. Call it after all opaque content. `camera` must have near and far planes. Leaves blending and
  /// the depth test off, and depth writes on. Draws an `overlap`, too, in slabs of depth: by `prepared` if OpenGL draws
  /// the volumes, otherwise both on the CPU.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            FrameStatistics& statistics, const Overlap* overlap = nullptr);

  /// Returns the method that sorted for the last OpenGL image.
  [[nodiscard]] SortMethod sorted_by() const { return volume_gl_.sorted_by(); }

 private:
  struct Held {
    std::weak_ptr<const qnv::Volume> volume;
    std::size_t counted = 0;
    std::shared_ptr<const VolumeModel> model;
    std::uint64_t used = 0;
  };
  /// Volumes of one image. `items` point into the other members.
  struct Scene {
    std::vector<SharedVolume> held;
    std::vector<VolumeItem> items;
    std::vector<std::vector<VolumeLight>> lights;
    VolumeTransfer transfer{};
    std::unordered_map<const qnv::ChunkRequests*, std::uint32_t> instances;  // of each stream so far
    bool working = false;  // finer vectors of a stream are being decoded
  };
  std::shared_ptr<const VolumeModel> model_of(const std::shared_ptr<const qnv::Volume>& volume, std::size_t counted);
  void forget_models();
  static std::shared_ptr<const qnv::Volume> cut(const qnv::Volume& volume, const SplatItem& item, SplatView view,
                                                const glm::mat4& camera_from_node, const std::optional<glm::vec4>& clip,
                                                const DrawOptions& options, Scene& scene);
  void gather(const RenderList& list, const Camera& camera, const SplatView& view,
              const DrawOptions& options, Scene& scene);
  void on_processor(const Scene& scene, const SplatView& view, const Projection& projection, const DrawOptions& options,
                    FrameStatistics& statistics, const Overlap* overlap);

  const Gl& gl_;
  VolumeGl volume_gl_;
  VolumeTarget target_;
  TargetDepths depths_;
  VolumeOverlay overlay_;
  std::unordered_multimap<const qnv::Volume*, Held> models_;  // of volumes with other owners
  std::uint64_t frame_ = 0;
};

}  // namespace gs::render
