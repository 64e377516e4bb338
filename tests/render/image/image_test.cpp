#include "render/image/image.h"

#include "tests/render/image_files.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <thread>

namespace {

using namespace gs::test;
using gs::render::compare;

std::string message_of(const Bytes& bytes, std::size_t max_pixels = std::size_t{1} << 28) {
  const auto result = decode_image(bytes, {.file_pixels = max_pixels});
  REQUIRE(std::holds_alternative<ImageError>(result));
  return std::get<ImageError>(result).message;
}

/// Checks that the result is an error or a valid Image.
void check_consistent(std::span<const std::byte> bytes) {
  const auto result = decode_image(bytes, {.file_pixels = 1 << 16});
  if (const auto* error = std::get_if<ImageError>(&result)) {
    REQUIRE_FALSE(error->message.empty());
    return;
  }
  const auto& image = std::get<Image>(result);
  REQUIRE(image.components >= 1);
  REQUIRE(image.components <= 4);
  REQUIRE(image.pixels.size() == std::size_t{image.width} * image.height * image.components);
  REQUIRE(std::size_t{image.width} * image.height <= 1 << 16);
}

void check_prefixes_and_flips(const Bytes& bytes) {
  for (std::size_t n = 0; n <= bytes.size(); ++n) {
    // A copy of exactly this size, so that reads beyond its end are detected.
    const Bytes prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    check_consistent(prefix);
  }
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int mask : {0x01, 0x10, 0x80, 0xff}) {
      Bytes flipped = bytes;
      flipped[i] ^= static_cast<std::byte>(mask);
      check_consistent(flipped);
    }
}

TEST_CASE("restores PNG images of 1 to 4 components") {
  for (std::uint32_t components = 1; components <= 4; ++components)
    for (const auto& [width, height] : {std::pair{1u, 1u}, {7u, 5u}, {64u, 3u}}) {
      const Image image = made(width, height, components);
      const Image back = decoded(encode_png(image));
      CHECK(back.width == width);
      CHECK(back.height == height);
      CHECK(back.components == components);
      CHECK(back.pixels == image.pixels);
    }
}

TEST_CASE("reads a PNG in bands of rows, and reports its printed size (PNG 11.3.5.3)") {
  const Image image = made(5, 150, 3);
  gs::render::PngWriter writer(5, 150, 3, 300);
  for (std::uint32_t y = 0; y < 150; y += 70) {
    const std::uint32_t rows = std::min(70u, 150 - y);
    const auto first = image.pixels.begin() + 15 * std::ptrdiff_t{y};
    writer.add({5, rows, 3, {first, first + 15 * std::ptrdiff_t{rows}}});
  }
  const Bytes bytes = writer.finish();
  CHECK(decoded(bytes).pixels == image.pixels);
  // 300 dots per inch are 11811 per metre.
  static constexpr unsigned char kChunk[] = {0, 0, 0, 9, 'p', 'H', 'Y', 's', 0, 0, 0x2e, 0x23, 0, 0, 0x2e, 0x23, 1};
  CHECK(std::memcmp(bytes.data() + 33, kChunk, sizeof kChunk) == 0);  // after the signature and IHDR
  gs::render::PngWriter incomplete(5, 150, 3);
  incomplete.add({5, 1, 3, std::vector<std::uint8_t>(15)});
  CHECK(incomplete.finish().empty());
  gs::render::PngWriter other(5, 2, 3);
  other.add({4, 2, 3, std::vector<std::uint8_t>(24)});
  CHECK(other.finish().empty());
}

