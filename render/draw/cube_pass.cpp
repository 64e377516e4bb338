#include "render/draw/cube_pass.h"

#include <glm/geometric.hpp>

#include <array>
#include <numbers>

namespace gs::render {
namespace {

/// View axes of a face of OpenGL's cube.
struct CubeWay {
  glm::dvec3 ahead, up;
};
constexpr std::array<CubeWay, 6> kCubeWays = {{
    {{1, 0, 0}, {0, -1, 0}},
    {{-1, 0, 0}, {0, -1, 0}},
    {{0, 1, 0}, {0, 0, 1}},
    {{0, -1, 0}, {0, 0, -1}},
    {{0, 0, 1}, {0, -1, 0}},
    {{0, 0, -1}, {0, -1, 0}},
}};

}  // namespace

void CubePass::draw(const RenderList& list, const DrawOptions& options, MeshPass& meshes, const Draw& draw) {
  if (drawing_) return;
  const auto requests = meshes.cubes_to_draw(list);
  if (requests.empty()) return;
  GLint outer = 0;
  gl_.GetIntegerv(GL_FRAMEBUFFER_BINDING, &outer);
  drawing_ = true;
  for (const MeshPass::CubeRequest& request : requests) {
    const LayerTextures::SceneTexture& texture = meshes.begin_cube(request, list);
    draw_faces(request, texture, options, draw);
    meshes.end_cube();
  }
  drawing_ = false;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(outer));
}

void CubePass::draw_faces(const MeshPass::CubeRequest& request, const LayerTextures::SceneTexture& to,
                          const DrawOptions& given, const Draw& draw) {
  if (!framebuffer_) framebuffer_ = make_framebuffer(gl_);
  if (depth_size_ != to.size) {
    depth_ = make_renderbuffer(gl_);
    depth_size_ = to.size;
    gl_.BindRenderbuffer(GL_RENDERBUFFER, depth_.name());
    gl_.RenderbufferStorageMultisample(
        GL_RENDERBUFFER, 0, gl_.ClipControl ? GL_DEPTH_COMPONENT32F : GL_DEPTH_COMPONENT24, to.size, to.size);
  }
  DrawOptions options = given;
  options.x = options.y = 0;
  options.width = options.height = to.size;
  options.samples = options.target_samples = options.pixel_side = 1;
  options.coarseness = 1;
  options.guides = nullptr;
  options.go_on = nullptr;
  Camera camera;
  camera.field_of_view = std::numbers::pi_v<float> / 2;
  for (std::size_t face = 0; face < kCubeWays.size(); ++face) {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
                             static_cast<GLenum>(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face), to.texture.name(), 0);
    if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return;
    const glm::dvec3 back = -kCubeWays[face].ahead, right = glm::cross(kCubeWays[face].ahead, kCubeWays[face].up);
    camera.world_from_camera = glm::dmat4(glm::dvec4(right, 0), glm::dvec4(kCubeWays[face].up, 0), glm::dvec4(back, 0),
                                          glm::dvec4(request.center, 1));
    draw(camera, options);
  }
}

}  // namespace gs::render
