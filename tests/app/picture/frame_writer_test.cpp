#include "app/picture/frame_writer.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <variant>
#include <vector>

namespace gs::app::frame_writer_test {
namespace {

render::Image plain(std::uint8_t value) { return {16, 8, 3, std::vector<std::uint8_t>(16 * 8 * 3, value)}; }

std::unique_ptr<FrameWriter> open(const std::string& name) {
  auto writer = FrameWriter::open(name, {16, 8}, 25, 0);
  if (auto* problem = std::get_if<std::string>(&writer)) FAIL(*problem);
  return std::move(std::get<std::unique_ptr<FrameWriter>>(writer));
}

}  // namespace

TEST_CASE("writes pictures of an animation with numbers from 0, over pictures only") {
  const ScratchFolder folder;
  auto writer = open(folder.path("a.%02d.png"));
  for (const std::uint8_t value : {0, 100, 200}) CHECK_FALSE(writer->add(plain(value)));
  CHECK_FALSE(writer->finish());
  CHECK(writer->what() == "3 pictures");
  for (const char* name : {"a.00.png", "a.01.png", "a.02.png"}) CHECK(folder.read(name).starts_with("\x89PNG"));
  CHECK(folder.read("a.03.png").empty());
  CHECK_FALSE(open(folder.path("a.%02d.png"))->add(plain(1)));  // may replace a file that is a picture
  folder.write("a.01.png", "a world");
  auto again = open(folder.path("a.%02d.png"));
  CHECK_FALSE(again->add(plain(1)));
  CHECK(again->add(plain(1))->find("is not a PNG picture") != std::string::npos);
  CHECK(folder.read("a.01.png") == "a world");
}

TEST_CASE("writes a movie file at the end, over movies only") {
  const ScratchFolder folder;
  auto writer = open(folder.path("a.mp4"));
  for (int i = 0; i < 5; ++i) CHECK_FALSE(writer->add(plain(static_cast<std::uint8_t>(50 * i))));
  CHECK(folder.read("a.mp4").empty());
  CHECK_FALSE(writer->finish());
  CHECK(folder.read("a.mp4").substr(4, 4) == "ftyp");
  CHECK(writer->what().starts_with("MP4 (H.264) by "));
  CHECK(writer->add({3, 3, 3, std::vector<std::uint8_t>(27)})->find("the same size") != std::string::npos);
  folder.write("w.webm", "a world");
  auto refused = FrameWriter::open(folder.path("w.webm"), {16, 8}, 25, 0);
  REQUIRE(std::holds_alternative<std::string>(refused));
  CHECK(std::get<std::string>(refused).find("is not a movie") != std::string::npos);
}

TEST_CASE("refuses names of no kind of animation, and lists the kinds") {
  for (const char* name : {"a.avi", "a.png", "a.%d.jpg", "a.%d", "%d.png.gz", ""})
    CHECK(check_animation_name(name)->find("walk.%04d.png, or one that ends in .mp4 or .webm") != std::string::npos);
  CHECK_FALSE(check_animation_name("A.MP4"));
  CHECK_FALSE(check_animation_name("x.%d.PNG"));
}

}  // namespace gs::app::frame_writer_test
