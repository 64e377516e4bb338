#pragma once

// Helpers of tests of volumes: an exact picture of several volumes, and a target to draw into.

#include "base/noncopyable.h"
#include "render/volume/volume_lens.h"
#include "render/volume/volume_pass.h"
#include "tests/geometries.h"
#include "tests/render/drawing.h"
#include "tests/render/geometry_shapes.h"
#include "tests/render/rays/raycast.h"

#include <catch2/catch.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::test {

using Pixels = std::vector<std::uint8_t>;  // RGBA, rows from the bottom

/// Draws several volumes exactly, mixed by depth, with stops (one per pixel, or none). Extends raycast_volume.
inline render::RayImage exact_volumes(std::span<const render::VolumeItem> items, const render::SplatView& view,
                                      std::span<const float> stops = {}) {
  struct Vector {
    glm::dvec3 place, color;
    double alpha, area;
  };
  std::vector<Vector> vectors;
  for (const render::VolumeItem& item : items) {
    const auto lens = render::volume_lens(view, item.camera_from_node);
    if (!lens) continue;
    for (std::size_t k = 0; k < item.count; ++k) {
      const double alpha = static_cast<double>(render::volume_alpha(*item.volume, *item.model, item.options, k));
      const glm::dvec3 place(glm::dmat4(item.camera_from_node) * glm::dvec4(item.volume->positions[k], 1));
      const double spacing = static_cast<double>(item.model->spacing[k] * lens->scale), depth = -place.z;
      if (!(alpha > 0 && depth > static_cast<double>(view.near_plane) && depth > spacing)) continue;
      const double pixels = static_cast<double>(lens->pixels_x * lens->pixels_y) / (depth * depth);
      double area = static_cast<double>(render::kVolumeFootprint) * spacing * spacing, part = 1;
      const double least = static_cast<double>(render::kVolumePixel) / pixels;
      if (area < least) part = std::exchange(area, least) / least;
      const glm::vec3 color =
          render::volume_shade(item.options, render::volume_color(*item.volume, *item.model, item.options, k),
                               glm::vec3(place), lens->normal_matrix * item.volume->normals[k]);
      vectors.push_back({place, glm::dvec3(color), alpha * part, area});
    }
  }
  std::stable_sort(vectors.begin(), vectors.end(),
                   [](const Vector& a, const Vector& b) { return a.place.z > b.place.z; });
  render::RayImage image;
  image.width = view.width;
  image.height = view.height;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const glm::dvec3 ray(((x + 0.5) / view.width * 2 - 1) * static_cast<double>(view.tangents.x),
                           ((y + 0.5) / view.height * 2 - 1) * static_cast<double>(view.tangents.y), -1);
      const std::size_t at = image.color.size();
      const double stop = stops.empty() ? 1e300 : static_cast<double>(stops[at]);
      double clear = 1;
      glm::dvec3 color(0);
      for (const Vector& v : vectors) {
        if (-v.place.z > stop) break;
        const glm::dvec3 away = ray * -v.place.z - v.place;
        const double exponent = glm::dot(away, away) / v.area;
        if (exponent > 60) continue;  // below 1e-26, beyond float precision
        const double alpha = v.alpha * std::exp(-exponent);
        color += v.color * (alpha * clear);
        clear *= 1 - alpha;
      }
      image.color.emplace_back(glm::vec3(color), 1 - clear);
    }
  return image;
}

/// Returns the PSNR of red, green and blue against an exact picture over `under` (0..255; one pixel, or all).
inline double psnr_over(const Pixels& drawn, const render::RayImage& exact, const Pixels& under) {
  REQUIRE(drawn.size() == 4 * exact.color.size());
  Psnr psnr;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (i % 4 == 3) continue;
    const glm::vec4& over = exact.color[i / 4];
    const float below = static_cast<float>(under[under.size() == drawn.size() ? i : i % 4]) / 255.0f;
    psnr.add(drawn[i] / 255.0, static_cast<double>(over[static_cast<int>(i % 4)] + (1 - over.w) * below));
  }
  return psnr.decibels();
}

inline double psnr_of(const Pixels& a, const Pixels& b) {
  REQUIRE(a.size() == b.size());
  Psnr psnr;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (i % 4 != 3) psnr.add(a[i] / 255.0, b[i] / 255.0);
  return psnr.decibels();
}

/// Framebuffer with known colour and depth, and a pass that draws volumes into it. The camera is at z = 3.
class VolumePicture : NonCopyable {
 public:
  explicit VolumePicture(render::SortMethod sort = render::SortMethod::automatic, int width = 80, int height = 60,
                         int samples = 1, GLenum depth_format = GL_DEPTH_COMPONENT24)
      : width_(width), height_(height), samples_(samples), depth_format_(depth_format) {
    auto opened = render::open_headless_context("auto");
    if (auto* error = std::get_if<render::ContextError>(&opened)) FAIL(error->message);
    context = std::move(std::get<std::unique_ptr<render::GlContext>>(opened));
    auto loaded = render::Gl::load(*context);
    if (auto* error = std::get_if<render::ContextError>(&loaded)) FAIL(error->message);
    gl = std::move(std::get<render::Gl>(loaded));
    samples_ = std::min(samples_, gl.max_samples);
    resolved_ = framebuffer(resolved_buffers_, 0);
    if (samples_ > 1) drawn_ = framebuffer(drawn_buffers_, samples_);
    pass = std::make_unique<render::VolumePass>(gl, sort);
    camera.world_from_camera = render::testing::translation({0, 0, 3});
    camera.near_plane = 0.1f;
    camera.far_plane = 30;
    options.width = width;
    options.height = height;
    options.splats = render::SplatPath::cpu;
  }
  // Makes the context current, so that the OpenGL objects are freed in it.
  ~VolumePicture() { context->make_current(); }

