#include "app/settings/thumbnails.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <filesystem>

namespace gs::app::thumbnails_test {
namespace {

std::vector<std::byte> picture(std::uint8_t grey) {
  return render::encode_png({2, 1, 3, std::vector<std::uint8_t>(6, grey)});
}

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

}  // namespace

TEST_CASE("keeps thumbnails for the next start, readable only by the user") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("thumbnails");
  Thumbnails first(folder);
  CHECK_FALSE(first.find("/a/b.wrl"));
  first.keep("/a/b.wrl", picture(7));
  REQUIRE(first.find("/a/b.wrl"));
  CHECK(first.find("/a/b.wrl")->pixels.front() == 7);
  CHECK_FALSE(first.find("http://host/c.qnv"));
  CHECK((std::filesystem::status(folder).permissions() & std::filesystem::perms::others_all) ==
        std::filesystem::perms::none);

  Thumbnails second(folder);
  REQUIRE(second.find("/a/b.wrl"));
  second.keep("/a/b.wrl", picture(9));
  CHECK(second.find("/a/b.wrl")->pixels.front() == 9);
  CHECK(files_in(folder) == 1);
}

TEST_CASE("removes thumbnails of forgotten files, and nothing else in their folder") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("thumbnails");
  Thumbnails thumbnails(folder);
  thumbnails.keep("/a.wrl", picture(1));
  thumbnails.keep("/b.wrl", picture(2));
  (void)scratch.write("thumbnails/notes.txt", "mine");
  thumbnails.keep_only({"/b.wrl"});
  Thumbnails again(folder);
  CHECK_FALSE(again.find("/a.wrl"));
  CHECK(again.find("/b.wrl"));
  CHECK(files_in(folder) == 2);
}

TEST_CASE("ignores damaged and huge thumbnails, and stores none without a folder") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("thumbnails");
  Thumbnails thumbnails(folder);
  thumbnails.keep("/a.wrl", {std::byte{1}, std::byte{2}});
  CHECK_FALSE(thumbnails.find("/a.wrl"));
  const render::Image large{1000, 1000, 1, std::vector<std::uint8_t>(1'000'000, 3)};
  thumbnails.keep("/b.wrl", render::encode_png(large));
  const auto found = thumbnails.find("/b.wrl");
  CHECK((!found || found->pixels.size() <= std::size_t{4} * Thumbnails::kWidth * Thumbnails::kHeight));
  Thumbnails none("");
  none.keep("/a.wrl", picture(1));
  CHECK_FALSE(none.find("/a.wrl"));
  none.keep_only({});
}

}  // namespace gs::app::thumbnails_test
