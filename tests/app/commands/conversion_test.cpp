// Tests of the words of encode and export: methods, summaries and losses, as a user meets them.
#include "tests/app/commands/vector_commands.h"

#include <regex>
#include <string>

using namespace gs::app;
using namespace gs::test;

namespace {

const std::string kFaces =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
    "property uchar blue\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";

}  // namespace

TEST_CASE("encode: prints one line with both files, sizes, contents and time") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), out = folder.path("ball.qnv");
  const Run result = run("encode " + quoted(world) + " " + quoted(out));
  INFO(result.output);
  REQUIRE(result.status == kDone);
  CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
  CHECK(result.output.starts_with(world + " "));
  CHECK(std::regex_search(result.output, std::regex("\\d+ B -> .*ball.qnv [0-9.]+ kB \\(displaced mesh, original mesh "
                                                    "at the end\\), [0-9.]+ s\n")));
  CHECK(run("encode --keep-mesh none " + quoted(world) + " " + quoted(out)).output.find("(displaced mesh), ") !=
        std::string::npos);
  CHECK(run("encode --vectors 2000 " + quoted(world) + " " + quoted(out)).output.find("(octree of ") !=
        std::string::npos);
  const nlohmann::json facts =
      nlohmann::json::parse(run("encode --json --method records " + quoted(world) + " " + quoted(out)).output);
  CHECK(facts["contents"].get<std::string>().starts_with("records of "));
  CHECK(facts["mesh_at_end"] == false);
  CHECK(facts["losses"].empty());
}

TEST_CASE("encode: the methods and their former spellings write the same bytes") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), out = folder.path("ball.qnv");
  const auto bytes = [&](const std::string& options) {
    const Run result = run("encode " + options + " " + quoted(world) + " " + quoted(out));
    INFO(options << "\n" << result.output);
    REQUIRE(result.status == kDone);
    return folder.read("ball.qnv");
  };
  CHECK(bytes("--method auto") == bytes(""));
  CHECK(bytes("--method displaced") == bytes("--displaced"));
  CHECK(bytes("--method octree --vectors 2000") == bytes("--packed --vectors 2000"));
  CHECK(bytes("--method records --vectors 2000") == bytes("--records --vectors 2000"));
  CHECK(bytes("--method outlines") == bytes("--outlines"));
  CHECK(bytes("--keep-mesh 11") == bytes("--exact"));
  CHECK(bytes("--keep-mesh none") == bytes("--exact=none"));
  CHECK(bytes("--keep-mesh exact") == bytes("--exact=20"));
  for (const char* wrong :
       {"--method best", "--keep-mesh", "--keep-mesh 7", "--keep-mesh all", "--method octree --records",
        "--keep-mesh exact --method octree", "--keep-mesh 12 --vectors 100"}) {
    INFO(wrong);
    CHECK(run("encode " + std::string(wrong) + " " + quoted(world) + " " + quoted(out)).status == kUsage);
  }
  const std::string help = run("encode --help").output;
  for (const char* former : {"--displaced", "--packed", "--records", "--outlines", "--exact"})
    CHECK(help.find(former) == std::string::npos);
}

