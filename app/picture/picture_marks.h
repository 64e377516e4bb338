#pragma once

#include "app/view/values/color_bar.h"
#include "render/image/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <string_view>

namespace gs::app {

/// Band of rows of a picture, from row `top` on, in RGB or RGBA. Coordinates for drawing are pixels from the upper left
/// corner of the whole picture.
struct PictureBand {
  render::Image& image;
  int top = 0;
};

/// Blends a filled rectangle into the picture.
void draw_rectangle(const PictureBand& band, const glm::vec2& from, const glm::vec2& to, const glm::vec3& color,
                    float opacity = 1);

/// Returns the width of a line of text in ems.
[[nodiscard]] float text_width(std::string_view text);
/// Draws a line of text in the system's sans-serif font. The baseline starts at `at`; `size` is the em size in pixels.
void draw_text(const PictureBand& band, std::string_view text, const glm::vec2& at, float size, const glm::vec3& color);

/// Draws the colour bar with title and ticks at the right edge. `size` is the size of the whole picture in pixels.
void draw_color_bar(const PictureBand& band, const glm::ivec2& size, const ColorBar& bar);

}  // namespace gs::app
