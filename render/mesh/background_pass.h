#pragma once

#include "render/gl/gpu.h"
#include "render/gl/texture_store.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include <optional>

namespace gs::render {

/// Fills the viewport with the world's Background (VRML97 6.5), or with one colour.
class BackgroundPass {
 public:
  static std::variant<BackgroundPass, ContextError> create(const Gl& gl);

  /// Draws the Background, or `color` if it is set. Uses the tangents and centre of `lens`. The scissor test must be on
  /// and cover the viewport; depth writes must be off.
  void draw(const Background& background, const glm::mat3& world_from_camera, const Projection& lens,
            const std::optional<glm::vec3>& color);
  /// Draws a neutral gradient. A tile of an image draws its part of the gradient. Needs the GL state that draw() needs.
  void draw_backdrop(const PicturePart& part, const DrawOptions& options);

 private:
  BackgroundPass(const Gl& gl, Program program);
  int upload_rings(const Background& background, int& ground_count);
  void draw_rings(const Background& background, const glm::mat3& world_from_camera, const Projection& lens);
  void draw_panorama(const Background& background, const glm::mat3& world_from_camera, const Projection& lens);

  const Gl* gl_;
  Program program_;
  VertexArray no_attributes_;
  Texture rings_;
  GLint background_from_camera_, tangents_, center_, counts_;
  TextureStore textures_;
  // made with the first panorama; empty if the driver rejects the program
  Program panorama_;
  bool drawn_ = false;
  bool tried_panorama_ = false;
  GLint camera_from_face_ = -1, panorama_tangents_ = -1, panorama_center_ = -1;
};

}  // namespace gs::render
