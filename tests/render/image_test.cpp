#include "render/image.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include <jpeglib.h>
#include <png.h>

namespace {

using gs::render::compare;
using gs::render::decode_image;
using gs::render::encode_png;
using gs::render::Image;
using gs::render::ImageDifference;
using gs::render::ImageError;
using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

Image made(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
  Image image{width, height, components, {}};
  for (std::uint32_t i = 0; i < width * height * components; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>(i * 37 + i / 7));
  return image;
}

Image decoded(const Bytes& bytes) {
  auto result = decode_image(bytes);
  if (const auto* error = std::get_if<ImageError>(&result)) FAIL(error->message);
  return std::get<Image>(std::move(result));
}

std::string message_of(const Bytes& bytes, std::size_t max_pixels = std::size_t{1} << 28) {
  const auto result = decode_image(bytes, max_pixels);
  REQUIRE(std::holds_alternative<ImageError>(result));
  return std::get<ImageError>(result).message;
}

/// Any answer is right that keeps the promises of Image.
void check_consistent(std::span<const std::byte> bytes) {
  const auto result = decode_image(bytes, 1 << 16);
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
    // A copy of exactly this size, so that reading past the end is seen.
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

struct PngOptions {
  int color_type = PNG_COLOR_TYPE_RGB, depth = 8, interlace = PNG_INTERLACE_NONE;
  std::vector<png_color> palette;
  std::vector<png_byte> transparency;
};

/// A PNG of any kind, written with libpng; `rows` holds height rows as PNG packs them.
Bytes png_of(std::uint32_t width, std::uint32_t height, const PngOptions& options, std::vector<png_byte> rows) {
  Bytes out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  if (setjmp(png_jmpbuf(png))) std::abort();
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, png_size_t size) {
        auto* to = static_cast<Bytes*>(png_get_io_ptr(p));
        const auto* from = reinterpret_cast<const std::byte*>(data);
        to->insert(to->end(), from, from + size);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, width, height, options.depth, options.color_type, options.interlace, 0, 0);
  if (!options.palette.empty())
    png_set_PLTE(png, info, options.palette.data(), static_cast<int>(options.palette.size()));
  if (!options.transparency.empty())
    png_set_tRNS(png, info, options.transparency.data(), static_cast<int>(options.transparency.size()), nullptr);
  png_write_info(png, info);
  const std::size_t stride = rows.size() / height;
  std::vector<png_bytep> starts;
  for (std::uint32_t y = 0; y < height; ++y) starts.push_back(rows.data() + y * stride);
  png_write_image(png, starts.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

Bytes jpeg_of(const Image& image, J_COLOR_SPACE in, J_COLOR_SPACE stored, bool progressive = false) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = image.width;
  jpeg.image_height = image.height;
  jpeg.input_components = static_cast<int>(image.components);
  jpeg.in_color_space = in;
  jpeg_set_defaults(&jpeg);
  jpeg_set_colorspace(&jpeg, stored);
  jpeg_set_quality(&jpeg, 100, TRUE);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    auto* row = const_cast<std::uint8_t*>(image.pixels.data() + std::size_t{y} * image.width * image.components);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  const auto* first = reinterpret_cast<const std::byte*>(memory);
  Bytes out(first, first + size);
  std::free(memory);
  return out;
}

Image flat(std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t> color) {
  Image image{width, height, static_cast<std::uint32_t>(color.size()), {}};
  for (std::uint32_t i = 0; i < width * height; ++i)
    image.pixels.insert(image.pixels.end(), color.begin(), color.end());
  return image;
}

/// A 4x4 GIF whose pixels are the palette indices 0 1 2 3 in each row. Codes of 3 bits, a clear code before
/// each pair so that they never grow: 4 a b, low bits first, and 5 at the end.
struct GifOptions {
  int canvas_width = 4, canvas_height = 4, left = 0, top = 0;
  int transparent = -1;
  bool grey = false, interlaced = false;
};

Bytes gif_of(const GifOptions& options) {
  Bytes out;
  const auto put = [&out](std::initializer_list<int> values) {
    const Bytes more = bytes_of(values);
    out.insert(out.end(), more.begin(), more.end());
  };
  put({'G', 'I', 'F', '8', '9', 'a', options.canvas_width, 0, options.canvas_height, 0, 0x91, 0, 0});
  if (options.grey)
    put({0, 0, 0, 85, 85, 85, 170, 170, 170, 255, 255, 255});
  else
    put({0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255});
  if (options.transparent >= 0) put({0x21, 0xF9, 4, 1, 0, 0, options.transparent, 0});
  put({0x2C, options.left, 0, options.top, 0, 4, 0, 4, 0, options.interlaced ? 0x40 : 0, 2});
  std::uint64_t bits = 0;
  int used = 0;
  std::vector<int> data;
  const auto code = [&](std::uint64_t value) {
    bits |= value << used;
    used += 3;
    while (used >= 8) {
      data.push_back(static_cast<int>(bits & 255));
      bits >>= 8;
      used -= 8;
    }
  };
  for (int row = 0; row < 4; ++row)
    for (const std::uint64_t pair : {0, 2}) {
      code(4);
      // The first row of the file is row 0 either way; the others are turned to tell them apart.
      code((pair + static_cast<std::uint64_t>(row)) & 3);
      code((pair + 1 + static_cast<std::uint64_t>(row)) & 3);
    }
  code(5);
  data.push_back(static_cast<int>(bits & 255));
  put({static_cast<int>(data.size())});
  for (const int value : data) put({value});
  put({0, 0x3B});
  return out;
}

std::vector<std::uint8_t> row_of(const Image& image, std::uint32_t y) {
  const auto stride = static_cast<std::ptrdiff_t>(image.width * image.components);
  return {image.pixels.begin() + y * stride, image.pixels.begin() + (y + 1) * stride};
}

TEST_CASE("PNG keeps images of 1 to 4 components") {
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

TEST_CASE("what is no image has no PNG") {
  CHECK(encode_png({}).empty());
  CHECK(encode_png({2, 2, 3, {1, 2, 3}}).empty());
  CHECK(encode_png({1, 1, 5, {1, 2, 3, 4, 5}}).empty());
}

TEST_CASE("PNG palettes become components as VRML97 4.6.11.2 says") {
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

TEST_CASE("PNG of 1, 2, 4 and 16 bits becomes 8 bits") {
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

TEST_CASE("interlaced PNG is the same picture") {
  const Image image = made(13, 11, 3);
  PngOptions options;
  options.interlace = PNG_INTERLACE_ADAM7;
  const Bytes bytes = png_of(13, 11, options, image.pixels);
  CHECK(decoded(bytes).pixels == image.pixels);
  check_prefixes_and_flips(bytes);
}

TEST_CASE("a truncated PNG keeps its rows, the rest is black or transparent") {
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

TEST_CASE("JPEG components follow its colour space") {
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

TEST_CASE("JPEG of inks becomes RGB") {
  // libjpeg writes an Adobe marker for YCCK only: there 255 means no ink.
  const Image adobe = decoded(jpeg_of(flat(8, 8, {255, 128, 0, 255}), JCS_CMYK, JCS_YCCK));
  REQUIRE(adobe.components == 3);
  CHECK(std::abs(int{adobe.pixels[0]} - 255) <= 3);
  CHECK(std::abs(int{adobe.pixels[1]} - 128) <= 3);
  CHECK(std::abs(int{adobe.pixels[2]} - 0) <= 3);
}

TEST_CASE("a truncated JPEG keeps its rows, the rest is black") {
  Image image = made(64, 128, 1);
  const Bytes whole = jpeg_of(image, JCS_GRAYSCALE, JCS_GRAYSCALE);
  const Image all = decoded(whole);
  Bytes half(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() * 2 / 3));
  const Image part = decoded(half);
  CHECK(row_of(part, 0) == row_of(all, 0));
  CHECK(row_of(part, 15) == row_of(all, 15));
  CHECK(row_of(part, 127) == std::vector<std::uint8_t>(64, 0));

  // Without its end marker a JPEG is still whole.
  const Bytes unfinished(whole.begin(), whole.end() - 2);
  CHECK(decoded(unfinished).pixels == all.pixels);
  CHECK(message_of(Bytes(whole.begin(), whole.begin() + 300)).find("broken JPEG") == 0);
}

TEST_CASE("a truncated progressive JPEG is a coarse picture") {
  Image image = flat(64, 64, {180});
  const Bytes whole = jpeg_of(image, JCS_GRAYSCALE, JCS_GRAYSCALE, true);
  const Image part = decoded(Bytes(whole.begin(), whole.end() - 20));
  CHECK(std::abs(int{part.pixels.back()} - 180) <= 2);
}

TEST_CASE("GIF palettes and transparency become components") {
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

TEST_CASE("a GIF picture stands in its canvas, interlaced rows are put in order") {
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

TEST_CASE("a truncated GIF keeps its rows") {
  GifOptions options;
  options.grey = true;
  const Bytes whole = gif_of(options);
  // Two bytes of end, then codes of 18 bits a row: without three bytes of codes row 3 is gone.
  const Image part = decoded(Bytes(whole.begin(), whole.end() - 5));
  CHECK(row_of(part, 2) == std::vector<std::uint8_t>{170, 255, 0, 85});
  CHECK(row_of(part, 3) == std::vector<std::uint8_t>{0, 0, 0, 0});
  CHECK(decoded(Bytes(whole.begin(), whole.end() - 2)).pixels == decoded(whole).pixels);
}

TEST_CASE("no part of an image and no flipped byte breaks a decoder") {
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

TEST_CASE("a header that claims a huge picture costs nothing") {
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

TEST_CASE("what is not an image is said so") {
  CHECK(message_of({}) ==
        "not an image that can be read: expected the first bytes of a PNG, JPEG or GIF, found nothing");
  CHECK(message_of(bytes_of({'#', 'V', 'R'})) ==
        "not an image that can be read: expected the first bytes of a PNG, JPEG or GIF, found 23 56 52");
  CHECK(message_of(bytes_of({0xff, 0xd8, 0xff, 0xd9})).find("broken JPEG") == 0);
}

TEST_CASE("compare measures the distance of two pictures") {
  const Image a{2, 1, 3, {0, 0, 0, 10, 20, 30}};
  Image b = a;
  auto result = compare(a, b);
  REQUIRE(std::holds_alternative<ImageDifference>(result));
  auto difference = std::get<ImageDifference>(result);
  CHECK(difference.maximum == 0);
  CHECK(difference.mean == 0);
  CHECK(std::isinf(difference.psnr));
  CHECK(difference.differing_pixels == 0);

  b.pixels[3] = 16;
  b.pixels[5] = 18;
  difference = std::get<ImageDifference>(compare(a, b));
  CHECK(difference.maximum == 12);
  CHECK(difference.mean == Approx(18.0 / 6));
  CHECK(difference.differing_pixels == 1);
  // Mean square: (36 + 144) / 6 = 30.
  CHECK(difference.psnr == Approx(10 * std::log10(255.0 * 255.0 / 30)));
}

TEST_CASE("compare takes different kinds as RGBA and refuses different sizes") {
  const Image grey{1, 1, 1, {9}};
  CHECK(std::get<ImageDifference>(compare(grey, {1, 1, 3, {9, 9, 9}})).maximum == 0);
  CHECK(std::get<ImageDifference>(compare(grey, {1, 1, 4, {9, 9, 9, 0}})).maximum == 255);
  CHECK(std::get<ImageError>(compare(grey, {1, 2, 1, {9, 9}})).message == "pictures of different size: 1x1 and 1x2");
  CHECK(std::holds_alternative<ImageError>(compare(grey, {1, 1, 1, {}})));
}

}  // namespace
