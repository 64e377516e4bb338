#pragma once

#include "tests/render/image_difference.h"

#include <catch2/catch.hpp>

#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <utility>
#include <variant>
#include <vector>

#include <jpeglib.h>
#include <png.h>

/// Images, and image files, for tests.
namespace gs::test {

using gs::render::decode_image;
using gs::render::encode_png;
using gs::render::Image;
using gs::render::ImageDifference;
using gs::render::ImageError;
using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

inline Image made(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
  Image image{width, height, components, {}};
  for (std::uint32_t i = 0; i < width * height * components; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>(i * 37 + i / 7));
  return image;
}

inline Image decoded(const Bytes& bytes) {
  auto result = decode_image(bytes);
  if (const auto* error = std::get_if<ImageError>(&result)) FAIL(error->message);
  return std::get<Image>(std::move(result));
}

struct PngOptions {
  int color_type = PNG_COLOR_TYPE_RGB, depth = 8, interlace = PNG_INTERLACE_NONE;
  std::vector<png_color> palette;
  std::vector<png_byte> transparency;
};

/// Writes a PNG of any kind with libpng. `rows` holds height rows in PNG's packing.
inline Bytes png_of(std::uint32_t width, std::uint32_t height, const PngOptions& options, std::vector<png_byte> rows) {
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

inline Bytes jpeg_of(const Image& image, J_COLOR_SPACE in, J_COLOR_SPACE stored, bool progressive = false) {
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

inline Image flat(std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t> color) {
  Image image{width, height, static_cast<std::uint32_t>(color.size()), {}};
  for (std::uint32_t i = 0; i < width * height; ++i)
    image.pixels.insert(image.pixels.end(), color.begin(), color.end());
  return image;
}

/// A 4x4 GIF with the palette indices 0 1 2 3 in each row. Codes have 3 bits, with a clear code before each pair so
/// that they never grow: 4 a b, low bits first, and 5 at the end.
struct GifOptions {
  int canvas_width = 4, canvas_height = 4, left = 0, top = 0;
  int transparent = -1;
  bool grey = false, interlaced = false;
};

inline Bytes gif_of(const GifOptions& options) {
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
      // The first row of the file is row 0 in both orders; the others are rotated to differ.
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

inline std::vector<std::uint8_t> row_of(const Image& image, std::uint32_t y) {
  const auto stride = static_cast<std::ptrdiff_t>(image.width * image.components);
  return {image.pixels.begin() + y * stride, image.pixels.begin() + (y + 1) * stride};
}

}  // namespace gs::test
