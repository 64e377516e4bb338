#pragma once

#include "render/base/phases.h"
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

/// Draws RenderLists with OpenGL 3.3 core. Keeps GPU copies of meshes and images as long as somebody
/// else still holds them. Belongs to the thread of its context; destroy it while that is current.
class Renderer {
 public:
  /// Compiles the shaders. The error says what the driver said.
  static std::variant<std::unique_ptr<Renderer>, ContextError> create(GlContext& context);
  ~Renderer();

  /// Draws off screen, and shows the picture in its rectangle of the framebuffer that is bound (0: the window's). A
  /// picture that was given up is not shown, but the last whole one of the viewport, if there has been any.
  FrameStatistics draw(const RenderList& list, const Camera& camera, const DrawOptions& options);
  /// Shows the last whole picture of a viewport again in its rectangle, as `draw` would if nothing had changed. False:
  /// there is none, and nothing was shown; only pictures that `go_on` could have ended, and coarse ones, are kept.
  bool show_again(const DrawOptions& options);
  /// Draws off screen and reads the picture back as RGB.
  [[nodiscard]] std::variant<Image, ContextError> draw_to_image(const RenderList& list, const Camera& camera,
                                                                const DrawOptions& options,
                                                                FrameStatistics* statistics = nullptr);
  /// Makes ready what pictures of this size and with these samples most likely need, so that the first one is there the
  /// sooner.
  void prepare(const DrawOptions& options);
  /// Who is told what time goes to from now on, and outlives this; null: nobody.
  void measure(PhaseClock* phases);
  /// The GL_RENDERER string.
  [[nodiscard]] const std::string& gl_renderer() const;
  /// Pixels that a side of a picture may have.
  [[nodiscard]] int largest_side() const;

 private:
  struct State;
  bool bind_target(int width, int height, int samples);
  FrameStatistics draw_in_target(const RenderList& list, const Camera& camera, const DrawOptions& options);
  bool draw_off_screen(const RenderList& list, const Camera& camera, const DrawOptions& local,
                       FrameStatistics* statistics);
  void resolve(int width, int height);
  void keep_whole_picture(const DrawOptions& options, bool given_up, int& width, int& height);
  explicit Renderer(std::unique_ptr<State> state);
  void draw_overlays(const RenderList& list, const Camera& camera, const DrawOptions& options,
                     FrameStatistics& statistics);
  std::unique_ptr<State> state_;
};

}  // namespace gs::render
