#include "qnv/base/palette.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace gs::qnv {
namespace {

std::vector<Rgb8> gradient(std::size_t count) {
  std::vector<Rgb8> colors;
  std::mt19937 random(1);
  for (std::size_t i = 0; i < count; ++i) {
    const auto shade = static_cast<std::uint8_t>(random() % 200 + 20);
    colors.push_back(
        {shade, static_cast<std::uint8_t>(shade / 2 + random() % 40), static_cast<std::uint8_t>(255 - shade)});
  }
  return colors;
}

// Returns the squared distance of luma, counted twice, and chroma.
std::int32_t color_distance(const Rgb8& a, const Rgb8& b) {
  const std::int32_t r = a.r - b.r, g = a.g - b.g, blue = a.b - b.b;
  const std::int32_t luma = r + 2 * g + blue, orange = 2 * (r - blue), green = 2 * g - r - blue;
  return luma * luma + orange * orange + green * green;
}

std::uint8_t nearest_by_hand(const Rgb8& color, const std::vector<Rgb8>& palette) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < palette.size(); ++i)
    if (color_distance(color, palette[i]) < color_distance(color, palette[best])) best = i;
  return static_cast<std::uint8_t>(best);
}

double mean_error(const std::vector<Rgb8>& colors, const std::vector<Rgb8>& palette) {
  const std::vector<std::uint8_t> indices = palette_indices(colors, palette, 1);
  double sum = 0;
  for (std::size_t i = 0; i < colors.size(); ++i) sum += color_distance(colors[i], palette[indices[i]]);
  return sum / static_cast<double>(colors.size());
}

}  // namespace

TEST_CASE("keeps few colours unchanged, the most frequent first") {
  CHECK(make_palette({}).empty());
  const std::vector<Rgb8> colors{{1, 2, 3}, {9, 9, 9}, {9, 9, 9}, {200, 0, 0}, {9, 9, 9}, {200, 0, 0}};
  CHECK(make_palette(colors) == std::vector<Rgb8>{{9, 9, 9}, {200, 0, 0}, {1, 2, 3}});
  std::vector<Rgb8> many;
  for (unsigned i = 0; i < 256; ++i)
    many.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i * 7), 3});
  const std::vector<Rgb8> palette = make_palette(many);
  REQUIRE(palette.size() == 256);
  CHECK(mean_error(many, palette) == 0);
}

TEST_CASE("clusters many colours with a small error") {
  const std::vector<Rgb8> colors = gradient(50'000);
  const std::vector<Rgb8> palette = make_palette(colors);
  REQUIRE(palette.size() <= 256);
  CHECK(palette.size() > 240);
  std::vector<Rgb8> cube;  // a fixed palette, independent of the colours
  for (int r = 0; r < 6; ++r)
    for (int g = 0; g < 6; ++g)
      for (int b = 0; b < 6; ++b)
        cube.push_back(
            {static_cast<std::uint8_t>(51 * r), static_cast<std::uint8_t>(51 * g), static_cast<std::uint8_t>(51 * b)});
  CHECK(mean_error(colors, palette) < mean_error(colors, cube) / 20);
  // The 200 * 40 colours have 256 clusters. A cluster has about 31 colours within 2 or 3 levels of the mean.
  CHECK(std::sqrt(mean_error(colors, palette)) < 4 * 3);
}

TEST_CASE("makes the same palette in any order and on any number of threads") {
  std::vector<Rgb8> colors = gradient(60'000);
  const std::vector<Rgb8> palette = make_palette(colors, 1);
  CHECK(palette == make_palette(colors, 4));
  std::reverse(colors.begin(), colors.end());
  std::rotate(colors.begin(), colors.begin() + 777, colors.end());
  CHECK(palette == make_palette(colors, 1));
  CHECK(palette_indices(colors, palette, 1) == palette_indices(colors, palette, 3));
}

TEST_CASE("returns the index of the nearest colour, and the first one if several are equal") {
  std::mt19937 random(2);
  for (const std::size_t size : {1u, 2u, 17u, 256u}) {
    std::vector<Rgb8> palette, colors;
    const auto any = [&] { return static_cast<std::uint8_t>(random()); };
    for (std::size_t i = 0; i < size; ++i) palette.push_back({any(), any(), any()});
    palette.back() = palette.front();
    for (int i = 0; i < 3000; ++i) colors.push_back({any(), any(), any()});
    colors.push_back(palette.front());
    const std::vector<std::uint8_t> indices = palette_indices(colors, palette);
    for (std::size_t i = 0; i < colors.size(); ++i) REQUIRE(indices[i] == nearest_by_hand(colors[i], palette));
  }
}

TEST_CASE("makes a palette of colours that differ only in their last bits") {
  std::vector<Rgb8> colors;
  for (unsigned i = 0; i < 64 * 64; ++i)
    colors.push_back({static_cast<std::uint8_t>(100 + i % 16), static_cast<std::uint8_t>(100 + i / 16 % 16),
                      static_cast<std::uint8_t>(100 + i / 256)});
  const std::vector<Rgb8> palette = make_palette(colors);
  CHECK(!palette.empty());
  CHECK(palette.size() <= 256);
  CHECK(std::sqrt(mean_error(colors, palette)) < 4 * 4);
}

}  // namespace gs::qnv
