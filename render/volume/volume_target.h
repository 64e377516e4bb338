#pragma once

#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/volume/layers_together.h"
#include "render/volume/volume_raster.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace gs::render {

/// Rectangle of a framebuffer in pixels.
struct TargetRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Depths of the existing image in camera units, in the form of VolumeStops.
struct TargetDepths {
  std::vector<float> near, far;  // `far` is empty if no pixel has several samples
  [[nodiscard]] VolumeStops stops() const { return {near, far}; }
};

/// Splats that are drawn together.
struct SplatRange {
  std::size_t first = 0, count = 0;  // places in the order
  bool near_first = true;            // the order begins with the nearest splat, else with the farthest
  float gain = 1;                    // factor of the colours
  /// Bounds of the depths: splats up to `nearest` and beyond `farthest` are not drawn.
  float nearest = 0, farthest = std::numeric_limits<float>::max();
};

/// View of splats that are blended.
struct BlendedView {
  SplatView lens;  // `camera_from_node` and `supersample` are ignored
  Projection projection;
  TargetRectangle rectangle;  // rectangle of the bound framebuffer
  std::uint32_t viewport = 0;
};
/// Result of drawing it.
struct BlendedSplats {
  std::size_t vectors = 0;  // splats in view; estimated if there are many
  bool pending = false;     // the order is that of an earlier view: draw again
};
/// Splats in memory of OpenGL, with their order. Valid until their owner prepares others.
struct PreparedSplats {
  BlendedSplats found;
  std::size_t total = 0;  // number of splats in the order; 0 if none is in view
  std::function<void(const SplatRange&)> draw;
};
/// Range of splats for one draw call. The order begins with the nearest splat.
struct BlendedPart {
  const PreparedSplats* splats = nullptr;
  SplatRange range;
};

/// Returns one part per slab, in the order of the slabs.
[[nodiscard]] std::vector<BlendedPart> parts_in_slabs(const std::array<const PreparedSplats*, 2>& contents,
                                                      std::span<const DepthSlab> slabs);
/// Divides all splats into ranges. Near splats make many pixels opaque, so the first ranges are small.
[[nodiscard]] std::vector<BlendedPart> growing_parts(const PreparedSplats& splats);

/// Render target for splats that are blended in the order of their depths: volumes and Gaussians. Copies the depth of
/// the framebuffer that is bound for drawing. Its image has 16 bits per channel and one sample per pixel. Runs on the
/// thread of its context.
///
/// All functions keep the framebuffer bindings. They change viewport and scissor, and leave depth test and blending
/// off.
class VolumeTarget {
 public:
  explicit VolumeTarget(const Gl& gl);

  /// Reads the depth of an image that was drawn with `projection`. Returns false if the context does not support this.
  bool read_depths(const TargetRectangle& rectangle, const Projection& projection, TargetDepths& depths);

  /// Blends splats of premultiplied colours over the rectangle of the framebuffer, behind its depths. `parts` begin
  /// with the nearest one. Draws them into a layer, and composites it. Between two parts, excludes the pixels that are
  /// opaque. `gain` multiplies the colours of the layer.
  ///
  /// With multisampling, the layer has the depth of the farthest sample of each pixel. If the samples of some pixels
  /// belong to different surfaces, draws again for these pixels, with the depths of their nearest samples. The result
  /// then covers the samples that are nearer than the middle of both depths, as in VolumeOverlay.
  ///
  /// If the context does not support layers, draws all splats from far to near, without gain.
  void blend(const TargetRectangle& rectangle, const Projection& projection, std::span<const BlendedPart> parts,
             float gain = 1);

 private:
  struct Bound {
    GLint draw = 0, read = 0;
  };
  [[nodiscard]] Bound bound() const;
  void bind(const Bound& framebuffers) const;
  /// Finds possible depth formats of the bound framebuffer; 0 means no format. Returns false if the framebuffer has no
  /// depth.
  bool depth_formats(std::array<GLenum, 2>& formats) const;
  bool make(int width, int height, int samples, GLenum depth_format, bool colored);
  bool copy_depth(const Bound& from, const TargetRectangle& rectangle, bool colored);
  bool read_samples(const TargetRectangle& rectangle, std::vector<float>& both);
  void attach(const Texture& texture, GLenum attachment, GLenum internal, GLenum format, GLenum type);
  bool make_layer(int width, int height);
  bool make_programs(bool several);
  bool prepare(const TargetRectangle& rectangle, bool several);
  Framebuffer closing_for(const Texture& depth, bool stencil) const;
  void begin_blending(const Projection& projection, bool near_first);
  void blend_parts(const Projection& projection, std::span<const BlendedPart> parts, float gain);
  void close_opaque(const Projection& projection);
  void draw_several(const TargetRectangle& rectangle, const Projection& projection,
                    const std::function<void()>& blend_layer, float gain);
  void fill(const Program& program, const Projection& projection);
  void composite(const Program& program, const Texture& layer, const TargetRectangle& rectangle,
                 const Projection& projection, float gain);

  const Gl& gl_;
  VertexArray no_attributes_;
  Program single_, extremes_, closing_;
  Program far_depths_, edge_depths_, far_layer_, edge_layer_;  // for pixels with several samples
  Query edges_;
  int width_ = 0, height_ = 0, samples_ = 0;  // size of the textures; `samples_` is 1 without multisampling
  GLenum depth_format_ = 0;
  bool colored_ = false;
  Texture color_, depth_;
  Framebuffer framebuffer_, framebuffer_closing_;  // the second has only the depth
  Texture extreme_depths_;                         // minimum and maximum of the samples of each pixel
  Framebuffer extremes_framebuffer_;
  int extremes_width_ = 0, extremes_height_ = 0;
  Texture layer_color_, layer_depth_;  // one sample per pixel
  Framebuffer layer_, layer_closing_;
  int layer_width_ = 0, layer_height_ = 0;
  Bound outer_;
  std::vector<float> read_depths_;  // memory for read_depths()
};

}  // namespace gs::render