TEST_CASE("writes images of many rows as the same PNG each time, compressed in strips") {
  for (const std::uint32_t height : {63u, 64u, 65u, 128u, 331u})
    for (std::uint32_t components = 1; components <= 4; ++components) {
      Image image = made(37, height, components);
      std::uint32_t noise = 1;
      for (std::size_t i = image.pixels.size() / 3; i < image.pixels.size() / 2; ++i) {
        noise = noise * 1664525 + 1013904223;
        image.pixels[i] = static_cast<std::uint8_t>(noise >> 24);
      }
      const Bytes bytes = encode_png(image);
      CHECK(decoded(bytes).pixels == image.pixels);
      CHECK(encode_png(image) == bytes);
    }
  // A uniform image compresses well.
  const Image flat{1000, 700, 3, std::vector<std::uint8_t>(std::size_t{2'100'000}, 77)};
  CHECK(encode_png(flat).size() < 20'000);
}

TEST_CASE("writes no PNG of an invalid image") {
  CHECK(encode_png({}).empty());
  CHECK(encode_png({2, 2, 3, {1, 2, 3}}).empty());
  CHECK(encode_png({1, 1, 5, {1, 2, 3, 4, 5}}).empty());
}

TEST_CASE("converts PNG palettes to components as VRML97 4.6.11.2 defines") {
  PngOptions options;
  options.color_type = PNG_COLOR_TYPE_PALETTE;
  const std::vector<png_byte> rows = {0, 1, 1, 0};
  options.palette = {{10, 20, 30}, {200, 200, 200}};
  Image image = decoded(png_of(2, 2, options, rows));
  CHECK(image.components == 3);
  CHECK(image.pixels == std::vector<std::uint8_t>{10, 20, 30, 200, 200, 200, 200, 200, 200, 10, 20, 30});

  options.transparency = {128};
  image = decoded(png_of(2, 2, options, rows));
  CHECK(image.components == 4);
  CHECK(row_of(image, 0) == std::vector<std::uint8_t>{10, 20, 30, 128, 200, 200, 200, 255});

  options.palette = {{40, 40, 40}, {200, 200, 200}};
  image = decoded(png_of(2, 2, options, rows));
  CHECK(image.components == 2);
  CHECK(image.pixels == std::vector<std::uint8_t>{40, 128, 200, 255, 200, 255, 40, 128});

  options.transparency.clear();
  image = decoded(png_of(2, 2, options, rows));
  CHECK(image.components == 1);
  CHECK(image.pixels == std::vector<std::uint8_t>{40, 200, 200, 40});
}

TEST_CASE("converts PNG of 1, 2, 4 and 16 bits to 8 bits") {
  PngOptions options;
  options.color_type = PNG_COLOR_TYPE_GRAY;
  options.depth = 1;
  CHECK(decoded(png_of(8, 1, options, {0xA0})).pixels == std::vector<std::uint8_t>{255, 0, 255, 0, 0, 0, 0, 0});
  options.depth = 4;
  CHECK(decoded(png_of(2, 1, options, {0x3F})).pixels == std::vector<std::uint8_t>{51, 255});
  options.depth = 16;
  CHECK(decoded(png_of(2, 1, options, {0xFF, 0xFF, 0x80, 0x80})).pixels == std::vector<std::uint8_t>{255, 128});
  options.color_type = PNG_COLOR_TYPE_RGB_ALPHA;
  const Image image = decoded(png_of(1, 1, options, {0, 0, 0x40, 0x40, 0x80, 0x80, 0xFF, 0xFF}));
  CHECK(image.components == 4);
  CHECK(image.pixels == std::vector<std::uint8_t>{0, 64, 128, 255});
}

TEST_CASE("decodes interlaced PNG to the same picture") {
  const Image image = made(13, 11, 3);
  PngOptions options;
  options.interlace = PNG_INTERLACE_ADAM7;
  const Bytes bytes = png_of(13, 11, options, image.pixels);
  CHECK(decoded(bytes).pixels == image.pixels);
  check_prefixes_and_flips(bytes);
}

TEST_CASE("keeps the rows of a truncated PNG, and fills the others black or transparent") {
  Image image{64, 64, 4, {}};
  unsigned noise = 1;
  for (int i = 0; i < 64 * 64 * 4; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>((noise = noise * 69069 + 1) >> 24));
  Bytes bytes = encode_png(image);
  bytes.resize(bytes.size() / 2);
  const Image part = decoded(bytes);
  REQUIRE(part.pixels.size() == image.pixels.size());
  CHECK(row_of(part, 0) == row_of(image, 0));
  CHECK(row_of(part, 20) == row_of(image, 20));
  CHECK(row_of(part, 63) == std::vector<std::uint8_t>(64 * 4, 0));
}

TEST_CASE("derives the components of a JPEG from its colour space") {
  const Image grey = decoded(jpeg_of(flat(9, 7, {77}), JCS_GRAYSCALE, JCS_GRAYSCALE));
  CHECK(grey.components == 1);
  CHECK(grey.width == 9);
  CHECK(grey.height == 7);
  CHECK(std::abs(int{grey.pixels[5]} - 77) <= 1);

  for (const J_COLOR_SPACE stored : {JCS_YCbCr, JCS_RGB})
    for (const bool progressive : {false, true}) {
      const Image color = decoded(jpeg_of(flat(20, 20, {200, 100, 50}), JCS_RGB, stored, progressive));
      CHECK(color.components == 3);
      CHECK(std::abs(int{color.pixels[0]} - 200) <= 2);
      CHECK(std::abs(int{color.pixels[1]} - 100) <= 2);
      CHECK(std::abs(int{color.pixels[2]} - 50) <= 2);
    }
}

TEST_CASE("converts CMYK JPEG to RGB") {
  // libjpeg writes an Adobe marker for YCCK only: there 255 means no ink.
  const Image adobe = decoded(jpeg_of(flat(8, 8, {255, 128, 0, 255}), JCS_CMYK, JCS_YCCK));
  REQUIRE(adobe.components == 3);
  CHECK(std::abs(int{adobe.pixels[0]} - 255) <= 3);
  CHECK(std::abs(int{adobe.pixels[1]} - 128) <= 3);
  CHECK(std::abs(int{adobe.pixels[2]} - 0) <= 3);
}

TEST_CASE("keeps the rows of a truncated JPEG, and fills the others black") {
  Image image = made(64, 128, 1);
  const Bytes whole = jpeg_of(image, JCS_GRAYSCALE, JCS_GRAYSCALE);
  const Image all = decoded(whole);
  Bytes half(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() * 2 / 3));
  const Image part = decoded(half);
  CHECK(row_of(part, 0) == row_of(all, 0));
  CHECK(row_of(part, 15) == row_of(all, 15));
  CHECK(row_of(part, 127) == std::vector<std::uint8_t>(64, 0));

  // A JPEG without its end marker is complete.
  const Bytes unfinished(whole.begin(), whole.end() - 2);
  CHECK(decoded(unfinished).pixels == all.pixels);
  CHECK(message_of(Bytes(whole.begin(), whole.begin() + 300)).find("broken JPEG") == 0);
}

