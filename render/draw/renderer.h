#pragma once

#include "base/phases.h"
#include "render/gl/context.h"
#include "render/image/image.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace gs::render {

/// Draws RenderLists with OpenGL 3.3 core. Keeps GPU copies of meshes and images while these have other owners. Runs on
/// the thread of its context. Destroy it while that context is current.
class Renderer {
 public:
  /// Creates a renderer and compiles the shaders. The error contains the driver's message.
  static std::variant<std::unique_ptr<Renderer>, ContextError> create(GlContext& context);
  ~Renderer();

  /// Draws off screen, then copies the image to its rectangle of the bound framebuffer (0 is the window). If drawing is
  /// cancelled, copies the viewport's last complete image instead, if one exists.
  FrameStatistics draw(const RenderList& list, const Camera& camera, const DrawOptions& options);
  /// Copies the last complete image of a viewport to its rectangle again. Returns false if no image is kept. Images are
  /// kept only if options.go_on could cancel drawing, or if they are coarse.
  bool show_again(const DrawOptions& options);
  /// Draws off screen and reads the image back as RGB.
  [[nodiscard]] std::variant<Image, ContextError> draw_to_image(const RenderList& list, const Camera& camera,
                                                                const DrawOptions& options,
                                                                FrameStatistics* statistics = nullptr);
  /// Allocates resources for images of this size and sample count, so that the first image is ready sooner.
  void prepare(const DrawOptions& options);
  /// Sets the clock for measuring phases. It must outlive this object. Null ends measuring.
  void measure(PhaseClock* phases);
  /// Returns the driver's GL_RENDERER string.
  [[nodiscard]] const std::string& gl_renderer() const;
  /// Returns the maximum side of an image that the driver permits, in pixels.
  [[nodiscard]] int largest_side() const;

 private:
  struct State;
  bool bind_target(int width, int height, int samples);
  FrameStatistics draw_in_target(const RenderList& list, const Camera& camera, const DrawOptions& options);
  FrameStatistics draw_layer(const RenderList& list, const Camera& camera, const DrawOptions& options, bool in_front);
  bool draw_off_screen(const RenderList& list, const Camera& camera, const DrawOptions& local,
                       FrameStatistics* statistics);
  void resolve(int width, int height);
  void keep_whole_picture(const DrawOptions& options, bool given_up, int& width, int& height);
  explicit Renderer(std::unique_ptr<State> state);
  void occlude(const Projection& lens, const WideBox& bounds, const DrawOptions& options);
  void draw_overlays(const RenderList& list, const Camera& camera, const DrawOptions& options,
                     FrameStatistics& statistics);
  std::unique_ptr<State> state_;
};

}  // namespace gs::render
