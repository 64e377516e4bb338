#pragma once

#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/volume/volume_raster.h"

#include <array>
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

/// Render target for volumes. Copies the depth of the framebuffer that is bound for drawing. Has an image of 16 bits
/// per channel, which is composited over that framebuffer. Runs on the thread of its context.
///
/// All functions except `begin` keep the framebuffer bindings. They change viewport and scissor, and leave depth test
/// and blending off.
class VolumeTarget {
 public:
  explicit VolumeTarget(const Gl& gl);

  /// Reads the depth of an image that was drawn with `projection`. Returns false if the context does not support this.
  bool read_depths(const TargetRectangle& rectangle, const Projection& projection, TargetDepths& depths);

  /// Binds a framebuffer with the same number of samples. Its origin has the rectangle's depth; its colour is empty. On
  /// failure, returns false and keeps the previous framebuffer.
  bool begin(const TargetRectangle& rectangle);
  /// Composites the premultiplied image that was drawn after `begin` over the rectangle of the previous framebuffer.
  void end();

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
  void lay_over(int sample);

  const Gl& gl_;
  VertexArray no_attributes_;
  Program single_, multiple_, extremes_;
  int width_ = 0, height_ = 0, samples_ = 0;  // size of the textures; `samples_` is 1 without multisampling
  GLenum depth_format_ = 0;
  bool colored_ = false;
  Texture color_, depth_;
  Framebuffer framebuffer_;
  Texture extreme_depths_;  // minimum and maximum of the samples of each pixel
  Framebuffer extremes_framebuffer_;
  int extremes_width_ = 0, extremes_height_ = 0;
  Bound outer_;
  TargetRectangle rectangle_;
};

}  // namespace gs::render
