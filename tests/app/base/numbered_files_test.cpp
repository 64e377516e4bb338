#include "app/base/numbered_files.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::numbered_files_test {

TEST_CASE("fills the number of each file into a name pattern") {
  const auto name = numbered_name("a/walk.%04d.png");
  REQUIRE(name);
  CHECK(name->at(0) == "a/walk.0000.png");
  CHECK(name->at(12345) == "a/walk.12345.png");
  CHECK(numbered_name("%d.png")->at(7) == "7.png");
  CHECK(numbered_name("100%% %03d")->at(1) == "100% 001");
  for (const char* wrong :
       {"", "a.png", "%", "%x", "%s.png", "%04d%04d", "%*d", "%-4d", "%9999999999999d", "%99d", "a%dx/b.png", "%n"})
    CHECK_FALSE(numbered_name(wrong));
}

TEST_CASE("sorts the files of a series by their numbers") {
  const ScratchFolder folder;
  for (const char* name :
       {"run.10.vti", "run.9.vti", "run.0100.vti", "run.x.vti", "run..vti", "run.1.vtk", "other.1.vti", "run.-1.vti"})
    folder.write(name, "");
  const auto files = file_series(folder.path("run.%04d.vti"));
  REQUIRE(files);
  CHECK(*files ==
        std::vector<std::string>{folder.path("run.9.vti"), folder.path("run.10.vti"), folder.path("run.0100.vti")});
  CHECK(file_series(folder.path("none.%d.vti"))->empty());
  CHECK_FALSE(file_series(folder.path("run.9.vti")));
  folder.write("50%d.vti", "");
  CHECK_FALSE(file_series(folder.path("50%d.vti")));  // a file with exactly this name
  CHECK_FALSE(file_series("http://host/run.%d.vti"));
}

TEST_CASE("shows the file of a series that began last, and keeps the final one") {
  CHECK(series_place(0, 10, 5) == 0);
  CHECK(series_place(0.1, 10, 5) == 1);
  CHECK(series_place(0.3, 10, 5) == 3);  // 0.3 * 10 is below 3 after rounding
  CHECK(series_place(0.39, 10, 5) == 3);
  CHECK(series_place(100, 10, 5) == 4);
  CHECK(series_place(-1, 10, 5) == 0);
}

}  // namespace gs::app::numbered_files_test
