#include "app/saving/save_formats.h"

#include "base/gzip.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <span>
#include <string>

namespace gs::app::save_formats_test {

TEST_CASE("selects the format by the extension, and adds .wrl to unknown ones") {
  CHECK(is_text_path("A.WRL"));
  CHECK(is_text_path("a.wrl.gz"));
  CHECK_FALSE(is_text_path("a.glb"));
  CHECK(path_with_format("/a/room") == "/a/room.wrl");
  CHECK(path_with_format("/a/room.v2") == "/a/room.v2.wrl");
  CHECK(path_with_format("/a/room.wrz") == "/a/room.wrz");
  CHECK(path_with_format("/a/room.x3d") == "/a/room.x3d");
  CHECK(save_format_list().starts_with(".wrl (VRML97), .x3d (X3D XML), .x3dv (X3D classic), .x3dj (X3D JSON); only"));
  CHECK(path_with_format("/a/room.3dgs.ply") == "/a/room.3dgs.ply");
  CHECK(save_format_list().find(".glb") != std::string::npos);
}

TEST_CASE("writes plain and compressed text, and keeps the old file after an error") {
  const ScratchFolder folder;
  CHECK_FALSE(write_world_text(folder.path("a.wrl"), "#VRML"));
  CHECK(folder.read("a.wrl") == "#VRML");
  CHECK_FALSE(write_world_text(folder.path("a.wrz"), "#VRML"));
  const std::string packed = folder.read("a.wrz");
  CHECK(is_gzip(std::as_bytes(std::span(packed))));
  std::filesystem::create_directory(folder.path("b.wrl"));
  CHECK(write_world_text(folder.path("b.wrl"), "#VRML"));
  CHECK(write_world_text(folder.path("none/a.wrl"), "#VRML"));
  CHECK(std::filesystem::is_directory(folder.path("b.wrl")));
}

}  // namespace gs::app::save_formats_test
