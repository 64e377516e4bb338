#pragma once

#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/volume/volume_raster.h"

#include <array>
#include <vector>

namespace gs::render {

/// A rectangle of a framebuffer, pixels.
struct TargetRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Depth that has been drawn, in camera units, as VolumeStops wants it.
struct TargetDepths {
  std::vector<float> near, far;  // far: only where a pixel has several samples
  [[nodiscard]] VolumeStops stops() const { return {near, far}; }
};

/// What volumes are drawn into or compared with: copies of the depth of the framebuffer that is bound for drawing, and
/// a picture of 16 bits a channel that is laid over it. Belongs to the thread of its context.
///
/// All methods leave the framebuffers as they were but `begin`, and no texture or vertex array bound that matters;
/// they set the viewport and the scissor, and leave the depth test and blending off.
class VolumeTarget {
 public:
  explicit VolumeTarget(const Gl& gl);

  /// Reads the depth that a picture under `projection` has left. False when this context cannot.
  bool read_depths(const TargetRectangle& rectangle, const Projection& projection, TargetDepths& depths);

  /// Binds a framebuffer of as many samples, with the rectangle's depth and no colour yet, at the origin. False when
  /// this context cannot: then the framebuffer that was bound still is.
  bool begin(const TargetRectangle& rectangle);
  /// Lays what was drawn since `begin` (premultiplied) over the rectangle of the framebuffer that was bound then.
  void end();

 private:
  struct Bound {
    GLint draw = 0, read = 0;
  };
  [[nodiscard]] Bound bound() const;
  void bind(const Bound& framebuffers) const;
  /// The formats that the depth of the bound framebuffer may have; 0: none. False: there is no depth.
  bool depth_formats(std::array<GLenum, 2>& formats) const;
  bool make(int width, int height, int samples, GLenum depth_format, bool colored);
  bool copy_depth(const Bound& from, const TargetRectangle& rectangle, bool colored);
  bool read_samples(const TargetRectangle& rectangle, std::vector<float>& both);
  void attach(const Texture& texture, GLenum attachment, GLenum internal, GLenum format, GLenum type);
  void lay_over(int sample);

  const Gl& gl_;
  VertexArray no_attributes_;
  Program single_, multiple_, extremes_;
  int width_ = 0, height_ = 0, samples_ = 0;  // of the textures; one sample: 1
  GLenum depth_format_ = 0;
  bool colored_ = false;
  Texture color_, depth_;
  Framebuffer framebuffer_;
  Texture extreme_depths_;  // of the samples of a pixel: least, most
  Framebuffer extremes_framebuffer_;
  int extremes_width_ = 0, extremes_height_ = 0;
  Bound outer_;
  TargetRectangle rectangle_;
};

}  // namespace gs::render
