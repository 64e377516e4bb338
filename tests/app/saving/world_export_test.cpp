#include "app/saving/world_export.h"

#include "app/formats/export/export.h"
#include "app/formats/splats/splat_edit.h"
#include "tests/app/commands/vector_commands.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <semaphore>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::world_export_test {
namespace {

WorldExport::Result result_of(const std::string& source, const std::string& target,
                              const std::vector<std::string>& options = {}) {
  std::binary_semaphore woken{0};
  WorldExport started(
      {source, {}, nullptr, options}, target, [&] { woken.release(); }, program());
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

TEST_CASE("writes edited splats as a file of splats and as a stream") {
  const ScratchFolder folder;
  const auto made = export_splats_ply(test::random_gaussians(300, 1));
  const auto& bytes = std::get<std::vector<std::byte>>(made);
  const std::string in = folder.write("in.ply", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  SplatEdit edit;
  edit.crops = {{SplatBox{{-1, -1, -1}, {1, 1, 1}}}};
  qnv::Gaussians left = test::random_gaussians(300, 1);
  (void)edit_splats(left, edit);
  for (const char* name : {"out.3dgs.ply", "out.qnv"}) {
    CHECK(result_of(in, folder.path(name), options_of(edit)).problem.value_or("") == "");
    CHECK(test::info(folder.path(name))["vectors"] == left.size());
  }
}

}  // namespace gs::app::world_export_test
