#include "app/loading/content/series_step.h"

#include "app/loading/world_loader.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <vector>

namespace gs::app::series_step_test {
namespace {

const std::string kRun =
    R"({"file-series-version": "1.0", "files": [
      {"name": "s2.wrl", "time": 2.5}, {"name": "s0.wrl", "time": 0.5}, {"name": "s1.wrl", "time": 1.5}]})";

std::string shapes(std::size_t count) {
  std::string text = "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; i < count; ++i) text += "Shape { geometry Box { } }\n";
  return text;
}

std::optional<SeriesStep> step_in(const std::string& text, std::optional<qnv::ShownStep> wanted = std::nullopt) {
  return step_of_series(test::bytes_of(text), wanted);
}

TEST_CASE("chooses the step of a series by number and by time") {
  REQUIRE(step_in(kRun));
  CHECK(step_in(kRun)->file == "s0.wrl");
  CHECK(step_in(kRun)->steps == TimeSteps{{0.5, 1.5, 2.5}, 0});
  CHECK(step_in(kRun, qnv::ShownStep{1, {}})->file == "s1.wrl");
  CHECK(step_in(kRun, qnv::ShownStep{9, {}})->file == "s2.wrl");
  CHECK(step_in(kRun, qnv::ShownStep{0, 1.4})->file == "s1.wrl");
  CHECK(step_in(kRun, qnv::ShownStep{0, kNewestStep})->steps.shown == 2);
}

TEST_CASE("leaves series of files of VTK, and other texts, to their readers") {
  const auto one = [](const std::string& name) {
    return R"({"file-series-version": "1.0", "files": [{"name": ")" + name + R"(", "time": 0}]})";
  };
  CHECK(step_in(one("a.qnv")));
  CHECK(step_in(one("steps/a.NRRD")));
  for (const char* const name : {"a.vtk", "a.vti", "a.PVTU", "a.vtkhdf", "a.pvd", "a", "a.unknown"})
    CHECK_FALSE(step_in(one(name)));
  for (const char* const text : {"", "{", "{\"file-series-version\": 1}", "{\"files\": [{\"name\": \"a.qnv\"}]}",
                                 "{\"file-series-version\": \"1.0\", \"files\": []}", "#VRML V2.0 utf8\n"})
    CHECK_FALSE(step_in(text));
}

TEST_CASE("keeps the newest steps of a series that has too many") {
  std::string text = R"({"file-series-version": "1.0", "files": [)";
  for (std::size_t i = 0; i < kMaxTimeSteps + 5; ++i)
    text += (i > 0 ? "," : "") + std::string(R"({"name": ")") + std::to_string(i) + R"(.qnv"})";
  const auto step = step_in(text + "]}", qnv::ShownStep{0, kNewestStep});
  REQUIRE(step);
  CHECK(is_valid(step->steps));
  CHECK(step->file == std::to_string(kMaxTimeSteps + 4) + ".qnv");
}

TEST_CASE("opens one step of a series on a server, and asks for no other step") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  const auto put = [&](const std::string& url, const std::string& text) {
    net::MemoryResource resource;
    resource.bytes = test::bytes_of(text);
    resource.validator.etag = "\"1\"";
    network->put(url, std::move(resource));
  };
  put("memory://a/run/run.series", kRun);
  for (std::size_t i = 0; i < 3; ++i) put("memory://a/run/s" + std::to_string(i) + ".wrl", shapes(i + 1));
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{network};
  options.component.step = qnv::ShownStep{1, {}};
  const LoadedWorld world = load_world("memory://a/run/run.series", options);
  CHECK(said(world).empty());
  REQUIRE(world.scene);
  CHECK(world.scene->roots().size() == 2);
  CHECK(world.steps == TimeSteps{{0.5, 1.5, 2.5}, 1});
  CHECK(world.path == "memory://a/run/run.series");
  REQUIRE(network->transfers().size() == 2);
  CHECK(network->transfers()[1].url == "memory://a/run/s1.wrl");
}

TEST_CASE("opens the first step of a local series, and names the file that is missing") {
  const ScratchFolder folder;
  const std::string path = folder.write("run.series", kRun);
  (void)folder.write("s0.wrl", shapes(3));
  const LoadedWorld world = load_world(path, {});
  CHECK(said(world).empty());
  REQUIRE(world.scene);
  CHECK(world.scene->roots().size() == 3);
  LoadOptions options;
  options.component.step = qnv::ShownStep{2, {}};
  const LoadedWorld none = load_world(path, options);
  CHECK_FALSE(none.scene);
  CHECK(said(none).find("s2.wrl") != std::string::npos);
}

TEST_CASE("opens the steps of a series of meshes of other programs, as STL and OBJ") {
  const ScratchFolder folder;
  for (int step = 0; step < 2; ++step) {
    const std::string x = step == 0 ? "1" : "2.25";
    (void)folder.write("m" + std::to_string(step) + ".stl",
                       "solid m\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex " + x +
                           " 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid m\n");
    (void)folder.write("m" + std::to_string(step) + ".obj", "v 0 0 0\nv " + x + " 0 0\nv 0 1 0\nf 1 2 3\n");
  }
  for (const std::string extension : {"stl", "obj"}) {
    INFO(extension);
    const std::string path =
        folder.write("m." + extension + ".series", R"({"file-series-version": "1.0", "files": [{"name": "m0.)" +
                                                       extension + R"(", "time": 0}, {"name": "m1.)" + extension +
                                                       R"(", "time": 2}]})");
    std::vector<std::size_t> sizes;
    for (std::uint32_t step = 0; step < 2; ++step) {
      LoadOptions options;
      options.component.step = qnv::ShownStep{step, {}};
      const LoadedWorld world = load_world(path, options);
      CHECK(said(world).empty());
      REQUIRE(world.scene);
      CHECK(world.steps == TimeSteps{{0, 2}, step});
      sizes.push_back(world.bytes);
    }
    CHECK(sizes[1] == sizes[0] + 3);  // of the file of the step
  }
}

TEST_CASE("reads no series in a series, and no step outside of its folder") {
  const ScratchFolder folder;
  const auto naming = [](const std::string& name) {
    return R"({"file-series-version": "1.0", "files": [{"name": ")" + name + R"(", "time": 0}]})";
  };
  const std::string own = folder.write("own.series", naming("own.series"));
  CHECK_FALSE(load_world(own, {}).scene);
  (void)folder.write("secret.wrl", shapes(1));
  const std::string outside = folder.write("inner/run.series", naming("../secret.wrl"));
  const LoadedWorld world = load_world(outside, {});
  CHECK_FALSE(world.scene);
  CHECK(world.diagnostics.errors() == 1);
}

}  // namespace
}  // namespace gs::app::series_step_test
