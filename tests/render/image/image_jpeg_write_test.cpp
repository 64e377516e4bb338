#include "render/image/image.h"

#include "tests/render/image_difference.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <variant>
#include <vector>

namespace gs::render::image_jpeg_write_test {
namespace {

Image scene(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
  Image image;
  image.width = width;
  image.height = height;
  image.components = components;
  std::mt19937 random(2);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (std::uint32_t k = 0; k < components; ++k) {
        const auto fx = static_cast<double>(x), fy = static_cast<double>(y);
        image.pixels.push_back(static_cast<std::uint8_t>(128 + 60 * std::sin(fx / (7.0 + k)) +
                                                         50 * std::cos(fy / 11.0) + static_cast<double>(random() % 9)));
      }
  return image;
}
double psnr(const Image& a, const Image& b) {
  const auto off = compare(a, b);
  return std::holds_alternative<ImageDifference>(off) ? std::get<ImageDifference>(off).psnr : -1;
}

}  // namespace

TEST_CASE("writes JPEG files that decode with less error at higher quality") {
  for (const std::uint32_t components : {1u, 3u}) {
    const Image image = scene(150, 90, components);
    double before = 0;
    std::size_t size = 0;
    for (const int quality : {20, 60, 92, 100}) {
      const std::vector<std::byte> file = encode_jpeg(image, {quality, true});
      const auto back = decode_image(file);
      REQUIRE(std::holds_alternative<Image>(back));
      const double now = psnr(std::get<Image>(back), image);
      CHECK(now > before);
      CHECK(file.size() > size);
      before = now;
      size = file.size();
    }
    CHECK(before > 45);
  }
  const Image image = scene(64, 64, 3);
  CHECK(encode_jpeg(image, {90, false}).size() < encode_jpeg(image, {90, true}).size());
}

TEST_CASE("refines the whole picture with each scan of a JPEG file") {
  for (const std::uint32_t components : {1u, 3u}) {
    const Image image = scene(200, 160, components);
    const std::vector<std::byte> file = encode_jpeg(image);
    const std::vector<std::size_t> ends = scan_ends(file);
    REQUIRE(ends.size() == (components == 1 ? 10 : 21));
    CHECK(ends.back() + 2 == file.size());
    double before = 0;
    for (const std::size_t end : ends) {
      const auto part = decode_image(std::span(file).first(end));
      REQUIRE(std::holds_alternative<Image>(part));
      REQUIRE(std::get<Image>(part).height == 160);
      const double now = psnr(std::get<Image>(part), image);
      CHECK(now > before - 0.05);
      before = now;
    }
    CHECK(ends.front() < file.size() / 4);
  }
}

TEST_CASE("refuses to write an empty picture, and finds no scans in other files") {
  Image image = scene(8, 8, 3);
  image.pixels.pop_back();
  CHECK(encode_jpeg(image).empty());
  CHECK(encode_jpeg(scene(8, 8, 4)).empty());
  CHECK(encode_jpeg({}).empty());
  CHECK(scan_ends({}).empty());
  std::mt19937 random(6);
  const std::vector<std::byte> file = encode_jpeg(scene(40, 40, 3));
  for (int round = 0; round < 200; ++round) {
    std::vector<std::byte> mutated = file;
    for (int i = 0; i < 5; ++i)
      mutated[random() % mutated.size()] = static_cast<std::byte>(random() % 3 == 0 ? 255 : random());
    for (const std::size_t end : scan_ends(mutated)) CHECK(end <= mutated.size());
  }
}

}  // namespace gs::render::image_jpeg_write_test
