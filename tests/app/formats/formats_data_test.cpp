#include "app/formats/gltf/gltf.h"
#include "tests/app/formats_helpers.h"

#include <algorithm>

namespace {

using namespace gs;
using namespace gs::test;
namespace fs = std::filesystem;

struct File {
  const char* path;
  Import import;
  std::size_t points, triangles;
};

Import with_files(const char* type, const fs::path& folder) {
  return {type, [folder](const std::string& name) -> gs::app::BytesResult {
            if (!fs::is_regular_file(folder / name)) return "there is no " + name;
            return gs::app::shared_bytes(file_bytes(folder / name));
          }};
}

TEST_CASE("reads meshes of other programs completely") {
  const fs::path folder = shared_folder() / "data" / "meshes";
  if (!fs::is_directory(folder)) {
    WARN("skipped: no shared data (set GHOSTSPACE_SHARED)");
    return;
  }
  using namespace gs::app;
  // The expected counts of PLY files are those in their headers. The other counts were recorded after a check of the
  // pictures.
  const File files[] = {
      {"cgal/building.ply", "PLY", 100000, 0},
      {"scans/bun_zipper.ply", "PLY", 35947, 69451},
      {"scans/lucy.ply", "PLY", 49987, 99970},
      {"cad/cycloidal.ply", "PLY", 21384, 43368},
      {"odedstein/hammer.obj", with_files("OBJ", folder / "odedstein"), 30082, 60160},
      {"cad/42400-IDGH.stl", "STL", 5500, 11036},
      {"cad/featuretype.STL", "STL", 2010, 3476},
      {"cad/gears.stl", "STL", 9723, 19426},
      {"gltf/Duck.glb", with_files("glTF", folder / "gltf"), 2399, 4212},
      {"gltf/CesiumMan.glb", with_files("glTF", folder / "gltf"), 3273, 4672},
      {"gltf/Fox/Fox.gltf", with_files("glTF", folder / "gltf" / "Fox"), 1728, 576},
  };
  for (const File& file : files) {
    INFO(file.path);
    if (!fs::is_regular_file(folder / file.path)) {
      WARN("skipped: " << file.path << " is not there");
      continue;
    }
    const Imported result = imported(file.import, file_bytes(folder / file.path));
    CHECK(result.messages().empty());
    std::size_t points = 0, faces = 0;
    for (const auto node : result.all("Coordinate"))
      points += result.scene->get<gs::vrml::MFVec3f>(node, "point").size();
    for (const auto node : result.all("IndexedFaceSet")) {
      const auto& index = result.scene->get<gs::vrml::MFInt32>(node, "coordIndex");
      faces += static_cast<std::size_t>(std::count(index.begin(), index.end(), -1));
    }
    CHECK(points == file.points);
    CHECK(faces == file.triangles);
  }
}

TEST_CASE("survives truncated and damaged files of other programs") {
  const fs::path folder = shared_folder() / "data" / "meshes";
  if (!fs::is_directory(folder)) {
    WARN("skipped: no shared data (set GHOSTSPACE_SHARED)");
    return;
  }
  using namespace gs::app;
  const File files[] = {
      {"cad/featuretype.STL", "STL", 0, 0},
      {"gltf/Duck.glb", with_files("glTF", folder / "gltf"), 0, 0},
      {"gltf/CesiumMan.glb", with_files("glTF", folder / "gltf"), 0, 0},
      {"gltf/Fox/Fox.gltf", with_files("glTF", folder / "gltf" / "Fox"), 0, 0},
  };
  for (const File& file : files) {
    INFO(file.path);
    if (!fs::is_regular_file(folder / file.path)) {
      WARN("skipped: " << file.path << " is not there");
      continue;
    }
    const Bytes whole = file_bytes(folder / file.path);
    for (int part = 0; part < 16; ++part) {
      const auto cut = static_cast<std::ptrdiff_t>(whole.size() * static_cast<std::size_t>(part) / 16);
      check_sound(imported(file.import, Bytes(whole.begin(), whole.begin() + cut)));
    }
    std::uint32_t random = 1;
    for (int round = 0; round < 24; ++round) {
      Bytes damaged = whole;
      // Changes bytes near the start, because the structure of the file is there.
      for (int i = 0; i < 4; ++i) {
        random = random * 1664525u + 1013904223u;
        damaged[(random >> 8) % std::min<std::size_t>(damaged.size(), 20000)] = static_cast<std::byte>(random >> 24);
      }
      check_sound(imported(file.import, damaged));
    }
  }
}

}  // namespace
