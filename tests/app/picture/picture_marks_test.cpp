#include "app/picture/picture_marks.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <vector>

namespace gs::app::picture_marks_test {
namespace {

render::Image plain(std::uint32_t width, std::uint32_t height, std::uint32_t components, std::uint8_t value) {
  return {width, height, components, std::vector<std::uint8_t>(std::size_t{width} * height * components, value)};
}

}  // namespace

TEST_CASE("blends a rectangle into a picture, and fills a transparent one") {
  render::Image image = plain(4, 4, 3, 100);
  draw_rectangle({image, 0}, {1, 1}, {3, 2}, {1, 0, 0}, 0.5f);
  CHECK(image.pixels[(1 * 4 + 1) * 3] == 178);
  CHECK(image.pixels[(1 * 4 + 1) * 3 + 1] == 50);
  CHECK(image.pixels[0] == 100);
  render::Image clear = plain(2, 2, 4, 0);
  draw_rectangle({clear, 0}, {0, 0}, {1, 1}, {1, 0.5f, 0}, 0.5f);
  CHECK(std::vector<std::uint8_t>(clear.pixels.begin(), clear.pixels.begin() + 5) ==
        std::vector<std::uint8_t>{255, 128, 0, 128, 0});
  draw_rectangle({clear, 0}, {-10, -10}, {0, 50}, {1, 1, 1});  // beside the picture
  CHECK(clear.pixels[3] == 128);
}

TEST_CASE("draws text with the reported width, on its line") {
  render::Image image = plain(120, 40, 3, 0);
  draw_text({image, 0}, "HHHH", {10, 30}, 20, {1, 1, 1});
  const float width = text_width("HHHH") * 20;
  CHECK(width > 30);
  CHECK(width < 80);
  std::size_t lit = 0;
  for (std::uint32_t y = 0; y < 40; ++y)
    for (std::uint32_t x = 0; x < 120; ++x)
      if (image.pixels[(y * 120 + x) * 3] > 128) {
        ++lit;
        CHECK(x >= 10);
        CHECK(static_cast<float>(x) <= 10 + width);
        CHECK(y >= 10);
        CHECK(y <= 30);
      }
  CHECK(lit > 100);
}

TEST_CASE("draws a colour bar in bands of rows as at once, with the colours of its ends") {
  ColorBar bar{"density (K)", {0, 100}, {{0, {255, 0, 0}, 1}, {1, {0, 0, 255}, 1}}};
  render::Image whole = plain(200, 160, 3, 0);
  draw_color_bar({whole, 0}, {200, 160}, bar);
  std::vector<std::uint8_t> pixels;
  for (int top = 0; top < 160; top += 50) {
    const auto rows = static_cast<std::uint32_t>(std::min(50, 160 - top));
    render::Image band = plain(200, rows, 3, 0);
    draw_color_bar({band, top}, {200, 160}, bar);
    pixels.insert(pixels.end(), band.pixels.begin(), band.pixels.end());
  }
  CHECK(pixels == whole.pixels);
  std::size_t red = 0, blue = 0, rows_of_blue = 0, rows_of_red = 0;
  for (std::uint32_t y = 0; y < 160; ++y)
    for (std::uint32_t x = 0; x < 200; ++x) {
      const std::uint8_t* p = whole.pixels.data() + (y * 200 + x) * 3;
      if (p[0] > 230 && p[2] < 20) ++red, rows_of_red += y;
      if (p[2] > 230 && p[0] < 20) ++blue, rows_of_blue += y;
    }
  REQUIRE(red > 0);
  REQUIRE(blue > 0);
  CHECK(rows_of_red / red > rows_of_blue / blue);  // the minimum is below
}

}  // namespace gs::app::picture_marks_test
