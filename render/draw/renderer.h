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

/// Draws RenderLists with OpenGL 3.3 core. Keeps GPU copies of meshes and images while other owners hold them. Belongs
/// to the thread of its context; destroy it while that context is current.
class Renderer {
 public:
  /// Compiles the shaders. The error contains the driver's message.
  static std::variant<std::unique_ptr<Renderer>, ContextError> create(GlContext& context);
  ~Renderer();

  /// Draws off screen and shows the image in its rectangle of the bound framebuffer (0 is the window). If drawing is
  /// cancelled, it shows the viewport's last complete image instead, if there is one.
  FrameStatistics draw(const RenderList& list, const Camera& camera, const DrawOptions& options);
  /// Shows the last complete image of a viewport again, as `draw` would if nothing had changed. Returns false if there
  /// is none. Images are kept only if `go_on` could have cancelled them or if they are coarse.
  bool show_again(const DrawOptions& options);
  /// Draws off screen and reads the image back as RGB.
  [[nodiscard]] std::variant<Image, ContextError> draw_to_image(const RenderList& list, const Camera& camera,
                                                                const DrawOptions& options,
                                                                FrameStatistics* statistics = nullptr);
  /// Prepares resources that images of this size and sample count need, so that the first one is ready sooner.
  void prepare(const DrawOptions& options);
  /// Sets the clock that measures phases from now on; it must outlive this object. Null means none.
  void measure(PhaseClock* phases);
  /// Returns the GL_RENDERER string.
  [[nodiscard]] const std::string& gl_renderer() const;
  /// Returns the maximum side of an image in pixels.
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
