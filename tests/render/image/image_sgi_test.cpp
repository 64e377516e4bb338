#include "render/image/image_codecs.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace gs::render;

namespace {

void put(std::string& file, std::uint32_t value, int bytes) {
  while (bytes-- > 0) file += static_cast<char>(value >> (8 * bytes));
}

struct Sgi {
  int storage = 0, sample_bytes = 1, dimension = 3, width = 3, height = 2, channels = 3;
  [[nodiscard]] std::string header() const {
    std::string file;
    put(file, 0x01da, 2);
    put(file, static_cast<std::uint32_t>(storage), 1);
    put(file, static_cast<std::uint32_t>(sample_bytes), 1);
    for (const int number : {dimension, width, height, channels}) put(file, static_cast<std::uint32_t>(number), 2);
    file.resize(512);
    return file;
  }
};

/// Sample of the picture: every one differs.
int sample(const Sgi& sgi, int channel, int y, int x) { return 10 + (channel * sgi.height + y) * sgi.width + x; }

std::string verbatim(const Sgi& sgi) {
  std::string file = sgi.header();
  for (int channel = 0; channel < sgi.channels; ++channel)
    for (int y = 0; y < sgi.height; ++y)
      for (int x = 0; x < sgi.width; ++x) {
        file += static_cast<char>(sample(sgi, channel, y, x));
        if (sgi.sample_bytes == 2) file += '\x55';
      }
  return file;
}

/// Writes each row as a literal run of all but the last sample, and a repeated run for the last one.
std::string packed(const Sgi& sgi) {
  std::string file = sgi.header(), rows;
  std::vector<std::uint32_t> starts, lengths;
  const int count = sgi.channels * sgi.height;
  const auto code = [&](int value, int fraction) {
    if (sgi.sample_bytes == 2) rows += static_cast<char>(value);
    rows += static_cast<char>(sgi.sample_bytes == 2 ? fraction : value);
  };
  for (int channel = 0; channel < sgi.channels; ++channel)
    for (int y = 0; y < sgi.height; ++y) {
      starts.push_back(static_cast<std::uint32_t>(512 + 8 * count) + static_cast<std::uint32_t>(rows.size()));
      const auto op = [&](int value) { sgi.sample_bytes == 2 ? code(0, value) : code(value, 0); };
      op(0x80 | (sgi.width - 1));
      for (int x = 0; x + 1 < sgi.width; ++x) code(sample(sgi, channel, y, x), 0x55);
      op(1);
      code(sample(sgi, channel, y, sgi.width - 1), 0x55);
      op(0);
      lengths.push_back(static_cast<std::uint32_t>(512 + 8 * count) + static_cast<std::uint32_t>(rows.size()) -
                        starts.back());
    }
  for (const auto& table : {starts, lengths})
    for (const std::uint32_t number : table) put(file, number, 4);
  return file + rows;
}

DecodedImage decode(const std::string& file, const ImageLimits& limits = {}) {
  return decode_image(std::as_bytes(std::span(file.data(), file.size())), limits);
}

void check(const Sgi& sgi, const std::string& file) {
  const DecodedImage decoded = decode(file);
  REQUIRE(decoded.index() == 0);
  const Image& image = std::get<Image>(decoded);
  CHECK(image.width == static_cast<std::uint32_t>(sgi.width));
  CHECK(image.height == static_cast<std::uint32_t>(sgi.height));
  const int components = std::min(sgi.channels, 4);
  REQUIRE(image.components == static_cast<std::uint32_t>(components));
  bool same = true;
  for (int y = 0; y < sgi.height; ++y)
    for (int x = 0; x < sgi.width; ++x)
      for (int c = 0; c < components; ++c)
        same &= image.pixels[static_cast<std::size_t>((y * sgi.width + x) * components + c)] ==
                sample(sgi, c, sgi.height - 1 - y, x);
  CHECK(same);
}

}  // namespace

TEST_CASE("reads SGI images of 1 to 5 channels, of 8 and 16 bits, verbatim and run-length encoded") {
  for (int channels = 1; channels <= 5; ++channels)
    for (int bytes = 1; bytes <= 2; ++bytes) {
      INFO(channels << " channels of " << bytes << " bytes");
      check({0, bytes, 3, 3, 2, channels}, verbatim({0, bytes, 3, 3, 2, channels}));
      check({1, bytes, 3, 3, 2, channels}, packed({1, bytes, 3, 3, 2, channels}));
    }
  check({0, 1, 2, 4, 3, 1}, verbatim({0, 1, 2, 4, 3, 1}));
}

TEST_CASE("survives every truncation and every flipped byte of an SGI image") {
  for (const std::string& file : {verbatim({0, 1, 3, 3, 2, 3}), packed({1, 1, 3, 3, 2, 3}), packed({1, 2, 3, 3, 2, 4})})
    for (std::size_t i = 0; i < file.size(); ++i) {
      const DecodedImage cut = decode(file.substr(0, i), {.file_pixels = 100'000});
      if (const auto* error = std::get_if<ImageError>(&cut)) CHECK_FALSE(error->message.empty());
      std::string broken = file;
      broken[i] = static_cast<char>(~broken[i]);
      const DecodedImage decoded = decode(broken, {.file_pixels = 100'000});
      if (const auto* image = std::get_if<Image>(&decoded))
        CHECK(image->pixels.size() == std::size_t{image->width} * image->height * image->components);
    }
}

TEST_CASE("rejects an SGI image that claims more than its bytes can hold") {
  for (const Sgi& huge : {Sgi{0, 1, 3, 65535, 4000, 3}, Sgi{1, 1, 3, 65535, 4000, 3}}) {
    const DecodedImage decoded = decode(huge.header());
    REQUIRE(decoded.index() == 1);
    CHECK(std::get<ImageError>(decoded).message.find("truncated") != std::string::npos);
  }
}
