// Tests of mipmaps against an independent box filter.
#include "render/gl/texture_store.h"

#include "render/gl/context.h"
#include "tests/render/drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace gs::texture_store_test {
namespace {

using namespace render;

/// OpenGL 3.3 core profile, 6.1.4.
using GetTexImage = void (*)(GLenum target, GLint level, GLenum format, GLenum type, void* pixels);
constexpr GLenum kFormats[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};

Image random_image(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
  std::mt19937 random(width * 1000 + height * 10 + components);
  Image image{width, height, components, std::vector<std::uint8_t>(std::size_t{width} * height * components)};
  for (std::uint8_t& value : image.pixels) value = static_cast<std::uint8_t>(random());
  return image;
}

/// Returns the overlap of a pixel with part `part` of `to` equal parts of the image.
double overlap(std::uint32_t pixel, std::uint32_t part, std::uint32_t from, std::uint32_t to) {
  const double begin = static_cast<double>(part) * from / to, end = static_cast<double>(part + 1) * from / to;
  return std::max(0.0, std::min<double>(pixel + 1, end) - std::max<double>(pixel, begin));
}

/// Returns the mean of the image area under pixel (x, y) of a picture of `width` x `height`.
double mean_of(const Image& image, std::uint32_t width, std::uint32_t height, std::uint32_t x, std::uint32_t y,
               std::uint32_t component) {
  double sum = 0, area = 0;
  const std::uint32_t rows = (y + 1) * image.height / height + 1, columns = (x + 1) * image.width / width + 1;
  for (std::uint32_t row = y * image.height / height; row < std::min(rows, image.height); ++row)
    for (std::uint32_t column = x * image.width / width; column < std::min(columns, image.width); ++column) {
      const double part = overlap(column, x, image.width, width) * overlap(row, y, image.height, height);
      if (part <= 0) continue;
      area += part;
      sum += part * image.pixels[(std::size_t{row} * image.width + column) * image.components + component];
    }
  return sum / area;
}

}  // namespace

TEST_CASE("filters each mipmap level from the one before by a box filter, for any size") {
  auto opened = open_headless_context("osmesa");
  REQUIRE(std::holds_alternative<std::unique_ptr<GlContext>>(opened));
  GlContext& context = *std::get<std::unique_ptr<GlContext>>(opened);
  context.make_current();
  auto loaded = Gl::load(context);
  REQUIRE(std::holds_alternative<Gl>(loaded));
  const Gl& gl = std::get<Gl>(loaded);
  REQUIRE(gl.software);  // with a GPU, the driver filters in its own way
  const auto get_image = reinterpret_cast<GetTexImage>(context.proc_address("glGetTexImage"));
  REQUIRE(get_image);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);

  const std::pair<std::uint32_t, std::uint32_t> sizes[] = {{1, 1},  {2, 1},  {1, 3},   {1, 64}, {37, 1},  {8, 8},
                                                           {16, 4}, {13, 6}, {31, 31}, {5, 12}, {100, 7}, {64, 65}};
  for (const auto& [width, height] : sizes)
    for (std::uint32_t components = 1; components <= 4; ++components) {
      INFO(width << " x " << height << ", " << components << " components");
      TextureStore store(gl);
      const auto image = std::make_shared<const Image>(random_image(width, height, components));
      const TextureStore::Entry* entry = store.find(image);
      REQUIRE(entry);
      store.bind(*entry, false, false);
      Image before = *image;
      GLint level = 0;
      for (;; ++level) {
        // OpenGL 3.3 core profile, 3.8.14: each level has half the size, rounded down, until one pixel.
        const std::uint32_t wide = std::max(width >> level, 1u), high = std::max(height >> level, 1u);
        Image stored{wide, high, components, std::vector<std::uint8_t>(std::size_t{wide} * high * components)};
        get_image(GL_TEXTURE_2D, level, kFormats[components - 1], GL_UNSIGNED_BYTE, stored.pixels.data());
        REQUIRE(gl.GetError() == GL_NO_ERROR);
        double worst = 0;
        for (std::uint32_t y = 0; y < high; ++y)
          for (std::uint32_t x = 0; x < wide; ++x)
            for (std::uint32_t c = 0; c < components; ++c) {
              const double stored_value = stored.pixels[(std::size_t{y} * wide + x) * components + c];
              worst = std::max(worst, std::abs(stored_value - mean_of(before, wide, high, x, y, c)));
            }
        INFO("level " << level);
        CHECK(worst <= (level == 0 ? 0 : 0.5 + 1e-9));
        before = std::move(stored);
        if (wide == 1 && high == 1) break;
      }
      CHECK(level == static_cast<GLint>(std::floor(std::log2(std::max(width, height)))));
    }
}

}  // namespace gs::texture_store_test
