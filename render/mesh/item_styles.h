#pragma once

#include "base/noncopyable.h"
#include "render/gl/fog_uniforms.h"
#include "render/gl/gpu.h"
#include "render/scene/render_list.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::render {

/// Uniforms of a program with the style shaders.
struct StyleUniforms {
  GLint clip_planes = -1, point_size = -1, point_attenuation = -1, line_pattern = -1, hatch = -1, hatch_color = -1,
        pixel_side = -1, sprite = -1;
  StyleUniforms() = default;
  StyleUniforms(const Gl& gl, GLuint program);
};

/// ClipPlanes, line, point and fill properties, and LocalFogs of the items of a frame. Items with equal ones share a
/// number; 0 means none of them.
class ItemStyles : NonCopyable {
 public:
  /// Data of a frame that styles depend on.
  struct Frame {
    const RenderList* list = nullptr;
    glm::dmat4 camera_from_world{1.0};
    glm::mat3 world_from_camera{1.0f};
    CameraFog fog;
    float pixel_side = 1;
  };

  explicit ItemStyles(const Gl& gl) : gl_(gl) {}

  [[nodiscard]] static bool has_style(const DrawItem& item);
  /// Discards the styles of the previous frame.
  void begin_frame(const Frame& frame);
  /// Returns the number of an item's style in this frame.
  [[nodiscard]] std::uint32_t number_of(const DrawItem& item, GLenum primitive);
  [[nodiscard]] bool has_fog(std::uint32_t number) const { return bindings_[number].fog.on; }
  /// Sets the uniforms and the state of a style for the current program.
  void apply(std::uint32_t number, const StyleUniforms& at, const FogUniforms& fog);
  /// Restores the state that apply() changed.
  void end();

 private:
  struct Binding {
    ClipList clip_planes;
    std::shared_ptr<const ShapeStyle> shape;
    std::uint16_t local_fog = kNoLocalFog;
    GLenum primitive = GL_TRIANGLES;
    std::size_t planes = 0;
    std::array<glm::vec4, kMaxClipPlanes> camera_planes;
    CameraFog fog;
  };

  const Gl& gl_;
  Frame frame_;
  std::vector<Binding> bindings_;
  bool applied_ = false;  // apply() changed the state of OpenGL
};

}  // namespace gs::render
