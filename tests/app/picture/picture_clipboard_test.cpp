#include "app/picture/picture_clipboard.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <span>
#include <string>
#include <vector>

namespace gs::app::picture_clipboard_test {

TEST_CASE("gives a picture to the first clipboard program that takes it") {
  const ScratchFolder folder;
  const std::string picture = "a picture";
  const std::string target = folder.path("copy");
  const std::vector<ClipboardProgram> programs = {{"/bin/sh", {"-c", "exit 0"}, "GHOSTSPACE_NO_SUCH_DESKTOP"},
                                                  {"/nowhere/at/all", {}, "PATH"},
                                                  {"/bin/sh", {"-c", "exit 1"}, "PATH"},
                                                  {"/bin/sh", {"-c", "cat > '" + target + "'"}, "PATH"}};
  CHECK_FALSE(copy_png(std::as_bytes(std::span(picture)), programs));
  CHECK(folder.read("copy") == picture);
}

TEST_CASE("reports which programs would help if none is installed") {
  const std::vector<ClipboardProgram> programs = {{"/nowhere/at/all", {}, "PATH"}};
  const auto problem = copy_png({}, programs);
  REQUIRE(problem);
  CHECK(problem->find("xclip") != std::string::npos);
}

}  // namespace gs::app::picture_clipboard_test
