#pragma once

#include "render/gl/gpu.h"
#include "render/mesh/mesh_pass.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"

#include <functional>

namespace gs::render {

/// Draws the pictures of the scene around items (X3D GeneratedCubeMapTexture): six faces each. Thread of the context.
class CubePass {
 public:
  /// Function that draws the scene for a camera into the bound framebuffer.
  using Draw = std::function<void(const Camera& camera, const DrawOptions& options)>;

  explicit CubePass(const Gl& gl) : gl_(gl) {}
  /// Draws the cubes that items of the list need and that are out of date. Keeps the bound framebuffer. Does nothing
  /// if it is called by `draw`.
  void draw(const RenderList& list, const DrawOptions& options, MeshPass& meshes, const Draw& draw);

 private:
  void draw_faces(const MeshPass::CubeRequest& request, const LayerTextures::SceneTexture& to,
                  const DrawOptions& options, const Draw& draw);

  const Gl& gl_;
  Framebuffer framebuffer_;
  Renderbuffer depth_;
  int depth_size_ = 0;
  bool drawing_ = false;
};

}  // namespace gs::render