TEST_CASE("encode: reports the properties that are lost") {
  const ScratchFolder folder;
  const std::string world =
      folder.write("glass.wrl",
                   "#VRML V2.0 utf8\nViewpoint { }\nDirectionalLight { }\nDEF T TimeSensor { }\n"
                   "DEF M Transform { children [\n"
                   "Shape { appearance Appearance { material Material { transparency 0.5 specularColor 1 1 1 } } "
                   "geometry Box { } }\n"
                   "Shape { appearance Appearance { material Material { emissiveColor 1 0 0 } } geometry Sphere { } }\n"
                   "Shape { geometry PointSet { coord Coordinate { point [ 0 0 0 ] } } } ] }\n"
                   "DEF P PositionInterpolator { }\nROUTE T.fraction_changed TO P.set_fraction\n");
  const std::string output = run("encode " + quoted(world) + " " + quoted(folder.path("out.qnv"))).output;
  INFO(output);
  for (const char* loss : {"note: 1 transparent Shape becomes opaque", "note: 1 Shape with emissiveColor",
                           "note: 1 Shape of lines or points", "note: 1 light is left out", "note: 1 Viewpoint is",
                           "note: 1 ROUTE for animation", "note: specular colours"})
    CHECK(output.find(loss) != std::string::npos);
  const std::string gltf =
      folder.write("a.gltf",
                   R"({"asset":{"version":"2.0"},"materials":[{"normalTexture":{"index":0},"pbrMetallicRoughness":{
      "metallicRoughnessTexture":{"index":0}},"extensions":{"KHR_materials_clearcoat":{}}}],"animations":[{}],
      "scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,
      "byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
                   R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  const Run scene = run("encode " + quoted(gltf) + " " + quoted(folder.path("g.qnv")));
  INFO(scene.output);
  CHECK(
      scene.output.find("parts of materials are left out: KHR_materials_clearcoat, metallic and roughness maps, normal "
                        "maps") != std::string::npos);
  CHECK(scene.output.find("1 animation is left out") != std::string::npos);
  const Run faces = run("encode " + quoted(folder.write("faces.ply", kFaces)) + " " + quoted(folder.path("f.qnv")));
  CHECK(faces.output.find("colours of faces blend") != std::string::npos);
}

TEST_CASE("export: writes the triangles of a mesh unchanged as STL, OBJ, PLY and glTF") {
  const ScratchFolder folder;
  const std::string mesh = folder.write("faces.ply", kFaces);
  for (const char* name : {"out.stl", "out.obj", "out.ply", "out.glb"}) {
    const std::string out = folder.path(name);
    const Run result = run("export " + quoted(mesh) + " " + quoted(out));
    INFO(name << "\n" << result.output);
    REQUIRE(result.status == kDone);
    CHECK(result.output.find(", 2 triangles") != std::string::npos);
    CHECK(result.output.find("vectors") == std::string::npos);
    CHECK(info(out)["triangles"] == 2);
    CHECK(run("export " + quoted(mesh) + " " + quoted(out)).status == kDone);  // again
  }
  CHECK(folder.read("out.ply").find("element vertex 6\n") != std::string::npos);  // both colours stay
  CHECK(folder.read("out.obj").find("v 1 0 0 1 0 0\n") != std::string::npos);
  CHECK(folder.read("out.mtl").starts_with("# GhostSpace\n"));
  CHECK(run("export " + quoted(mesh) + " " + quoted(folder.path("out.stl"))).output.find("colours are left out") !=
        std::string::npos);
  CHECK(run("export --vectors 10 " + quoted(mesh) + " " + quoted(folder.path("x.stl"))).status == kUsage);
  const std::string points = folder.write("p.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n");
  const Run none = run("export " + quoted(points) + " " + quoted(folder.path("p.stl")));
  CHECK(none.status == kFailed);
  CHECK(none.output.find("no triangles") != std::string::npos);
  folder.write("mine.mtl", "newmtl mine\n");
  CHECK(run("export " + quoted(mesh) + " " + quoted(folder.path("mine.obj"))).status == kFailed);
  CHECK(folder.read("mine.mtl") == "newmtl mine\n");
}

TEST_CASE("opens and encodes a foreign file or folder with a message that says what to do") {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder.path("a.zarr"));
  folder.write("a.zarr/.zgroup", "{\"zarr_format\": 2}");
  const std::string step = folder.write("part.step", "ISO-10303-21;\nHEADER;\n"), zarr = folder.path("a.zarr");
  const std::string out = quoted(folder.path("x.qnv")), picture = "--snapshot " + quoted(folder.path("x.png")) + " ";
  for (const std::string& command : {"encode " + quoted(step) + " " + out, "info " + quoted(step),
                                     "check " + quoted(step), picture + quoted(step)}) {
    const Run result = run(command);
    INFO(command << "\n" << result.output);
    CHECK(result.status == kFailed);
    CHECK(result.output.find("STEP cannot be read; open it in FreeCAD") != std::string::npos);
  }
  for (const std::string& command : {"encode " + quoted(zarr) + " " + out, picture + quoted(zarr)}) {
    const Run result = run(command);
    INFO(command << "\n" << result.output);
    CHECK(result.status == kFailed);
    CHECK(result.output.find("Zarr: none of its 0 datasets can be shown") != std::string::npos);
  }
}