TEST_CASE("decodes a truncated progressive JPEG to a coarse picture") {
  Image image = flat(64, 64, {180});
  const Bytes whole = jpeg_of(image, JCS_GRAYSCALE, JCS_GRAYSCALE, true);
  const Image part = decoded(Bytes(whole.begin(), whole.end() - 20));
  CHECK(std::abs(int{part.pixels.back()} - 180) <= 2);
}

TEST_CASE("converts GIF palettes and transparency to components") {
  Image image = decoded(gif_of({}));
  CHECK(image.components == 3);
  CHECK(row_of(image, 0) == std::vector<std::uint8_t>{0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255});
  CHECK(row_of(image, 1) == std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0});

  GifOptions options;
  options.grey = true;
  image = decoded(gif_of(options));
  CHECK(image.components == 1);
  CHECK(row_of(image, 3) == std::vector<std::uint8_t>{255, 0, 85, 170});

  options.transparent = 1;
  image = decoded(gif_of(options));
  CHECK(image.components == 2);
  CHECK(row_of(image, 0) == std::vector<std::uint8_t>{0, 255, 0, 0, 170, 255, 255, 255});

  options.grey = false;
  image = decoded(gif_of(options));
  CHECK(image.components == 4);
  CHECK(row_of(image, 0) == std::vector<std::uint8_t>{0, 0, 0, 255, 0, 0, 0, 0, 0, 255, 0, 255, 0, 0, 255, 255});
}

