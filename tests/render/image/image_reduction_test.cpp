#include "tests/render/image_files.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace gs::image_reduction_test {
namespace {

using namespace test;
using render::ImageLimits;

Image reduced(const Bytes& bytes, std::size_t kept_pixels) {
  auto result = decode_image(bytes, {.kept_pixels = kept_pixels});
  if (const auto* error = std::get_if<ImageError>(&result)) FAIL(error->message);
  Image image = std::get<Image>(std::move(result));
  REQUIRE(image.pixels.size() == std::size_t{image.width} * image.height * image.components);
  REQUIRE(std::size_t{image.width} * image.height <= kept_pixels);
  return image;
}

/// Returns an image that is dark on the left, light on the right, and lighter towards the bottom.
Image shaded(std::uint32_t width, std::uint32_t height) {
  Image image{width, height, 3, {}};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        image.pixels.push_back(static_cast<std::uint8_t>((x < width / 2 ? 20 : 180) + 60 * y / height));
  return image;
}

void check_shaded(const Image& image, int margin) {
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x)
      for (std::uint32_t c = 0; c < 3; ++c) {
        if (x + 1 >= image.width / 2 && x <= image.width / 2 + 1) continue;  // across both halves
        const int expected = (x < image.width / 2 ? 20 : 180) + static_cast<int>(60 * y / image.height);
        REQUIRE(std::abs(image.pixels[(y * image.width + x) * 3 + c] - expected) <= margin);
      }
}

std::string message_of(const Bytes& bytes, const ImageLimits& limits) {
  const auto result = decode_image(bytes, limits);
  REQUIRE(std::holds_alternative<ImageError>(result));
  return std::get<ImageError>(result).message;
}

}  // namespace

TEST_CASE("keeps a picture within the limits unchanged") {
  const Image image = made(40, 30, 3);
  CHECK(reduced(encode_png(image), 1200).pixels == image.pixels);
  CHECK(reduced(encode_png(image), 1200).reduction == 1);
}

TEST_CASE("reduces larger PNGs to means of squares, cut at the right and bottom") {
  const Image image = reduced(encode_png(made(5, 3, 1)), 6);
  REQUIRE(image.width == 3);
  REQUIRE(image.height == 2);
  CHECK(image.reduction == 2);
  const Image whole = made(5, 3, 1);
  const auto mean = [&](std::uint32_t x, std::uint32_t y) {
    unsigned sum = 0, count = 0;
    for (std::uint32_t v = y; v < std::min(y + 2, 3u); ++v)
      for (std::uint32_t u = x; u < std::min(x + 2, 5u); ++u, ++count) sum += whole.pixels[v * 5 + u];
    return sum / count;
  };
  for (std::uint32_t y = 0; y < 2; ++y)
    for (std::uint32_t x = 0; x < 3; ++x) CHECK(image.pixels[y * 3 + x] == mean(2 * x, 2 * y));
}

TEST_CASE("reduces pictures of every format and size during decoding") {
  for (const auto& [width, height] : {std::pair{256u, 128u}, {250u, 130u}, {1000u, 16u}}) {
    const Image image = shaded(width, height);
    PngOptions interlaced;
    interlaced.interlace = PNG_INTERLACE_ADAM7;
    for (const std::size_t kept : {std::size_t{8000}, std::size_t{2000}, std::size_t{600}, std::size_t{150}}) {
      check_shaded(reduced(encode_png(image), kept), 31);
      check_shaded(reduced(png_of(width, height, interlaced, image.pixels), kept), 31);
      for (const bool progressive : {false, true})
        check_shaded(reduced(jpeg_of(image, JCS_RGB, JCS_YCbCr, progressive), kept), 40);
    }
  }
  const Image gif = reduced(gif_of({}), 4);
  CHECK(gif.width == 2);
  CHECK(gif.height == 2);
  GifOptions options;
  options.interlaced = true;
  CHECK(reduced(gif_of(options), 4).pixels.size() == gif.pixels.size());
  CHECK(reduced(gif_of({}), 1).width == 1);
}

TEST_CASE("keeps one component for a grey palette and three for a CMYK picture") {
  PngOptions grey;
  grey.color_type = PNG_COLOR_TYPE_PALETTE;
  for (int i = 0; i < 4; ++i) {
    const auto value = static_cast<png_byte>(i * 80);
    grey.palette.push_back({value, value, value});
  }
  const Image image = reduced(png_of(4, 4, grey, {0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 3, 3}), 4);
  CHECK(image.components == 1);
  CHECK(image.pixels == std::vector<std::uint8_t>{0, 80, 160, 240});
  CHECK(reduced(jpeg_of(flat(32, 32, {255, 255, 255, 255}), JCS_CMYK, JCS_CMYK), 16).components == 3);
}

TEST_CASE("keeps the received rows of a truncated picture that is reduced") {
  Image image = shaded(256, 256);
  std::uint32_t noise = 1;  // noise makes a compressed image of many pieces
  for (std::uint8_t& value : image.pixels)
    value = static_cast<std::uint8_t>(value + ((noise = noise * 1664525 + 1013904223) >> 29));
  Bytes png = encode_png(image);
  png.resize(png.size() * 3 / 4);
  const Image part = reduced(png, 1024);
  CHECK(part.pixels.front() == Approx(24).margin(6));
  CHECK(part.pixels.back() == 0);
  Bytes jpeg = jpeg_of(image, JCS_RGB, JCS_YCbCr);
  jpeg.resize(jpeg.size() / 2);
  const Image half = reduced(jpeg, 1024);
  CHECK(half.pixels.front() == Approx(24).margin(12));
  CHECK(half.pixels.back() == 0);
}

TEST_CASE("skips a progressive JPEG with coefficients beyond the memory limit") {
  const Bytes bytes = jpeg_of(shaded(256, 256), JCS_RGB, JCS_YCbCr, true);
  CHECK(message_of(bytes, {.working_bytes = 100'000}).find("progressive JPEG image of 256x256 pixels") !=
        std::string::npos);
  CHECK(std::holds_alternative<Image>(decode_image(bytes, {.working_bytes = 256 * 256 * 6})));
  // A baseline JPEG needs only a few rows.
  CHECK(std::holds_alternative<Image>(
      decode_image(jpeg_of(shaded(256, 256), JCS_RGB, JCS_YCbCr), {.working_bytes = 100'000})));
}

TEST_CASE("stops decoding on request") {
  const Image image = shaded(512, 512);
  for (const Bytes& bytes : {encode_png(image), jpeg_of(image, JCS_RGB, JCS_YCbCr)})
    for (const std::size_t kept : {std::size_t{512 * 512}, std::size_t{64 * 64}}) {
      int rows = 0;
      ImageLimits limits;
      limits.kept_pixels = kept;
      limits.stopped = [&] { return ++rows > 10; };
      const auto result = decode_image(bytes, limits);
      CHECK(rows == 11);
      if (const auto* part = std::get_if<Image>(&result)) CHECK(part->pixels.back() == 0);
    }
}

}  // namespace gs::image_reduction_test
