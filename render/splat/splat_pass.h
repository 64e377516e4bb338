#pragma once

#include "render/gl/fog_uniforms.h"
#include "render/gl/gpu.h"
#include "render/gl/light_sets.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/fog.h"
#include "render/scene/render_list.h"
#include "render/splat/software/splat_raster.h"
#include "render/splat/splat_gl.h"

#include <glm/mat4x4.hpp>

#include <optional>
#include <span>
#include <unordered_map>

namespace gs::render {

/// Draws the splat items of a RenderList. Rasterizes them on the CPU or with OpenGL. Then shades each pixel with the
/// scene's lights and tests it against the existing depth.
class SplatPass {
 public:
  explicit SplatPass(const Gl& gl);

  /// Draws the splat items. `camera` must have near and far planes. Leaves blending and the depth test off.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            FrameStatistics& statistics);

  /// Shades the result of another CPU rasterizer for an item. `options` as for `draw`.
  void draw_layer(const SplatLayer& layer, const RenderList& list, const DrawItem& item, const Camera& camera,
                  const Projection& projection, const DrawOptions& options);

 private:
  struct Shader {
    Program program;
    GLint normals = -1, depths = -1, colors = -1, origin = -1, size = -1, rectangle = -1, corner = -1, closing = -1,
          pixel = -1, tangents = -1, middle = -1, depth_row = -1, base = -1, emissive_ambient = -1,
          specular_exponent = -1;
    FogUniforms fog;
    LightUniforms lights;
  };
  /// Returns the shader for a variant. Returns null if the driver rejected it. `lights` is a LightSets::variant.
  const Shader* shader(bool colored, bool closing, bool fog, unsigned lights);
  /// Shades the pixels. `closing` is the maximum width in pixels of holes that the shader must close.
  void shade(const Material& material, const SplatTextures& textures, int closing, std::uint32_t light_set,
             const CameraFog& fog, const Projection& projection, const DrawOptions& options);
  SplatTextures upload(const SplatLayer& layer);
  /// Rasterizes with OpenGL. Returns nullopt if OpenGL is not requested or unavailable.
  std::optional<SplatTextures> with_gl(std::span<const SharedSplatPiece> pieces, const SplatView& view,
                                       const DrawOptions& options);
  /// Rasterizes on the CPU. `whole` is the view of the whole image, `view` that of a tile.
  SplatTextures on_processor(std::span<const SharedSplatPiece> pieces, const SplatView& view, const SplatView& whole);
  void upload(const Texture& texture, int unit, GLenum internal, GLenum format, GLenum type, const SplatLayer& layer,
              const void* pixels);

  const Gl& gl_;
  LightSets lights_;
  SplatGl splat_gl_;
  VertexArray no_attributes_;
  Texture normals_, depths_, colors_;
  std::unordered_map<unsigned, Shader> shaders_;
};

}  // namespace gs::render