TEST_CASE("places a GIF picture in its canvas, and orders interlaced rows") {
  GifOptions options;
  options.canvas_width = 6;
  options.left = 1;
  options.top = 2;
  Image image = decoded(gif_of(options));
  CHECK(image.width == 6);
  CHECK(image.height == 4);
  REQUIRE(image.components == 4);
  CHECK(row_of(image, 0) == std::vector<std::uint8_t>(24, 0));
  CHECK(row_of(image, 2) == std::vector<std::uint8_t>{0, 0,   0, 0,   0, 0, 0,   255, 255, 0, 0, 255,
                                                      0, 255, 0, 255, 0, 0, 255, 255, 0,   0, 0, 0});
  options = {};
  options.grey = options.interlaced = true;
  image = decoded(gif_of(options));
  CHECK(row_of(image, 0) == std::vector<std::uint8_t>{0, 85, 170, 255});
  CHECK(row_of(image, 2) == std::vector<std::uint8_t>{85, 170, 255, 0});
  CHECK(row_of(image, 1) == std::vector<std::uint8_t>{170, 255, 0, 85});
  CHECK(row_of(image, 3) == std::vector<std::uint8_t>{255, 0, 85, 170});
}

TEST_CASE("keeps the rows of a truncated GIF") {
  GifOptions options;
  options.grey = true;
  const Bytes whole = gif_of(options);
  // Two end bytes, then codes of 18 bits per row: without three bytes of codes, row 3 is missing.
  const Image part = decoded(Bytes(whole.begin(), whole.end() - 5));
  CHECK(row_of(part, 2) == std::vector<std::uint8_t>{170, 255, 0, 85});
  CHECK(row_of(part, 3) == std::vector<std::uint8_t>{0, 0, 0, 0});
  CHECK(decoded(Bytes(whole.begin(), whole.end() - 2)).pixels == decoded(whole).pixels);
}

TEST_CASE("survives every truncation and every flipped byte of an image") {
  check_prefixes_and_flips(encode_png(made(5, 4, 4)));
  PngOptions options;
  options.color_type = PNG_COLOR_TYPE_PALETTE;
  options.palette = {{40, 40, 40}, {200, 200, 200}};
  options.transparency = {7};
  check_prefixes_and_flips(png_of(2, 2, options, {0, 1, 1, 0}));
  check_prefixes_and_flips(jpeg_of(made(20, 18, 3), JCS_RGB, JCS_YCbCr));
  check_prefixes_and_flips(jpeg_of(made(9, 9, 1), JCS_GRAYSCALE, JCS_GRAYSCALE, true));
  check_prefixes_and_flips(jpeg_of(flat(8, 8, {255, 128, 0, 255}), JCS_CMYK, JCS_YCCK));
  GifOptions gif;
  gif.transparent = 2;
  check_prefixes_and_flips(gif_of(gif));
  gif.interlaced = true;
  check_prefixes_and_flips(gif_of(gif));
}

TEST_CASE("allocates nothing for a header that claims a huge picture") {
  Bytes png = encode_png(made(1, 1, 3));
  for (const std::size_t at : {std::size_t{18}, std::size_t{22}}) {
    png[at] = std::byte{60000 >> 8};
    png[at + 1] = std::byte{60000 & 255};
  }
  CHECK(message_of(png) ==
        "PNG image of 60000x60000 pixels; expected at most 268435456 pixels and no side over 1000000");

  Bytes jpeg = jpeg_of(flat(8, 8, {1}), JCS_GRAYSCALE, JCS_GRAYSCALE);
  std::size_t frame = 0;
  while (jpeg[frame] != std::byte{0xFF} || jpeg[frame + 1] != std::byte{0xC0}) ++frame;
  for (const std::size_t at : {frame + 5, frame + 7}) {
    jpeg[at] = std::byte{60000 >> 8};
    jpeg[at + 1] = std::byte{60000 & 255};
  }
  CHECK(message_of(jpeg).find("JPEG image of 60000x60000 pixels") == 0);

  Bytes gif = gif_of({});
  for (const std::size_t at : {6u, 8u}) {
    gif[at] = std::byte{60000 & 255};
    gif[at + 1] = std::byte{60000 >> 8};
  }
  CHECK(message_of(gif).find("GIF image of 60000x60000 pixels") == 0);

  CHECK(message_of(encode_png(made(10, 10, 3)), 99).find("expected at most 99 pixels") != std::string::npos);
  CHECK(decoded(encode_png(made(10, 10, 3))).width == 10);
}

