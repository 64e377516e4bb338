#include "app/interface/panels/data_panel.h"

#include "app/formats/common/dataset_list.h"
#include "tests/app/interface/driver.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::data_panel_test {
namespace {

using driver::Driver;

constexpr const char* kTriangle =
    "# vtk DataFile Version 3.0\ntriangle\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n"
    "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS heat float\nLOOKUP_TABLE default\n1 2 3\n"
    "VECTORS wind float\n3 4 0 0 0 1 0 0 0\n";

/// User with a window that shows a surface with two arrays, and the panel.
struct DataUser {
  explicit DataUser(const std::string& path) : user({}, {1100, 760}) {
    user.session().opening().open_files({path});
    REQUIRE(user.wait_for([this] { return !title().empty(); }));
    user.press(letter_key('D'), true, true);
    user.settle();
  }
  [[nodiscard]] std::string title() {
    const View* const view = user.session().view();
    return view && view->document->world.color_key ? view->document->world.color_key->title : std::string();
  }
  [[nodiscard]] const ColorKey& key() { return *user.session().view()->document->world.color_key; }

  Driver user;
};

}  // namespace

TEST_CASE("the Data panel lists arrays and shows the clicked one with its components and colours") {
  const ScratchFolder folder;
  DataUser it(folder.write("a.vtk", kTriangle));
  INFO(it.user.screen());
  CHECK(it.user.sees("Dataset"));
  CHECK(it.user.sees("PointData"));
  it.user.click("wind");
  REQUIRE(it.user.wait_for([&] { return it.title() == "wind (length)"; }));
  it.user.settle();
  CHECK(it.user.sees("Component"));
  it.user.click("Default");
  it.user.click("Magnitude");
  REQUIRE(it.user.wait_for([&] { return it.user.session().view()->document->data.magnitude; }));
  it.user.settle();
  it.user.click("Viridis");
  it.user.click("Turbo");
  REQUIRE(it.user.wait_for([&] { return it.key().colors.size() == 17; }));
  it.user.settle();
  it.user.click("2 - 98 %");
  REQUIRE(it.user.wait_for(
      [&] { return it.user.session().view()->document->data.colors.range == SurfaceColors::Range::contrast; }));
}

TEST_CASE("the Data panel adds data beside and over the picture") {
  const ScratchFolder folder;
  DataUser it(folder.write("a.vtk", kTriangle));
  it.user.click("Over");
  it.user.click("/PointData/wind");
  REQUIRE(it.user.wait_for([&] {
    const auto& over = it.user.session().view()->over;
    return over.size() == 1 && over[0].view;
  }));
  it.user.settle();
  CHECK(it.user.sees("Over it"));
  it.user.click("Remove");
  CHECK(it.user.session().view()->over.empty());
  it.user.click("Beside");
  it.user.click("/PointData/wind");
  REQUIRE(it.user.wait_for([&] { return it.title() == "wind (length)"; }));
  CHECK(it.user.session().panes().visible().size() == 2);
  CHECK(it.user.session().viewports().linked());
}

TEST_CASE("the Data panel follows a file on request") {
  const ScratchFolder folder;
  const std::string path = folder.write("a.vtk", kTriangle);
  DataUser it(path);
  CHECK_FALSE(it.user.session().follower().follows(path));
  it.user.session().follower().follow(path, true);
  it.user.settle();
  CHECK(it.user.session().follower().follows(path));
  CHECK(it.user.sees("Follow"));
}

}  // namespace gs::app::data_panel_test
