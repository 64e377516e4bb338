#pragma once

#include "app/view/values/color_bar.h"
#include "render/image/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <string_view>

namespace gs::app {

/// A part of a picture: its rows from `top` on, RGB or RGBA; what is drawn has places in the whole picture, in pixels
/// from its upper left.
struct PictureBand {
  render::Image& image;
  int top = 0;
};

/// Mixes a rectangle into the picture.
void draw_rectangle(const PictureBand& band, const glm::vec2& from, const glm::vec2& to, const glm::vec3& color,
                    float opacity = 1);

/// How wide a line of text is, in ems.
[[nodiscard]] float text_width(std::string_view text);
/// A line of text in the system's font without serifs, whose base line begins at `at`; `size`: of an em, pixels.
void draw_text(const PictureBand& band, std::string_view text, const glm::vec2& at, float size, const glm::vec3& color);

/// The bar at the right edge of a picture of `size` pixels, with title and ticks.
void draw_color_bar(const PictureBand& band, const glm::ivec2& size, const ColorBar& bar);

}  // namespace gs::app
