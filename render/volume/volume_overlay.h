#pragma once

#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/volume/volume_raster.h"

#include <cstdint>
#include <vector>

namespace gs::render {

/// Composites layers that were rasterized on the CPU over the bound framebuffer. Runs on the thread of its context.
class VolumeOverlay {
 public:
  explicit VolumeOverlay(const Gl& gl);

  /// Composites a layer with premultiplied colours, which was rasterized with `stops`. Tests depths only if the samples
  /// of a pixel differ, or if there are no stops. A layer without depths is in front of everything. Writes no depth.
  /// Leaves blending and the depth test off, and depth writes on.
  void draw(const VolumeLayer& layer, const VolumeStops& stops, const Projection& projection,
            const DrawOptions& options);

 private:
  /// Texture that is at least as large as the last layer. Later layers reuse it.
  struct LayerTexture {
    Texture texture;
    int width = 0, height = 0;
  };
  struct Overlay {
    Program program;
    GLint pixels = -1, depths = -1, origin = -1, nearest = -1;
  };
  [[nodiscard]] Overlay make_overlay(const char* defines) const;
  void draw_plain(const VolumeLayer& layer, const DrawOptions& options);
  /// Copies a box of an image into the corner of a texture. Rows of the image have `pitch` pixels.
  void upload(LayerTexture& to, GLenum internal, GLenum format, GLenum type, const void* first, const PixelBox& box,
              int pitch);
  void draw_overlay(const Overlay& overlay, const VolumeLayer& layer, const std::vector<std::uint8_t>& pixels,
                    const Projection& projection, const DrawOptions& options);

  const Gl& gl_;
  VertexArray no_attributes_;
  LayerTexture pixels_texture_, depths_texture_;
  Program plain_;
  GLint plain_pixels_ = -1, plain_part_ = -1;
  Overlay overlay_, edge_overlay_;
};

}  // namespace gs::render
