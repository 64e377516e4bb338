// Tests of the data that viewports show: choices, data beside and over others, and files that grow.
#include "app/session/opening/data_choices.h"

#include "app/formats/common/dataset_list.h"
#include "app/session/session.h"
#include "tests/app/formats/datasets/dataset_helpers.h"
#include "tests/app/one_world.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::data_choices_test {
namespace {

using sessions::input_of;

/// Returns a triangle of `size` with two arrays at its points and one on its face.
std::string triangle_file(double size = 1) {
  const std::string s = std::to_string(size);
  return "# vtk DataFile Version 3.0\ntriangle\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 " + s + " 0 0 0 " + s +
         " 0\nPOLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS heat float\nLOOKUP_TABLE default\n1 2 3\n"
         "VECTORS wind float\n3 4 0 0 0 1 0 0 0\nCELL_DATA 1\nSCALARS load float\nLOOKUP_TABLE default\n7\n";
}

/// Session that shows local files.
struct DataSession {
  explicit DataSession(std::vector<std::string> files, bool follow = false)
      : session(options_of(files), load_of(follow), [] {}) {
    REQUIRE(wait_for([this] { return session.view() != nullptr; }));
  }
  static SessionOptions options_of(const std::vector<std::string>& files) {
    SessionOptions options;
    options.files = files;
    return options;
  }
  static LoadOptions load_of(bool follow) {
    LoadOptions load;
    load.follow = follow;
    return load;
  }
  void step() { (void)session.step(world_time(), input_of({})); }
  bool wait_for(const std::function<bool()>& so, double seconds = 30) {
    for (int i = 0; i < static_cast<int>(seconds * 200); ++i) {
      step();
      if (so()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  [[nodiscard]] std::string shown() { return session.view()->document->data.found->shown; }
  [[nodiscard]] std::string title() {
    const auto& key = session.view()->document->world.color_key;
    return key ? key->title : std::string();
  }

  Session session;
};

}  // namespace

TEST_CASE("lists the arrays of a surface and shows another one in place, with the same camera") {
  const ScratchFolder folder;
  DataSession window({folder.write("a.vtk", triangle_file())});
  const DatasetList& list = *window.session.view()->document->data.found;
  REQUIRE(list.entries.size() == 3);
  CHECK(list.entries[0].path == "/PointData/heat");
  CHECK(list.entries[1].path == "/PointData/wind");
  CHECK(list.entries[2].path == "/CellData/load");
  CHECK(window.shown() == "/PointData/heat");
  Pose pose = window.session.view()->navigation.pose;
  pose.position += glm::dvec3(0.1, 0.2, 0);
  window.session.view()->navigation.pose = pose;
  VoxelComponent choice;
  choice.dataset = "/PointData/wind";
  window.session.data().choose(choice);
  CHECK(window.title() == "heat");  // until the other array is read
  REQUIRE(window.wait_for([&] { return window.title() == "wind (length)"; }));
  CHECK(window.session.view()->navigation.pose.position == pose.position);
  CHECK(window.session.view()->document->data.found->components == 3);
  CHECK(window.session.view()->document->world.color_key->high == Approx(5));
  choice.index = 1;
  choice.chosen = true;
  window.session.data().choose(choice);
  REQUIRE(window.wait_for([&] { return window.title() == "wind (component 1)"; }));
  CHECK(window.session.view()->document->world.color_key->high == Approx(4));
  choice = {};
  choice.dataset = "load";
  window.session.data().choose(choice);
  REQUIRE(window.wait_for([&] { return window.title() == "load"; }));
}

TEST_CASE("keeps the picture and reports a dataset that is not in the file") {
  const ScratchFolder folder;
  DataSession window({folder.write("a.vtk", triangle_file())});
  VoxelComponent choice;
  choice.dataset = "/PointData/heet";
  window.session.data().choose(choice);
  const Pane& pane = window.session.panes().at(0);
  REQUIRE(window.wait_for([&] { return pane.failure.has_value(); }));
  CHECK(pane.failure->error.find("the nearest ones are /PointData/heat") != std::string::npos);
  CHECK(window.title() == "heat");
}

TEST_CASE("shows data beside others with linked cameras") {
  const ScratchFolder folder;
  const std::string path = folder.write("a.vtk", triangle_file());
  DataSession window({path});
  VoxelComponent choice;
  choice.dataset = "/CellData/load";
  window.session.data().show_beside(choice);
  Panes& panes = window.session.panes();
  REQUIRE(panes.visible().size() == 2);
  CHECK(window.session.viewports().linked());
  REQUIRE(window.wait_for([&] { return window.session.view() && window.title() == "load"; }));
  CHECK(panes.at(panes.active()).shown == path + "#view=2");
  CHECK(file_label(panes.at(panes.active()).shown) == "a.vtk (2)");
  CHECK(file_of_view(panes.at(panes.active()).shown) == path);
  CHECK(panes.at(0).view()->document->world.color_key->title == "heat");
}

TEST_CASE("draws data over others, and removes them") {
  const ScratchFolder folder;
  DataSession window({folder.write("a.vtk", triangle_file()), folder.write("b.vtk", triangle_file(2))});
  Panes& panes = window.session.panes();
  REQUIRE(window.wait_for([&] { return panes.at(0).view() && panes.at(1).view(); }));
  VoxelComponent choice;
  choice.dataset = "/CellData/load";
  window.session.data().show_over(choice);
  window.session.data().show_file_over(1);
  const auto& over = panes.at(0).view()->over;
  REQUIRE(over.size() == 2);
  REQUIRE(window.wait_for([&] { return over[0].view && over[1].view; }));
  CHECK(over[0].view->document->world.color_key->title == "load");
  CHECK(over[1].view->document->world.color_key->title == "heat");
  CHECK(panes.views_in_sight().size() == 4);
  window.session.data().remove_over(0);
  CHECK(panes.at(0).view()->over.size() == 1);
  window.step();
}

TEST_CASE("follows a file that a program writes again, and keeps the camera") {
  const ScratchFolder folder;
  const std::string path = folder.write("a.vtk", triangle_file());
  DataSession window({path}, true);
  CHECK(window.session.follower().follows(path));
  const Pose pose = window.session.view()->navigation.pose;
  (void)window.wait_for([] { return false; }, 0.3);  // the first version is known
  for (const double size : {1.2, 1.4}) {
    // A file that is being written is incomplete.
    (void)folder.write("a.vtk", triangle_file(size).substr(0, 30));
    (void)window.wait_for([] { return false; }, 0.4);
    REQUIRE(window.session.view());
    (void)folder.write("a.vtk", triangle_file(size));
    const auto arrived = [&] {
      return window.session.view()->list->bounds.upper.x == Approx(size) && !window.session.view()->list->items.empty();
    };
    REQUIRE(window.wait_for(arrived, 40));
    CHECK_FALSE(window.session.panes().at(0).failure);
    CHECK(window.session.view()->navigation.pose.position == pose.position);
  }
  window.session.follower().follow(path, false);
  CHECK_FALSE(window.session.follower().follows(path));
}

TEST_CASE("follows a series and shows its newest file, unless the user chose another one") {
  const ScratchFolder folder;
  const auto write = [&](int number) {
    return folder.write("run." + std::to_string(number) + ".vtk", triangle_file(1 + 0.1 * number));
  };
  for (const int number : {0, 1}) (void)write(number);
  const std::string name = folder.path("run.%d.vtk");
  DataSession window({name}, true);
  (void)window.wait_for([] { return false; }, 0.3);
  (void)write(2);
  const auto size = [&] { return window.session.view()->list->bounds.upper.x; };
  REQUIRE(window.wait_for([&] { return size() == Approx(1.2); }, 40));
  CHECK(window.session.series().current()->files.size() == 3);
  CHECK(window.session.series().current()->shown == 2);
  window.session.series().show(0);
  window.session.follower().follow_newest(name, false);
  REQUIRE(window.wait_for([&] { return size() == Approx(1.0); }, 40));
  (void)write(3);
  REQUIRE(window.wait_for([&] { return window.session.series().current()->files.size() == 4; }, 40));
  CHECK(size() == Approx(1.0));
}

TEST_CASE("follows a series in JSON and shows its newest step, with a time for each") {
  const ScratchFolder folder;
  std::string names;
  const auto add = [&](int number) {
    const std::string name = "s" + std::to_string(number) + ".stl", size = std::to_string(1 + 0.1 * number);
    (void)folder.write(name, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex " + size +
                                 " 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n");
    names += (number > 0 ? "," : "") + std::string(R"({"name": ")") + name + R"(", "time": )" +
             std::to_string(number * 0.5) + "}";
    return folder.write("run.series", R"({"file-series-version": "1.0", "files": [)" + names + "]}");
  };
  const std::string path = add(0);
  (void)add(1);
  DataSession window({path}, true);
  const auto size = [&] { return window.session.view()->list->bounds.upper.x; };
  REQUIRE(window.wait_for([&] { return size() == Approx(1.1); }, 40));
  (void)window.wait_for([] { return false; }, 0.3);
  (void)add(2);
  REQUIRE(window.wait_for([&] { return size() == Approx(1.2); }, 40));
  REQUIRE(window.session.series().current());
  CHECK(window.session.series().current()->times == std::vector<double>{0, 0.5, 1});
  CHECK(window.session.series().current()->shown == 2);
  window.session.follower().follow_newest(path, false);
  window.session.series().show(0);
  CHECK(window.wait_for([&] { return size() == Approx(1.0); }, 40));
}

TEST_CASE("tells versions of files, folders and series apart") {
  const ScratchFolder folder;
  const std::atomic<bool> stop{false};
  const LoadOptions load;
  const auto version = [&](const std::string& path) { return version_of(folder.path(path), load, stop); };
  (void)folder.write("zarr/0.0.0", "a");
  const std::string one = version("zarr");
  CHECK(version("zarr") == one);
  (void)folder.write("zarr/0.0.1", "b");
  CHECK(version("zarr") != one);
  (void)folder.write("s.0.vtk", "a");
  const std::string series = version("s.%d.vtk");
  (void)folder.write("s.1.vtk", "a");
  CHECK(version("s.%d.vtk") != series);
  (void)folder.write("f", "a");
  const std::string file = version("f");
  (void)folder.write("f", "ab");
  CHECK(version("f") != file);
}

TEST_CASE("follows HDF5 that a program appends to with SWMR") {
  const ScratchFolder folder;
  const std::string script =
      "import sys, time, os\n"
      "f = h5py.File('run.h5', 'w', libver='latest')\n"
      "d = f.create_dataset('blob', shape=(1, 6, 6, 6), maxshape=(None, 6, 6, 6), chunks=(1, 6, 6, 6), dtype='f4')\n"
      "d[0] = np.arange(216).reshape(6, 6, 6)\n"
      "f.swmr_mode = True\n"
      "d.flush()\n"
      "if os.fork() == 0:\n"
      "    end = time.time() + 60\n"
      "    while not os.path.exists('go') and time.time() < end: time.sleep(0.05)\n"
      "    for k in range(1, 6):\n"
      "        d.resize(k + 1, axis=0)\n"
      "        d[k] = np.arange(216).reshape(6, 6, 6) * (k + 1)\n"
      "        d.flush()\n"
      "        time.sleep(0.2)\n"
      "    while os.path.exists('run.h5') and not os.path.exists('stop') and time.time() < end: time.sleep(0.05)\n"
      "    os._exit(0)\n"
      "os._exit(0)\n";
  if (!gs::test::run_python(folder, script)) return;
  DataSession window({folder.path("run.h5")}, true);
  (void)window.wait_for([] { return false; }, 0.5);
  (void)folder.write("go", "");
  const auto steps = [&] { return window.session.view()->document->data.found->times.size(); };
  CHECK(window.wait_for([&] { return steps() == 6; }, 60));
  (void)folder.write("stop", "");
  CHECK(steps() == 6);
  CHECK(window.session.view()->document->has_volumes);
}

}  // namespace gs::app::data_choices_test
