#include "app/session/documents/series.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

namespace gs::app::series_test {

TEST_CASE("plays a series file by file in a loop, and reads ahead") {
  const ScratchFolder folder;
  for (const char* name : {"a.1.vti", "a.2.vti", "a.10.vti"}) folder.write(name, "");
  const std::string name = folder.path("a.%02d.vti");
  SeriesList list;
  CHECK(list.file_of(folder.path("a.1.vti")) == folder.path("a.1.vti"));
  CHECK(list.find(folder.path("a.1.vti")) == nullptr);
  CHECK(list.file_of(name) == folder.path("a.1.vti"));
  REQUIRE(list.find(name));
  CHECK_FALSE(list.arrived(name, 100));  // the series is paused
  CHECK_FALSE(list.holds_back(name, 100));
  CHECK_FALSE(list.next_due());
  list.set_rate(name, 10);
  CHECK(list.play(name, true, 100));
  CHECK_FALSE(list.play(name, true, 100));
  CHECK(list.file_of(name) == folder.path("a.2.vti"));
  CHECK(list.holds_back(name, 100.05));
  CHECK(*list.next_due() == Approx(100.1));
  CHECK_FALSE(list.holds_back(name, 100.11));
  CHECK(list.arrived(name, 100.11));
  CHECK(list.find(name)->shown == 1);
  CHECK(list.file_of(name) == folder.path("a.10.vti"));
  CHECK(list.holds_back(name, 100.15));
  CHECK(*list.next_due() == Approx(100.2));
  CHECK(list.arrived(name, 103));  // late: the next one is not due earlier
  CHECK(list.file_of(name) == folder.path("a.1.vti"));
  CHECK(*list.next_due() == 103);
  CHECK(list.arrived(name, 103));
  CHECK(*list.next_due() == Approx(103.1));
  list.play(name, false, 103);
  CHECK_FALSE(list.next_due());
}

TEST_CASE("shows a chosen file of a series at once, and stops the play") {
  const ScratchFolder folder;
  for (const char* name : {"a.1.vti", "a.2.vti", "a.3.vti"}) folder.write(name, "");
  const std::string name = folder.path("a.%d.vti");
  SeriesList list;
  (void)list.file_of(name);
  CHECK_FALSE(list.show(name, 0, 5));  // already shown
  CHECK(list.play(name, true, 5));
  CHECK(list.show(name, 2, 5.01));
  CHECK_FALSE(list.find(name)->playing);
  CHECK_FALSE(list.holds_back(name, 5.01));
  CHECK_FALSE(list.arrived(name, 5.02));
  CHECK(list.find(name)->shown == 2);
  CHECK_FALSE(list.show(name, 3, 6));
  CHECK_FALSE(list.show("none", 0, 6));
  CHECK(list.file_of(folder.path("none.%d.vti")) == folder.path("none.%d.vti"));
}

TEST_CASE("plays the steps of a file with a changing surface like files") {
  SeriesList list;
  CHECK_FALSE(list.step_of("run.pvd"));
  list.set_steps("run.pvd", {0.5}, 0);
  CHECK_FALSE(list.find("run.pvd"));
  list.set_steps("run.pvd", {0.5, 1, 2}, 1);
  CHECK(list.step_of("run.pvd") == 1);
  CHECK(list.file_of("run.pvd") == "run.pvd");
  CHECK(list.play("run.pvd", true, 10));
  CHECK(list.step_of("run.pvd") == 2);
  // The reading of the next step states the same steps, and changes nothing.
  list.set_steps("run.pvd", {0.5, 1, 2}, 2);
  CHECK(list.arrived("run.pvd", 10.1));
  CHECK(list.step_of("run.pvd") == 0);
  CHECK(list.show("run.pvd", 1, 11));
  CHECK(list.step_of("run.pvd") == 1);
  // The file has other steps now.
  list.set_steps("run.pvd", {0.5, 1, 2, 3}, 1);
  CHECK(list.find("run.pvd")->times.size() == 4);
}

}  // namespace gs::app::series_test
