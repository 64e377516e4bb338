#include "render/media/movie_writer.h"

#include "render/media/movie.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <variant>
#include <vector>

namespace gs::render::movie_writer_test {
namespace {

/// Returns frame `i` of 40 x 30: one colour on the left, another on the right.
Image shaded(int i, std::uint32_t components) {
  Image image{40, 30, components, {}};
  for (std::uint32_t y = 0; y < 30; ++y)
    for (std::uint32_t x = 0; x < 40; ++x) {
      const bool left = x < 20;
      image.pixels.push_back(static_cast<std::uint8_t>(left ? 40 * i : 200));
      image.pixels.push_back(left ? 60 : 40);
      image.pixels.push_back(left ? 180 : 30);
      if (components == 4) image.pixels.push_back(255);
    }
  return image;
}

}  // namespace

TEST_CASE("restores pictures, colours and times of the movies that it writes") {
  for (const MovieFormat& format : movie_formats()) {
    INFO(format.name);
    auto opened = MovieWriter::open(format, 40, 30, 10);
    if (auto* problem = std::get_if<ImageError>(&opened)) FAIL(problem->message);
    MovieWriter& writer = *std::get<std::unique_ptr<MovieWriter>>(opened);
    for (int i = 0; i < 6; ++i) CHECK_FALSE(writer.add(shaded(i, 3)));
    auto made = writer.finish();
    REQUIRE(std::holds_alternative<std::vector<std::byte>>(made));
    const auto& bytes = std::get<std::vector<std::byte>>(made);
    auto movie = Movie::open(bytes);
    REQUIRE(std::holds_alternative<std::unique_ptr<Movie>>(movie));
    for (int i = 0; i < 6; ++i) {
      auto next = std::get<std::unique_ptr<Movie>>(movie)->next();
      REQUIRE(std::holds_alternative<std::optional<Movie::Frame>>(next));
      const auto& frame = std::get<std::optional<Movie::Frame>>(next);
      REQUIRE(frame);
      CHECK(frame->time == Approx(i * 0.1).margin(0.002));
      REQUIRE(frame->image.components == 3);
      CHECK(frame->image.width == 40);
      const auto at = [&](std::uint32_t x) { return frame->image.pixels.data() + (15 * 40 + x) * 3; };
      CHECK(std::abs(at(8)[0] - 40 * i) <= 12);
      CHECK(std::abs(at(8)[2] - 180) <= 12);
      CHECK(std::abs(at(32)[0] - 200) <= 12);
    }
    auto end = std::get<std::unique_ptr<Movie>>(movie)->next();
    REQUIRE(std::holds_alternative<std::optional<Movie::Frame>>(end));
    CHECK_FALSE(std::get<std::optional<Movie::Frame>>(end));
  }
}

TEST_CASE("drops odd edges, and refuses invalid sizes and rates") {
  const MovieFormat* format = movie_format_of("x/Y.Mp4");
  REQUIRE(format);
  CHECK(movie_format_of("a.avi") == nullptr);
  CHECK(std::holds_alternative<ImageError>(MovieWriter::open(*format, 1, 30, 10)));
  CHECK(std::holds_alternative<ImageError>(MovieWriter::open(*format, 40, 30, 0)));
  auto odd = MovieWriter::open(*format, 41, 31, 25);
  REQUIRE(std::holds_alternative<std::unique_ptr<MovieWriter>>(odd));
  MovieWriter& writer = *std::get<std::unique_ptr<MovieWriter>>(odd);
  CHECK(writer.add(shaded(0, 3)));  // 40 x 30
  CHECK_FALSE(writer.add({41, 31, 4, std::vector<std::uint8_t>(41 * 31 * 4, 90)}));
  auto made = writer.finish();
  REQUIRE(std::holds_alternative<std::vector<std::byte>>(made));
  auto movie = Movie::open(std::get<std::vector<std::byte>>(made));
  auto first = std::get<std::unique_ptr<Movie>>(movie)->next();
  const auto& frame = std::get<std::optional<Movie::Frame>>(first);
  REQUIRE(frame);
  CHECK(frame->image.width == 40);
  CHECK(frame->image.height == 30);
}

}  // namespace gs::render::movie_writer_test
