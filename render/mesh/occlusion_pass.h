#pragma once

#include "render/gl/gpu.h"
#include "render/scene/camera.h"

#include <glm/vec2.hpp>

namespace gs::render {

/// Ambient occlusion in screen space: darkens opaque surfaces near other surfaces, by the depths of the picture. Uses
/// the estimator of scalable ambient obscurance (McGuire, Mara and Luebke, 2012). Thread of the context.
class OcclusionPass {
 public:
  explicit OcclusionPass(const Gl& gl) : gl_(gl), no_attributes_(make_vertex_array(gl)) {}

  /// Darkens the bound framebuffer, in which `size` pixels from the lower left corner are drawn. Surfaces at most
  /// `radius` away (world units) darken each other. Draws nothing if the driver lacks a feature. Leaves the framebuffer
  /// bound, the depth test off and blending off.
  void draw(const Projection& projection, const glm::ivec2& size, float radius);

 private:
  struct Target {
    Texture texture;
    Framebuffer framebuffer;
  };
  [[nodiscard]] bool prepare(const glm::ivec2& size, int samples, GLenum depth_format);
  [[nodiscard]] Target make_target(GLenum format, GLenum components, GLenum type, GLenum attachment, int samples) const;
  void fill(const Program& program, const Texture& texture, GLenum kind) const;

  const Gl& gl_;
  VertexArray no_attributes_;
  Program occlusion_, occlusion_of_samples_, smoothing_;
  bool unusable_ = false;  // the driver rejected a shader or a framebuffer
  glm::ivec2 size_{0};
  int samples_ = 0;
  GLenum depth_format_ = 0;
  Target depth_, factors_;
};

}  // namespace gs::render
