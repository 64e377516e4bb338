#pragma once

#include "app/picture/picture_request.h"
#include "render/draw/picture.h"

#include <cstddef>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Function that draws an overlay on `band`, which holds the rows from `top` on of a picture of `size` pixels.
using DrawOver = std::function<void(render::Image& band, int top, const glm::ivec2& size)>;

/// Content of one picture.
struct PictureScene {
  const render::RenderList* list = nullptr;
  render::Camera camera;
  render::DrawOptions draw;  // width and height of the whole picture
  double unit = 1;  // number of world units in a metre
  DrawOver over;                 // null means no overlay
  PhaseClock* phases = nullptr;  // receives the durations of the phases; null means that they are not measured
};

/// Draws a picture and returns it as PNG bytes, or an error message. Calls `go_on` after each band of rows, with the
/// finished fraction; if it returns false, drawing is cancelled. A null `go_on` never cancels.
[[nodiscard]] std::variant<std::vector<std::byte>, std::string> paint_png(
    render::Renderer& renderer, const PictureScene& scene, const PictureRequest& request,
    render::FrameStatistics* statistics = nullptr, const std::function<bool(double part)>& go_on = {});

/// Draws the whole picture as RGB or RGBA pixels.
[[nodiscard]] std::variant<render::Image, std::string> paint_image(render::Renderer& renderer,
                                                                   const PictureScene& scene,
                                                                   const PictureRequest& request);

}  // namespace gs::app
