#pragma once

#include "render/gl/gpu.h"
#include "render/image/image.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"

namespace gs::render {

/// Off-screen framebuffer, possibly multisampled; `resolved` then has one sample per pixel. Its depth buffer is float
/// if OpenGL supports glClipControl.
struct OffscreenTarget {
  int width = 0, height = 0, samples = 0;  // requested values; the driver may give fewer samples
  Renderbuffer color, depth, resolved_color;
  Framebuffer framebuffer, resolved;
};

/// Last complete image of a viewport, with one sample per pixel.
struct FormerPicture {
  int width = 0, height = 0;
  Renderbuffer color;
  Framebuffer framebuffer;
};

/// Makes a target. Its framebuffer is empty if the driver cannot make it.
[[nodiscard]] OffscreenTarget make_target(const Gl& gl, int width, int height, int samples);
/// Makes a framebuffer for an image. Its framebuffer is empty if the driver cannot make it.
[[nodiscard]] FormerPicture make_picture(const Gl& gl, int width, int height);
/// Returns options for off-screen drawing. If `reduced`, software drivers draw four times the pixels, which are
/// averaged later: multisampling takes three times as long. Does not reduce CPU-rasterized surfaces, which have their
/// own sampling.
[[nodiscard]] DrawOptions for_target(const Gl& gl, const RenderList& list, const DrawOptions& options, bool reduced);
/// Reads the bound framebuffer through a pixel buffer, top row first. Each pixel of the result is the mean of `side` x
/// `side` pixels.
[[nodiscard]] Image read_back(const Gl& gl, int width, int height, int side);

}  // namespace gs::render
