// Decoders of volumes and cubes: DDS and NRRD.

#include "base/gzip.h"
#include "render/image/image.h"

#include <catch2/catch.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs::render::image_volumes_test {
namespace {

using Bytes = std::vector<std::byte>;

std::variant<Image, ImageError> decode(const std::string& text) {
  return decode_image(std::as_bytes(std::span(text.data(), text.size())));
}

Image decoded(const std::string& text) {
  auto result = decode(text);
  if (const auto* error = std::get_if<ImageError>(&result)) FAIL(error->message);
  return std::get<Image>(std::move(result));
}

void put(std::string& to, std::size_t at, std::uint32_t word) {
  for (std::size_t i = 0; i < 4; ++i) to[at + i] = static_cast<char>(word >> (8 * i));
}

/// Returns a header of DDS with 32 bits per pixel, BGRA.
std::string dds(std::uint32_t width, std::uint32_t height, std::uint32_t depth = 0, std::uint32_t caps = 0) {
  std::string file(128, '\0');
  file.replace(0, 4, "DDS ");
  put(file, 4, 124);
  put(file, 12, height);
  put(file, 16, width);
  put(file, 24, depth);
  put(file, 76, 32);
  put(file, 80, 0x41);
  put(file, 88, 32);
  put(file, 92, 0xFF0000);
  put(file, 96, 0xFF00);
  put(file, 100, 0xFF);
  put(file, 104, 0xFF000000);
  put(file, 112, caps);
  return file;
}

}  // namespace

TEST_CASE("decodes pixels of DDS as RGBA, rows from the top") {
  const Image image = decoded(dds(1, 2) + "\x01\x02\x03\x04\x05\x06\x07\x08");
  CHECK(image.width == 1);
  CHECK(image.height == 2);
  CHECK(image.pixels == std::vector<std::uint8_t>{3, 2, 1, 4, 7, 6, 5, 8});
}

TEST_CASE("decodes the slices of a DDS volume and the faces of a DDS cube") {
  const Image volume = decoded(dds(1, 1, 2, 0x200000) + "\x01\x02\x03\x04\x05\x06\x07\x08");
  CHECK(volume.slices == 2);
  CHECK(volume.height == 2);
  CHECK(!volume.cube);
  const Image cube = decoded(dds(1, 1, 0, 0x200) + std::string(24, '\x10'));
  CHECK(cube.cube);
  CHECK(cube.slices == 6);
}

TEST_CASE("decodes blocks of DXT1 and DXT5") {
  std::string file = dds(4, 4);
  put(file, 80, 4);
  file.replace(84, 4, "DXT1");
  // Colours red and blue, and the index 0 in the first row, 1 in the second.
  const Image image = decoded(file + std::string("\x00\xF8\x1F\x00\x00\x55\x00\x00", 8));
  CHECK(image.pixels[0] == 255);
  CHECK(image.pixels[2] == 0);
  CHECK(image.pixels[16] == 0);
  CHECK(image.pixels[18] == 255);
  file.replace(84, 4, "DXT5");
  const Image alpha =
      decoded(file + std::string("\x80\x00\x00\x00\x00\x00\x00\x00\x00\xF8\x1F\x00\x00\x00\x00\x00", 16));
  CHECK(alpha.pixels[3] == 128);
}

TEST_CASE("rejects DDS files that are truncated, empty or too large") {
  CHECK(std::holds_alternative<ImageError>(decode(dds(4, 4))));
  CHECK(std::holds_alternative<ImageError>(decode("DDS ")));
  CHECK(std::holds_alternative<ImageError>(decode(dds(0, 4))));
  CHECK(std::holds_alternative<ImageError>(decode(dds(1u << 31, 1u << 31))));
}

TEST_CASE("decodes NRRD volumes in each encoding, with t = 0 at the bottom") {
  const std::string header = "NRRD0001\ntype: unsigned char\ndimension: 3\nsizes: 1 2 2\nencoding: ";
  const std::vector<std::uint8_t> wanted{20, 10, 40, 30};
  const std::string raw = "\x0A\x14\x1E\x28";
  CHECK(decoded(header + "raw\n\n" + raw).pixels == wanted);
  CHECK(decoded(header + "ascii\n\n10 20\n30 40\n").pixels == wanted);
  CHECK(decoded(header + "hex\n\n0a14 1e28\n").pixels == wanted);
  const Bytes packed = gzip(std::as_bytes(std::span(raw.data(), raw.size())));
  const Image image =
      decoded(header + "gzip\n\n" + std::string(reinterpret_cast<const char*>(packed.data()), packed.size()));
  CHECK(image.pixels == wanted);
  CHECK(image.slices == 2);
}

TEST_CASE("decodes components and 16-bit samples of NRRD") {
  const Image color = decoded("NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 1 1 1\nencoding: ascii\n\n1 2 3");
  CHECK(color.components == 3);
  CHECK(color.pixels == std::vector<std::uint8_t>{1, 2, 3});
  const Image deep = decoded("NRRD0004\ntype: short\ndimension: 3\nsizes: 3 1 1\nencoding: raw\nendian: big\n\n" +
                             std::string("\xFF\x00\x00\x00\x01\x00", 6));
  CHECK(deep.pixels == std::vector<std::uint8_t>{0, 127, 255});
}

TEST_CASE("reduces NRRD volumes above the limit of voxels to means") {
  std::string data = "NRRD0001\ntype: uchar\nsizes: 4 3 2\nencoding: raw\n\n";
  for (int i = 0; i < 24; ++i) data += static_cast<char>(i * 10);
  ImageLimits limits;
  limits.kept_pixels = 4;
  const auto result = decode_image(std::as_bytes(std::span(data)), limits);
  const Image* image = std::get_if<Image>(&result);
  REQUIRE(image);
  CHECK(image->reduction == 2);
  CHECK(image->slices == 1);
  CHECK(image->width == 2);
  // The upper row has one row of voxels, the lower one two.
  CHECK(image->pixels == std::vector<std::uint8_t>{145, 165, 85, 105});
}

TEST_CASE("rejects NRRD headers that it does not know") {
  for (const std::string text :
       {"NRRD0001\n\n", "NRRD0001\ntype: block\nsizes: 1 1 1\n\n", "NRRD0001\ntype: uchar\nsizes: 1\n\n",
        "NRRD0001\ntype: uchar\nsizes: 99999 99999 99999\n\n", "NRRD0001\ntype: uchar\nsizes: 1 1 1\nencoding: x\n\n",
        "NRRD0001\ntype: uchar\nsizes: 9 1 1 1\n\n"}) {
    INFO(text);
    CHECK(std::holds_alternative<ImageError>(decode(text)));
  }
}

}  // namespace gs::render::image_volumes_test
