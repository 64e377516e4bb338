#include "render/volume/volume_overlay.h"

#include "render/gl/shaders.h"
#include "render/volume/volume_shaders.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

/// Returns depths in window space for compositing a layer; -1 means no depth test. If the samples of a pixel differ in
/// depth, the result is between their depths. Without stops, it is the depth at which the pixel becomes opaque.
std::vector<float> window_depths(const VolumeLayer& layer, const VolumeStops& stops, const Projection& projection) {
  std::vector<float> depths(static_cast<std::size_t>(layer.width) * static_cast<std::size_t>(layer.height), -1.0f);
  const auto window = [&](float depth) {
    const float at = projection.window_depth(depth);
    return at > 0 ? std::min(at, 1.0f) : 0.0f;
  };
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (stops.near.empty()) {
      if (!layer.depth.empty() && layer.depth[i] > 0) depths[i] = window(layer.depth[i]);
    } else if (!layer.edge_pixels.empty() && stops.near[i] != stops.far[i]) {
      depths[i] = 0.5f * (window(stops.near[i]) + window(stops.far[i]));
    }
  }
  return depths;
}

}  // namespace

VolumeOverlay::VolumeOverlay(const Gl& gl)
    : gl_(gl),
      no_attributes_(make_vertex_array(gl)),
      pixels_texture_{make_texture(gl)},
      depths_texture_{make_texture(gl)} {
  for (const LayerTexture* texture : {&pixels_texture_, &depths_texture_}) {
    gl.BindTexture(GL_TEXTURE_2D, texture->texture.name());
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  }
  auto made = make_program(gl_, "", kPlainLayerVertexShader, kPlainLayerFragmentShader);
  if (auto* program = std::get_if<Program>(&made)) {
    plain_ = std::move(*program);
    plain_pixels_ = gl_.GetUniformLocation(plain_.name(), "pixels");
    plain_part_ = gl_.GetUniformLocation(plain_.name(), "part");
  }
  overlay_ = make_overlay("");
  edge_overlay_ = make_overlay("#define EDGES\n");
}

VolumeOverlay::Overlay VolumeOverlay::make_overlay(const char* defines) const {
  Overlay overlay;
  auto made = make_program(gl_, defines, kScreenVertexShader, kVolumePixelsFragmentShader);
  auto* program = std::get_if<Program>(&made);
  if (!program) return overlay;
  overlay.program = std::move(*program);
  overlay.pixels = gl_.GetUniformLocation(overlay.program.name(), "pixels");
  overlay.depths = gl_.GetUniformLocation(overlay.program.name(), "depths");
  overlay.origin = gl_.GetUniformLocation(overlay.program.name(), "origin");
  overlay.nearest = gl_.GetUniformLocation(overlay.program.name(), "nearest");
  return overlay;
}

void VolumeOverlay::upload(LayerTexture& to, GLenum internal, GLenum format, GLenum type, const void* first,
                           const PixelBox& box, int pitch) {
  gl_.BindTexture(GL_TEXTURE_2D, to.texture.name());
  if (to.width < box.width || to.height < box.height) {
    to.width = std::max(to.width, box.width);
    to.height = std::max(to.height, box.height);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), to.width, to.height, 0, format, type, nullptr);
  }
  gl_.PixelStorei(GL_UNPACK_ROW_LENGTH, pitch);
  gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, box.width, box.height, format, type, first);
  gl_.PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

/// Composites the farthest samples of a layer without a depth test.
void VolumeOverlay::draw_plain(const VolumeLayer& layer, const DrawOptions& options) {
  const PixelBox& box = layer.used;
  if (!plain_ || box.width <= 0 || box.height <= 0) return;
  const std::size_t first =
      static_cast<std::size_t>(box.bottom) * static_cast<std::size_t>(layer.width) + static_cast<std::size_t>(box.left);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindSampler(0, 0);
  upload(pixels_texture_, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, layer.pixels.data() + 4 * first, box, layer.width);
  gl_.Viewport(options.x + box.left, options.y + box.bottom, box.width, box.height);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.UseProgram(plain_.name());
  gl_.Uniform1i(plain_pixels_, 0);
  gl_.Uniform2f(plain_part_, static_cast<float>(box.width) / static_cast<float>(pixels_texture_.width),
                static_cast<float>(box.height) / static_cast<float>(pixels_texture_.height));
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  gl_.Viewport(options.x, options.y, options.width, options.height);
}

void VolumeOverlay::draw_overlay(const Overlay& overlay, const VolumeLayer& layer,
                                 const std::vector<std::uint8_t>& pixels, const Projection& projection,
                                 const DrawOptions& options) {
  if (!overlay.program) return;
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindSampler(0, 0);
  upload(pixels_texture_, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data(), {0, 0, layer.width, layer.height},
         layer.width);
  gl_.UseProgram(overlay.program.name());
  gl_.Uniform1i(overlay.pixels, 0);
  gl_.Uniform1i(overlay.depths, 1);
  gl_.Uniform2i(overlay.origin, options.x, options.y);
  gl_.Uniform1f(overlay.nearest, projection.nearest_depth());
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void VolumeOverlay::draw(const VolumeLayer& layer, const VolumeStops& stops, const Projection& projection,
                         const DrawOptions& options) {
  gl_.Viewport(options.x, options.y, options.width, options.height);
  gl_.Scissor(options.x, options.y, options.width, options.height);
  gl_.DepthMask(GL_FALSE);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  // If there are stops, the layer has no splats behind them.
  const bool plain = layer.edge_pixels.empty() && (layer.depth.empty() || !stops.near.empty());
  if (plain) {
    draw_plain(layer, options);
    gl_.DepthMask(GL_TRUE);
    gl_.Disable(GL_BLEND);
    return;
  }
  const std::vector<float> depths = window_depths(layer, stops, projection);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(projection.reversed ? GL_GEQUAL : GL_LEQUAL);
  gl_.ActiveTexture(GL_TEXTURE1);
  gl_.BindSampler(1, 0);
  upload(depths_texture_, GL_R32F, GL_RED, GL_FLOAT, depths.data(), {0, 0, layer.width, layer.height}, layer.width);
  draw_overlay(overlay_, layer, layer.pixels, projection, options);
  if (!layer.edge_pixels.empty()) {
    // Draw the samples of each pixel that the first draw excluded.
    gl_.DepthFunc(projection.reversed ? GL_LESS : GL_GREATER);
    draw_overlay(edge_overlay_, layer, layer.edge_pixels, projection, options);
  }
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
}

}  // namespace gs::render
