#pragma once

#include "app/picture/picture_request.h"
#include "render/draw/picture.h"

#include <cstddef>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Callback that draws an overlay on a band of rows from row `top` on, in a picture of `size` pixels.
using DrawOver = std::function<void(render::Image& band, int top, const glm::ivec2& size)>;

/// Content of one picture.
struct PictureScene {
  const render::RenderList* list = nullptr;
  render::Camera camera;
  render::DrawOptions draw;      // width and height are those of the whole picture
  double unit = 1;               // length of a metre in world units
  DrawOver over;                 // null means no overlay
  PhaseClock* phases = nullptr;  // clock for the phases; null means not measured
};

/// Draws a picture as PNG bytes, or returns an error message. `go_on` is called after each band of rows of a large
/// picture and returns false to cancel; null never cancels.
[[nodiscard]] std::variant<std::vector<std::byte>, std::string> paint_png(
    render::Renderer& renderer, const PictureScene& scene, const PictureRequest& request,
    render::FrameStatistics* statistics = nullptr, const std::function<bool(double part)>& go_on = {});

/// Draws the whole picture as RGB or RGBA pixels.
[[nodiscard]] std::variant<render::Image, std::string> paint_image(render::Renderer& renderer,
                                                                   const PictureScene& scene,
                                                                   const PictureRequest& request);

}  // namespace gs::app
