#include "app/saving/world_export.h"

#include "tests/app/program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <optional>
#include <semaphore>
#include <string>

namespace gs::app::world_export_test {
namespace {

WorldExport::Result result_of(const std::string& source, const std::string& target) {
  std::binary_semaphore woken{0};
  WorldExport started(
      {source, {}, nullptr}, target, [&] { woken.release(); }, program());
  woken.acquire();
  auto result = started.take();
  REQUIRE(result);
  CHECK_FALSE(started.take());
  return *result;
}

}  // namespace

TEST_CASE("writes a world in another format, and replaces a file of any format") {
  const ScratchFolder folder;
  const std::string world = folder.write("a.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  const std::string target = folder.write("a.ply", "a text");
  const auto result = result_of(world, target);
  CHECK(result.problem.value_or("") == "");
  CHECK(result.target == target);
  CHECK(folder.read("a.ply").starts_with("ply\n"));
}

TEST_CASE("keeps the old file if the world cannot be exported") {
  const ScratchFolder folder;
  const std::string target = folder.write("a.ply", "a text");
  const auto result = result_of(folder.path("none.wrl"), target);
  CHECK(result.problem.value_or("").find("none.wrl") != std::string::npos);
  CHECK(folder.read("a.ply") == "a text");
}

}  // namespace gs::app::world_export_test
