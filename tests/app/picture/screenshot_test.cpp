#include "app/picture/screenshot.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

namespace gs::app::screenshot_test {
namespace {

std::string folder_of(const std::string& own, const std::string& directories) {
  return pictures_folder(
      [&](const char* name) {
        return std::string(name) == "XDG_PICTURES_DIR" ? own : std::string(name) == "HOME" ? "/home/u" : "";
      },
      directories);
}

}  // namespace

TEST_CASE("saves pictures in the folder of the desktop's user (xdg-user-dirs)") {
  CHECK(folder_of("/p", "XDG_PICTURES_DIR=\"$HOME/Bilder\"\n") == "/p");
  CHECK(folder_of("relative", "") == "/home/u/Pictures");
  const std::pair<const char*, const char*> folders[] = {
      {"", "/home/u/Pictures"},
      {"# x\nXDG_MUSIC_DIR=\"$HOME/m\"\nXDG_PICTURES_DIR=\"$HOME/Bilder\"\n", "/home/u/Bilder"},
      {"XDG_PICTURES_DIR=\"/data/p\"", "/data/p"},
      {"XDG_PICTURES_DIR=\"relative\"", "/home/u/Pictures"},
      {"XDG_PICTURES_DIR=\"", "/home/u/Pictures"},
  };
  for (const auto& [directories, folder] : folders) CHECK(folder_of("", directories) == folder);
  CHECK(pictures_folder([](const char*) { return std::string(); }, "").empty());
}

TEST_CASE("removes slashes and controls from a title, and shortens it to a file name") {
  const std::string name = picture_name("../a/b:c\n?", 0);
  CHECK(name.find('/') == std::string::npos);
  CHECK(name.find('\n') == std::string::npos);
  CHECK(name.starts_with("_a_b_c__ 1970-01-01 ") + name.starts_with("_a_b_c__ 1969-12-31 ") == 1);
  CHECK(name.ends_with(".png"));
  CHECK(picture_name("", 0).starts_with("GhostSpace 19"));
  CHECK(picture_name("...", 0).starts_with("GhostSpace 19"));
  std::string wide;
  for (int i = 0; i < 100; ++i) wide += "\xc3\xa4";
  CHECK(picture_name(wide, 0).starts_with(wide.substr(0, 80) + " 19"));  // no character is split
}

TEST_CASE("chooses a new name for each picture") {
  const ScratchFolder folder;
  CHECK(free_path(folder.path("."), "a.png").ends_with("/a.png"));
  folder.write("a.png", "x");
  CHECK(free_path(folder.path("."), "a.png").ends_with("/a (2).png"));
  folder.write("a (2).png", "x");
  CHECK(free_path(folder.path("."), "a.png").ends_with("/a (3).png"));
}

}  // namespace gs::app::screenshot_test
