#include "render/draw/off_screen.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace gs::render {
namespace {

constexpr int kPixelSide = 2;                   // with pixels as samples: number of samples along the side of a pixel
constexpr std::size_t kLightsOfManyPixels = 8;  // with more lights, additional pixels take too long

void attach(const Gl& gl, const Renderbuffer& buffer, GLenum format, GLenum attachment, int samples, int width,
            int height) {
  gl.BindRenderbuffer(GL_RENDERBUFFER, buffer.name());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.name());
}

/// Reports whether additional pixels cost much: the CPU rasterizes a surface or splats of the list, or it has volumes.
/// Sets `nothing_else` if the CPU draws everything that has edges; then OpenGL needs no multisampling.
bool draws_layers(const Gl& gl, const RenderList& list, const DrawOptions& options, bool& nothing_else) {
  const bool discs_by_gl = options.splats == SplatPath::gl || (options.splats == SplatPath::automatic && !gl.software);
  // OpenGL draws triangles that are only outlines or points.
  const bool by_gl = discs_by_gl || options.display != DisplayMode::surface;
  bool any = !list.splats.empty();
  nothing_else = !discs_by_gl && !options.guides;
  for (const DrawItem& item : list.items) {
    const bool layer = item.patches() && !item.overlay && !by_gl;
    // Rays through a volume cost more than its edges are worth, except those of isosurfaces in a single picture.
    any = any || layer || (item.volume && (options.go_on || !item.volume->iso_surfaces));
    nothing_else = nothing_else && (layer || !item.visible);
  }
  for (const SplatItem& item : list.splats)
    nothing_else = nothing_else && item.geometry && !item.geometry->as<qnv::Volume>();
  nothing_else = nothing_else && any && list.layers.empty();
  return any;
}

/// Writes the mean of a square of 2x2 RGBA pixels as one RGB pixel. Adds two components at a time.
void put_mean(const std::uint8_t* above, const std::uint8_t* below, std::uint8_t* to) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::uint32_t kEven = 0x00FF00FF, kHalf = 0x00020002;
  std::array<std::uint32_t, 4> pixels;
  std::memcpy(pixels.data(), above, 8);
  std::memcpy(pixels.data() + 2, below, 8);
  std::uint32_t even = kHalf, odd = kHalf;
  for (const std::uint32_t pixel : pixels) {
    even += pixel & kEven;
    odd += pixel >> 8 & kEven;
  }
  const std::uint32_t mean = (even >> 2 & kEven) | (odd >> 2 & kEven) << 8;
  std::memcpy(to, &mean, 3);
}

}  // namespace

OffscreenTarget make_target(const Gl& gl, int width, int height, int samples) {
  const GLenum depth = gl.ClipControl ? GL_DEPTH_COMPONENT32F : GL_DEPTH_COMPONENT24;
  take_errors(gl);
  OffscreenTarget target{width, height, samples, {}, {}, {}, {}, {}};
  const auto complete = [&] {
    return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && gl.GetError() == GL_NO_ERROR;
  };
  target.color = make_renderbuffer(gl);
  target.depth = make_renderbuffer(gl);
  target.framebuffer = make_framebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  const int multiple = samples > 1 ? samples : 0;
  attach(gl, target.color, GL_RGBA8, GL_COLOR_ATTACHMENT0, multiple, width, height);
  attach(gl, target.depth, depth, GL_DEPTH_ATTACHMENT, multiple, width, height);
  if (!complete()) return {};
  if (multiple == 0) return target;
  target.resolved_color = make_renderbuffer(gl);
  target.resolved = make_framebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.resolved.name());
  attach(gl, target.resolved_color, GL_RGBA8, GL_COLOR_ATTACHMENT0, 0, width, height);
  if (!complete()) return {};
  return target;
}

FormerPicture make_picture(const Gl& gl, int width, int height) {
  take_errors(gl);
  FormerPicture picture{width, height, make_renderbuffer(gl), make_framebuffer(gl)};
  gl.BindFramebuffer(GL_FRAMEBUFFER, picture.framebuffer.name());
  attach(gl, picture.color, GL_RGBA8, GL_COLOR_ATTACHMENT0, 0, width, height);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || gl.GetError() != GL_NO_ERROR) return {};
  return picture;
}

DrawOptions for_target(const Gl& gl, const RenderList& list, const DrawOptions& options, bool reduced) {
  DrawOptions local = options;
  local.x = local.y = 0;
  const int most = gl.max_renderbuffer_size / kPixelSide;
  bool nothing_else = false;
  const bool layers = draws_layers(gl, list, options, nothing_else);
  if (nothing_else) local.target_samples = 1;
  if (reduced && gl.software && std::min(options.samples, gl.max_samples) == kPixelSide * kPixelSide && !layers &&
      list.lights.size() <= kLightsOfManyPixels && options.width <= most && options.height <= most) {
    local.width *= kPixelSide;
    local.height *= kPixelSide;
    local.samples = 1;
    local.pixel_side = kPixelSide;
  }
  return local;
}

Image read_back(const Gl& gl, int width, int height, int side) {
  const auto columns = static_cast<std::size_t>(width / side), rows = static_cast<std::size_t>(height / side);
  const std::size_t stride = static_cast<std::size_t>(width) * 4, square = static_cast<std::size_t>(side);
  Image image{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), 3, {}};
  image.pixels.resize(columns * rows * 3);
  const auto reduce_row = [&](const std::uint8_t* from, std::uint8_t* to) {
    if (square == 2) {
      for (std::size_t x = 0; x < columns; ++x, from += 8, to += 3) put_mean(from, from + stride, to);
    } else {
      for (std::size_t x = 0; x < columns; ++x, from += 4)
        for (std::size_t c = 0; c < 3; ++c) *to++ = from[c];
    }
  };
  // Read one band at a time: a buffer for all pixels would be a second copy. Read four bytes per pixel, because drivers
  // would have to convert three.
  constexpr std::size_t kBand = 128, kRows = 32;  // rows of the image per band, and rows per task
  std::vector<std::uint8_t> pixels(stride * square * std::min(kBand, rows));
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  for (std::size_t first = 0; first < rows; first += kBand) {
    const std::size_t end = std::min(rows, first + kBand);
    gl.ReadPixels(0, static_cast<GLint>((rows - end) * square), width, static_cast<GLsizei>((end - first) * square),
                  GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    (void)parallel_for((end - first + kRows - 1) / kRows, [&](std::size_t task) {
      for (std::size_t y = first + task * kRows; y < std::min(end, first + (task + 1) * kRows); ++y)
        reduce_row(pixels.data() + (end - 1 - y) * square * stride, image.pixels.data() + y * columns * 3);
    });
  }
  return image;
}

}  // namespace gs::render
