#pragma once

#include "render/camera.h"
#include "render/gpu.h"
#include "render/render_list.h"
#include "render/renderer.h"
#include "render/volume_raster.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// What the viewer chooses for all volumes.
struct VolumeSettings {
  float opacity = VolumeOptions{}.opacity;
  float least_magnitude = 0;      // shorter gradients are left out
  std::optional<glm::vec4> clip;  // world space: what has clip.xyz . position + clip.w < 0 is left out
};

/// Draws the volumes of a RenderList (SplatItems whose cloud's kind is Kind::volume, and no others): blends their
/// vectors on the processor and lays the result over what has been drawn. Colours are those of the
/// transfer function; of the material only the transparency counts. Up to four lights of the world and the headlight
/// shade the vectors: the directional ones first, then the point and spot lights that are strongest at its centre.
///
/// Every pixel of a volume has one depth, that where its opacity comes to a half, and is hidden as a whole where
/// something drawn before is nearer. So polygons in front of a volume and behind it are right; one inside it is
/// hidden where the half lies before it, and else hides the whole volume in its pixels, the faint parts in front
/// of it too. Writes no depth, so that transparent polygons drawn later are blended over volumes. Volumes are drawn in
/// the order of their centres, the farthest first; where two overlap in space they are not mixed.
class VolumePass {
 public:
  /// Nothing is drawn when the driver refuses the shader.
  explicit VolumePass(const Gl& gl);

  /// `camera` must have its near and far planes set. Call when everything opaque has been drawn. Leaves blending and
  /// the depth test off, and depth writable.
  void draw(const RenderList& list, const Camera& camera, const glm::mat4& clip_from_camera, const DrawOptions& options,
            FrameStatistics& statistics);

  VolumeSettings settings;

 private:
  struct Held {
    std::weak_ptr<const qnv::Cloud> cloud;
    VolumeModel model;
  };
  const VolumeModel& model_of(const std::shared_ptr<const qnv::Cloud>& cloud);
  void lay_over(const VolumeLayer& layer, const glm::mat4& clip_from_camera, const DrawOptions& options);

  const Gl& gl_;
  VertexArray no_attributes_;
  Texture pixels_, depths_;
  Program program_;
  GLint pixels_at_ = -1, depths_at_ = -1, origin_at_ = -1, depth_row_at_ = -1;
  std::unordered_map<const qnv::Cloud*, Held> models_;  // of clouds that somebody else still holds
};

/// The lights that shade an item whose centre is `center`, camera space; what VolumePass uses.
[[nodiscard]] std::vector<VolumeLight> volume_lights(const RenderList& list, const SplatItem& item,
                                                     const glm::mat4& camera_from_world, const glm::vec3& center,
                                                     bool headlight);

}  // namespace gs::render
