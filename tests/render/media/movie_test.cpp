// Movies of 48 x 32 pixels and six frames: three red and blue ones, three green ones.
#include "render/media/movie.h"

#include "render/media/sample_reader.h"
#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gs::render {
namespace {

using Bytes = std::vector<std::byte>;

const std::vector<std::string> kMovies = {
    "mpeg_system_stream/red_blue.mpg", "mpeg_video/red_blue.m1v", "avi/red_blue.avi",
    "matroska/red_blue.webm",          "ogg/red_blue.ogv",        "iso_media/red_blue.mp4"};

Bytes movie(const std::string& name) {
  std::ifstream file(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/" + name, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  REQUIRE(text.size() > 100);
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

/// Reports whether colours agree within the loss of these codecs.
bool is_near(const Image& image, std::uint32_t x, std::uint32_t y, int red, int green, int blue) {
  const std::uint8_t* pixel = image.pixels.data() + (std::size_t{y} * image.width + x) * image.components;
  const auto near = [](int a, int b) { return std::abs(a - b) <= 40; };
  return near(pixel[0], red) && near(pixel[1], green) && near(pixel[2], blue);
}

void check_first(const Image& image) {
  REQUIRE(image.width == 48);
  REQUIRE(image.height == 32);
  REQUIRE(image.components == 3);
  REQUIRE(image.pixels.size() == std::size_t{48} * 32 * 3);
  CHECK(is_near(image, 6, 6, 255, 0, 0));
  CHECK(is_near(image, 6, 28, 255, 0, 0));
  CHECK(is_near(image, 42, 16, 0, 0, 255));
}

TEST_CASE("decodes the first picture of a movie as an image (VRML97 6.28)") {
  for (const std::string& name : kMovies) {
    INFO(name);
    const Bytes bytes = movie(name);
    const auto decoded = decode_image(bytes);
    if (const auto* error = std::get_if<ImageError>(&decoded)) FAIL(error->message);
    check_first(std::get<Image>(decoded));
  }
}

TEST_CASE("returns the pictures of a movie in sequence, with their times") {
  for (const std::string& name : kMovies) {
    INFO(name);
    const Bytes bytes = movie(name);
    auto opened = Movie::open(bytes);
    REQUIRE(opened.index() == 0);
    Movie& one = *std::get<0>(opened);
    std::size_t count = 0;
    double before = -1;
    bool green = false;
    for (;; ++count) {
      auto next = one.next();
      REQUIRE(next.index() == 0);
      const auto& frame = std::get<0>(next);
      if (!frame) break;
      if (count == 0) check_first(frame->image);
      if (count == 0) CHECK(frame->time == Approx(0).margin(0.05));
      green = is_near(frame->image, 24, 16, 0, 255, 0);
      // Fewer frames than time steps are possible, since some codecs omit repeated ones.
      CHECK(frame->time >= before);
      CHECK(frame->time < 0.3);
      before = frame->time;
    }
    CHECK(count >= 2);
    CHECK(count <= 6);
    CHECK(green);
    auto after = one.next();
    REQUIRE(after.index() == 0);
    CHECK_FALSE(std::get<0>(after));
    const auto info = examine_media(bytes);
    REQUIRE(info.index() == 0);
    CHECK(std::get<0>(info).pictures);
    // Ogg omits repeated frames at the end.
    CHECK(std::get<0>(info).duration == Approx(6 / 25.0).margin(name.find(".ogv") != std::string::npos ? 0.09 : 0.05));
  }
}

// Frames of 64 x 32 pixels, each 1/25 s after the one before, with a grey of 20 + 4 i.
int number_of(const Movie::Frame& frame) {
  const Image& image = frame.image;
  const double grey =
      image.pixels[(std::size_t{image.width} * (image.height / 2) + image.width / 2) * image.components];
  // Converts from the range of films, 16 to 235.
  return static_cast<int>(std::lround((grey / 255 * 219 + 16 - 20) / 4));
}

TEST_CASE("returns the picture of a movie at any time, forwards, backwards and after a jump") {
  for (const std::string name : {"movie/counting.m1v", "movie/counting.mp4", "sound/tone.mpg"}) {
    INFO(name);
    const Bytes bytes = movie(name);
    auto opened = Movie::open(bytes);
    REQUIRE(opened.index() == 0);
    Movie& one = *std::get<0>(opened);
    const auto number_at = [&](double time) {
      const auto found = one.at(time);
      REQUIRE(found.index() == 0);
      REQUIRE(std::get<0>(found));
      return number_of(*std::get<0>(found));
    };
    for (int i = 0; i < 50; ++i) {
      INFO(i);
      CHECK(number_at((i + 0.5) / 25) == i);
    }
    for (int i = 49; i >= 0; --i) {
      INFO(i);
      CHECK(number_at((i + 0.5) / 25) == i);
    }
    for (const int i : {40, 3, 49, 20, 21, 48, 0, 30}) {
      INFO(i);
      CHECK(number_at((i + 0.5) / 25) == i);
    }
    CHECK(number_at(1000) == 49);
    CHECK(number_at(-1) == 0);
  }
}

TEST_CASE("reads an animated GIF as a movie") {
  const Bytes bytes = movie("movie/counting.gif");
  const auto info = examine_media(bytes);
  REQUIRE(info.index() == 0);
  CHECK(std::get<0>(info).duration == Approx(0.8).margin(0.101));
  auto opened = Movie::open(bytes);
  REQUIRE(opened.index() == 0);
  int before = -1;
  for (int i = 0; i < 8; ++i) {
    const auto found = std::get<0>(opened)->at((i + 0.5) / 10);
    REQUIRE(found.index() == 0);
    REQUIRE(std::get<0>(found));
    const Image& image = std::get<0>(found)->image;
    CHECK(image.width == 16);
    CHECK(int{image.pixels[0]} > before);
    before = image.pixels[0];
  }
}

TEST_CASE("decodes the intact part of truncated or damaged movies, or reports an error") {
  for (const std::string& name : kMovies) {
    INFO(name);
    const Bytes bytes = movie(name);
    const auto check = [](const Bytes& some) {
      const auto decoded = decode_image(some, {.file_pixels = std::size_t{1} << 20});
      if (const auto* image = std::get_if<Image>(&decoded))
        CHECK(image->pixels.size() == std::size_t{image->width} * image->height * image->components);
      else
        CHECK(std::get<ImageError>(decoded).message.size() > 10);
    };
    media::each_damaged(bytes, 60, check);
  }
}

TEST_CASE("limits the memory of a movie") {
  const Bytes bytes = movie("mpeg_system_stream/red_blue.mpg");
  const auto refused = decode_image(bytes, {.file_pixels = 48 * 32 - 1});
  REQUIRE(refused.index() == 1);
  CHECK(std::get<ImageError>(refused).message.find("48x32") != std::string::npos);
  const auto reduced = decode_image(bytes, {.kept_pixels = 48 * 32 / 4});
  REQUIRE(reduced.index() == 0);
  CHECK(std::get<Image>(reduced).width == 24);
  CHECK(std::get<Image>(reduced).height == 16);
  CHECK(std::get<Image>(reduced).reduction == 2);
  CHECK(is_near(std::get<Image>(reduced), 3, 8, 255, 0, 0));
  const auto stopped = decode_image(bytes, {.stopped = [] { return true; }});
  REQUIRE(stopped.index() == 1);
  CHECK(std::get<ImageError>(stopped).message.size() > 10);
}

TEST_CASE("rejects movies that refer to other files, and opens none of these") {
  for (const std::string text : {"#EXTM3U\n#EXT-X-MEDIA-SEQUENCE:0\n#EXTINF:1,\nfile:///etc/passwd\n",
                                 "ffconcat version 1.0\nfile /etc/passwd\n", "RIFF\x10\x00\x00\x00WAVEfmt ", "OggS"}) {
    Bytes bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    CHECK(decode_image(bytes).index() == 1);
  }
}

}  // namespace
}  // namespace gs::render