TEST_CASE("rejects data that are no image, and names the expected formats") {
  CHECK(message_of({}) ==
        "unsupported image format; expected the first bytes of a PNG, JPEG, GIF, BMP, PPM, SGI, Targa, DDS, NRRD or movie, found "
        "nothing");
  CHECK(message_of(bytes_of({'#', 'V', 'R'})) ==
        "unsupported image format; expected the first bytes of a PNG, JPEG, GIF, BMP, PPM, SGI, Targa, DDS, NRRD or movie, found 23 56 "
        "52");
  CHECK(message_of(bytes_of({0xff, 0xd8, 0xff, 0xd9})).find("broken JPEG") == 0);
}

}  // namespace

TEST_CASE("reads bitmaps, pixmaps and Targa files of other programs") {
  const auto read = [](const std::string& name) {
    std::ifstream file(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/" + name, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    REQUIRE_FALSE(text.empty());
    const auto decoded = gs::render::decode_image(std::as_bytes(std::span(text)));
    REQUIRE(std::holds_alternative<gs::render::Image>(decoded));
    return std::get<gs::render::Image>(decoded);
  };
  const gs::render::Image first = read("ppm/rgb.ppm");
  CHECK(first.width == 7);
  CHECK(first.height == 5);
  CHECK(first.components == 3);
  CHECK(first.pixels[0] == 255);                        // from red at the top
  CHECK(first.pixels[first.pixels.size() - 1] == 252);  // to blue
  for (const char* other : {"bmp/rgb.bmp", "bmp/old.bmp", "targa/rgb.tga", "targa/packed.tga"}) {
    INFO(other);
    const gs::render::Image image = read(other);
    const auto difference = gs::render::compare(first, image);
    REQUIRE(std::holds_alternative<gs::render::ImageDifference>(difference));
    CHECK(std::get<gs::render::ImageDifference>(difference).maximum == 0);
  }
  const gs::render::Image glass = read("targa/alpha.tga");
  REQUIRE(glass.components == 4);
  CHECK(glass.pixels[0] == 10);
  CHECK(glass.pixels[3] >= 127);
  CHECK(glass.pixels[3] <= 128);
  CHECK(read("pgm/grey.pgm").components == 1);
  CHECK(read("bmp/palette.bmp").width == 9);
}

TEST_CASE("rejects a truncated or huge bitmap in one line") {
  std::ifstream file(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/bmp/old.bmp", std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  std::string huge = text;
  huge[18] = huge[19] = huge[22] = huge[23] = '\x7f';
  huge[20] = huge[24] = '\x0f';
  for (const std::string& bad : {text.substr(0, 20), text.substr(0, 2), huge}) {
    const auto decoded = gs::render::decode_image(std::as_bytes(std::span(bad)));
    REQUIRE(std::holds_alternative<gs::render::ImageError>(decoded));
    CHECK_FALSE(std::get<gs::render::ImageError>(decoded).message.empty());
  }
}

TEST_CASE("refuses PPM and PGM headers with numbers of more than nine digits") {
  for (const std::string header : {"P5 44444444445 1 255 ", "P6\n# 1\n1 99999999999\n255\n", "P6 1 1 2555555555 "}) {
    INFO(header);
    const auto decoded = gs::render::decode_image(std::as_bytes(std::span(header)));
    const auto* error = std::get_if<gs::render::ImageError>(&decoded);
    REQUIRE(error);
    CHECK(error->message == "its header has a number of more than nine digits; expected width, height and largest value");
  }
  const std::string comment = "P5 # 12345678901\n1 1 255 a";  // not a number of the header
  const auto decoded = gs::render::decode_image(std::as_bytes(std::span(comment)));
  CHECK(std::holds_alternative<gs::render::Image>(decoded));
}

TEST_CASE("refuses a bitmap without pixels") {
  for (const char* name : {"no_rows.bmp", "no_rows24.bmp", "no_columns.bmp"}) {
    INFO(name);
    std::ifstream file(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/bmp/" + name, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    REQUIRE(text.size() == 118);
    std::string message;
    // Uses a new thread, since the decoder keeps the reason of an earlier failure per thread.
    std::thread([&] {
      const auto decoded = gs::render::decode_image(std::as_bytes(std::span(text)));
      if (const auto* error = std::get_if<gs::render::ImageError>(&decoded)) message = error->message;
    }).join();
    CHECK(message == std::string("it has no pixels; its size is ") + (name[3] == 'c' ? "0 x 9" : "9 x 0"));
  }
}
