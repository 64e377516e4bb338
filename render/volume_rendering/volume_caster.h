#pragma once

#include "render/gl/fog_uniforms.h"
#include "render/gl/gpu.h"
#include "render/gl/light_sets.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/volume_rendering/voxel_textures.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Draws volumes of X3D (DrawItem::volume) by casting rays through their boxes in a fragment shader, over the opaque
/// objects. Rays begin at the viewer or at the box, and end at the opaque objects; the depth of each pixel is that of
/// one of its samples. Styles are GLSL that volume_source() makes; each combination of styles is one program.
class VolumeCaster {
 public:
  explicit VolumeCaster(const Gl& gl);

  /// Volume to draw in a frame, with its place in front of the camera.
  struct Cast {
    const DrawItem* item;
    glm::vec3 center;  // in viewer space
    float radius;      // of its sphere; negative if unknown
    float depth;       // distance of the centre from the camera along the view axis
    std::uint32_t lights = 0;
  };
  /// Image that the volumes are drawn in. Positions are relative to the viewer, `projection.back` before the camera.
  struct View {
    const RenderList* list;
    glm::dmat4 viewer_from_world;
    glm::mat3 world_from_camera;
    Projection projection;
    float near_plane;
    const DrawOptions* options;
  };

  /// Prepares the volumes of a frame: sorts them from back to front. Keeps the view, which must outlive the frame.
  void begin(const View& view, std::vector<Cast>& casts);
  /// Draws a volume. Returns false if `go_on` has cancelled the frame. Leaves blending and the depth test off, depth
  /// writes on and culling off.
  bool draw(const Cast& cast);
  /// Returns the error message of the last program that the driver rejected; empty if there is none.
  [[nodiscard]] const std::string& last_error() const { return last_error_; }

 private:
  struct Binding {
    GLint location;
    GLuint unit;
    GLenum target;
  };
  /// Program of a combination of styles, with the locations of its uniforms by step.
  struct Shader {
    Program program;
    LightUniforms lights;
    FogUniforms fog;
    std::unordered_map<std::string, GLint> places;
  };
  /// Data of a look that does not depend on the view.
  struct Prepared {
    std::weak_ptr<const VolumeLook> look;
    std::uint64_t version = 0;  // of the image
    std::string defines, code;
    bool lit = false;
    Texture blocks;
    std::array<std::uint32_t, 3> block_size{};
  };

  Prepared& prepare(const std::shared_ptr<const VolumeLook>& look, const VoxelTextures::Volume& volume);
  Shader* shader_of(const Prepared& prepared, bool fog);
  GLint place(Shader& shader, const std::string& name);
  void bind(Shader& shader, const std::string& name, GLenum target, GLuint texture);
  void bind_steps(Shader& shader, const VolumeLook& look);
  void set_volume(Shader& shader, const DrawItem& item, const VoxelTextures::Volume& volume);
  void set_clip_planes(Shader& shader, const DrawItem& item);
  bool copy_depths();
  bool make_depths(GLenum format, int width, int height);
  bool cast_rays();

  const Gl& gl_;
  VoxelTextures textures_;
  LightSets lights_;
  VertexArray no_attributes_;
  std::unordered_map<std::string, Shader> shaders_;
  std::unordered_map<const VolumeLook*, Prepared> prepared_;
  std::string last_error_;
  View view_{};
  GLuint next_unit_ = 0;  // texture unit of the next texture
  Texture depths_;
  Framebuffer depth_target_;
  GLenum depth_format_ = 0;
  int depth_width_ = 0, depth_height_ = 0;
  bool depths_copied_ = false;  // in this frame
  glm::mat4 viewer_from_box_{1.0f};
};

}  // namespace gs::render
