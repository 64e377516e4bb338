#pragma once

#include "app/picture/picture_request.h"
#include "render/draw/picture.h"

#include <cstddef>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// What is drawn over the rows of a picture from `top` on, of a picture of `size` pixels.
using DrawOver = std::function<void(render::Image& band, int top, const glm::ivec2& size)>;

/// What a picture shows.
struct PictureScene {
  const render::RenderList* list = nullptr;
  render::Camera camera;
  render::DrawOptions draw;              // width and height: of the picture
  double unit = 1;                       // world units that a metre is long
  DrawOver over;                         // null: nothing
  render::PhaseClock* phases = nullptr;  // that measures; null: nobody does
};

/// The bytes of a PNG, or why there are none. `go_on`: asked after each band of rows of a large picture; null: true.
[[nodiscard]] std::variant<std::vector<std::byte>, std::string> paint_png(
    render::Renderer& renderer, const PictureScene& scene, const PictureRequest& request,
    render::FrameStatistics* statistics = nullptr, const std::function<bool(double part)>& go_on = {});

/// The whole picture as pixels, RGB or RGBA.
[[nodiscard]] std::variant<render::Image, std::string> paint_image(render::Renderer& renderer,
                                                                   const PictureScene& scene,
                                                                   const PictureRequest& request);

}  // namespace gs::app