  [[nodiscard]] render::Projection projection() const {
    return render::projection(camera, static_cast<float>(options.width), static_cast<float>(options.height), reversed_);
  }

  /// Switches to reversed depth. Returns false if OpenGL lacks it.
  bool reverse_depth() {
    if (!gl.ClipControl) return false;
    context->make_current();
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    return reversed_ = true;
  }

  /// Returns the view that the pass uses, in world space.
  [[nodiscard]] render::SplatView view() const {
    render::SplatView result;
    result.camera_from_node = glm::inverse(camera.world_from_camera);
    result.tangents = projection().tangents();
    result.width = options.width;
    result.height = options.height;
    result.near_plane = camera.near_plane;
    return result;
  }

  /// Clears to a colour, at `depth` (camera units).
  void clear(const glm::vec3& color, float depth) {
    context->make_current();
    gl.BindFramebuffer(GL_FRAMEBUFFER, target());
    const float background[4] = {color.x, color.y, color.z, 1},
                far = std::clamp(projection().window_depth(depth), 0.0f, 1.0f);
    gl.Viewport(options.x, options.y, options.width, options.height);
    gl.DepthMask(GL_TRUE);
    gl.ClearBufferfv(GL_COLOR, 0, background);
    gl.ClearBufferfv(GL_DEPTH, 0, &far);
  }

  /// Draws a quadrilateral in camera space, as a strip of two triangles.
  void polygon(const std::array<glm::vec3, 4>& corners, const glm::vec3& color) {
    constexpr char kVertex[] = "uniform vec4 corners[4];\nvoid main() { gl_Position = corners[gl_VertexID]; }\n";
    constexpr char kFragment[] = "uniform vec4 color;\nout vec4 result;\nvoid main() { result = color; }\n";
    auto made = render::make_program(gl, "", kVertex, kFragment);
    REQUIRE(std::holds_alternative<render::Program>(made));
    const render::Program program = std::move(std::get<render::Program>(made));
    const render::VertexArray attributes = render::make_vertex_array(gl);
    gl.BindVertexArray(attributes.name());
    gl.UseProgram(program.name());
    std::array<glm::vec4, 4> placed{};
    for (std::size_t i = 0; i < 4; ++i) placed[i] = projection().clip_from_camera * glm::vec4(corners[i], 1);
    const glm::vec4 opaque(color, 1);
    gl.Uniform4fv(gl.GetUniformLocation(program.name(), "corners"), 4, glm::value_ptr(placed[0]));
    gl.Uniform4fv(gl.GetUniformLocation(program.name(), "color"), 1, glm::value_ptr(opaque));
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(reversed_ ? GL_GREATER : GL_LESS);
    gl.Disable(GL_BLEND);
    gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    gl.Disable(GL_DEPTH_TEST);
  }

  /// Draws the volumes over the current picture.
  void volumes(const render::RenderList& list) {
    context->make_current();
    statistics = {};
    pass->draw(list, camera, projection(), options, statistics);
  }

  [[nodiscard]] Pixels read() {
    context->make_current();
    if (samples_ > 1) {
      gl.BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_.name());
      gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.name());
      gl.BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, resolved_.name());
    Pixels pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 4);
    gl.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    gl.BindFramebuffer(GL_FRAMEBUFFER, target());
    CHECK(gl.GetError() == GL_NO_ERROR);
    return pixels;
  }

  Pixels draw(const render::RenderList& list, const glm::vec3& color, float depth) {
    clear(color, depth);
    volumes(list);
    return read();
  }

  std::unique_ptr<render::GlContext> context;
  render::Gl gl;
  std::unique_ptr<render::VolumePass> pass;
  render::Camera camera;
  render::DrawOptions options;
  render::FrameStatistics statistics;

 private:
  struct Buffers {
    render::Renderbuffer color, depth;
  };
  render::Framebuffer framebuffer(Buffers& buffers, int samples) {
    render::Framebuffer made = render::make_framebuffer(gl);
    gl.BindFramebuffer(GL_FRAMEBUFFER, made.name());
    const auto attach = [&](render::Renderbuffer& buffer, GLenum format, GLenum attachment) {
      buffer = render::make_renderbuffer(gl);
      gl.BindRenderbuffer(GL_RENDERBUFFER, buffer.name());
      gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width_, height_);
      gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.name());
    };
    attach(buffers.color, GL_RGBA8, GL_COLOR_ATTACHMENT0);
    const bool stencil = depth_format_ == GL_DEPTH24_STENCIL8 || depth_format_ == GL_DEPTH32F_STENCIL8;
    if (depth_format_ != GL_NONE)
      attach(buffers.depth, depth_format_, stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT);
    REQUIRE(gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
    return made;
  }
  [[nodiscard]] GLuint target() const { return samples_ > 1 ? drawn_.name() : resolved_.name(); }

  int width_, height_, samples_;
  GLenum depth_format_;  // GL_NONE for no depth buffer
  bool reversed_ = false;
  Buffers drawn_buffers_, resolved_buffers_;
  render::Framebuffer drawn_, resolved_;
};

inline render::RenderList volume_list(const std::shared_ptr<const qnv::Volume>& geometry,
                                      const glm::mat4& world_from_node = glm::mat4(1.0f)) {
  render::RenderList list;
  render::SplatItem item;
  item.geometry = shared_geometry(geometry);
  item.world_from_node = world_from_node;
  list.splats.push_back(item);
  return list;
}

/// Reports whether all pixels have this colour, within a step.
inline bool plain(const Pixels& pixels, const glm::vec3& color) {
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 < 3 && std::abs(static_cast<float>(pixels[i]) - color[static_cast<int>(i % 4)] * 255) > 1) return false;
  return true;
}

}  // namespace gs::test
