// Tests of export, and of pictures of streams, as a user runs them.
#include "app/formats/export/export.h"
#include "tests/app/commands/vector_commands.h"
#include "tests/app/geometry_shapes.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

using namespace gs::app;
using namespace gs::test;

TEST_CASE("export: writes every format of the table, and reads it back") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), stream = folder.path("ball.qnv");
  REQUIRE(run("encode --vectors 3000 " + quoted(world) + " " + quoted(stream)).status == kDone);
  for (const ExportFormat& format : export_formats()) {
    if ((format.keeps & (kNeedsTriangles | kNeedsValues)) != 0) continue;
    const std::string out = folder.path("out" + std::string(format.extension));
    const Run result = run("export --vectors 1000 " + quoted(stream) + " " + quoted(out));
    INFO(result.output);
    REQUIRE(result.status == kDone);
    CHECK(result.output.find(" -> " + out + " ") != std::string::npos);
    CHECK(result.output.find(" (1,000 splats), ") != std::string::npos);
    // A second export may replace a file of the same format.
    CHECK(run("export --vectors 1000 " + quoted(stream) + " " + quoted(out)).status == kDone);
    CHECK(info(out)["bytes"] > 1000);
  }
  const nlohmann::json points = info(folder.path("out.ply")), splats = info(folder.path("out.spz"));
  CHECK(points["vectors"] == 1000);
  CHECK(points["area"] == Approx(kBallArea).epsilon(0.02));
  CHECK(splats["vectors"] == 1000);
  CHECK(splats["area"] == Approx(kBallArea).epsilon(0.1));
  // Encodes a mesh before exporting. A world for any browser names the stream for GhostSpace.
  CHECK(run("export --vectors 500 " + quoted(world) + " " + quoted(folder.path("mesh.ply"))).status == kDone);
  CHECK(info(folder.path("mesh.ply"))["vectors"] == 500);
  REQUIRE(run("export --vrml97 " + quoted(stream) + " " + quoted(folder.path("world.wrl"))).status == kDone);
  CHECK(folder.read("world.wrl").find("\"ball.qnv\"") != std::string::npos);
  CHECK(info(folder.path("world.wrl"))["vectors"] == info(stream)["vectors"]);
  CHECK(run("check " + quoted(folder.path("world.wrl"))).output.empty());
}

TEST_CASE("export: writes the nodes of a scene or mesh as VRML97 and X3D, and the same bytes after a second way") {
  const ScratchFolder folder;
  const std::string scene =
      folder.write("a.wrl",
                   "#VRML V2.0 utf8\nDEF S Switch { choice Shape { geometry Sphere { } } whichChoice 0 }\n"
                   "DEF T TouchSensor { }\nDEF X Script { eventIn SFBool on url \"javascript: function on(v) { }\" }\n"
                   "ROUTE T.isActive TO X.on\n");
  const std::string mesh = folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const std::string& in : {scene, mesh})
    for (const char* extension : {".wrl", ".x3d", ".x3dv", ".x3dj", ".wrz", ".x3dz"}) {
      const std::string once = folder.path(std::string("once") + extension),
                        twice = folder.path(std::string("twice") + extension);
      const Run result = run("export " + quoted(in) + " " + quoted(once));
      INFO(in << extension << "\n" << result.output);
      REQUIRE(result.status == kDone);
      CHECK(result.output.find(" nodes), ") != std::string::npos);
      REQUIRE(run("export " + quoted(once) + " " + quoted(twice)).status == kDone);
      CHECK(folder.read(std::string("once") + extension) == folder.read(std::string("twice") + extension));
      CHECK(run("check " + quoted(once)).output.empty());
      std::filesystem::remove(once);
      std::filesystem::remove(twice);
    }
  // X3D becomes VRML97 with a note for each node that VRML97 lacks.
  const std::string x3d =
      folder.write("b.x3dv", "#X3D V3.3 utf8\nPROFILE Immersive\nShape { geometry Rectangle2D { } }\nKeySensor { }\n");
  const Run result = run("export " + quoted(x3d) + " " + quoted(folder.path("b.wrl")));
  INFO(result.output);
  CHECK(result.status == kDone);
  CHECK(result.output.find("note: KeySensor is left out: VRML97 has no such node") != std::string::npos);
  CHECK(folder.read("b.wrl").find("geometry IndexedFaceSet") != std::string::npos);
}

TEST_CASE("encode and export overwrite only files of their own kind") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), stream = folder.path("ball.qnv");
  REQUIRE(run("encode --vectors 4000 " + quoted(world) + " " + quoted(stream)).status == kDone);
  CHECK(run("encode --vectors 4000 " + quoted(world) + " " + quoted(stream)).status == kDone);
  const std::string bytes = folder.read("ball.qnv");
  const std::string notes = folder.write("notes.qnv", "mine"),
                    mesh = folder.write("mesh.ply", "ply\nformat ascii 1.0\n");
  for (const std::string& arguments :
       {"encode " + quoted(world) + " " + quoted(notes), "encode " + quoted(stream) + " " + quoted(stream),
        "export " + quoted(stream) + " " + quoted(mesh), "export " + quoted(world) + " " + quoted(world),
        "encode " + quoted(folder.path("missing.wrl")) + " " + quoted(stream),
        "encode " + quoted(folder.write("empty.wrl", "#VRML V2.0 utf8\n")) + " " + quoted(stream),
        "export " + quoted(folder.write("cut.qnv", bytes.substr(0, 40))) + " " + quoted(folder.path("x.ply")),
        "info " + quoted(folder.path("cut.qnv")), "info " + quoted(folder.path("missing"))}) {
    const Run result = run(arguments);
    INFO(arguments << "\n" << result.output);
    CHECK(result.status == kFailed);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    CHECK(result.output.find("error: ") != std::string::npos);
  }
  CHECK(folder.read("notes.qnv") == "mine");
  CHECK(folder.read("mesh.ply") == "ply\nformat ascii 1.0\n");
  CHECK(folder.read("ball.wrl") == kBall);
  CHECK(folder.read("ball.qnv") == bytes);
  // A truncated stream still gives a picture of its first part.
  const std::string cut = folder.write("half.qnv", bytes.substr(0, bytes.size() * 2 / 3));
  CHECK(run("export " + quoted(cut) + " " + quoted(folder.path("half.ply"))).status == kDone);
  CHECK(info(folder.path("half.ply"))["vectors"] > 0);
  CHECK(info(cut)["problems"].size() == 1);
}

TEST_CASE("snapshot: draws with budgets, losses and prefixes of a stream, on both paths") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), stream = folder.path("ball.qnv");
  REQUIRE(run("encode --vectors 20000 " + quoted(world) + " " + quoted(stream)).status == kDone);
  const auto snapshot = [&](const std::string& options) {
    const std::string stats = folder.path("stats.json");
    const Run result =
        run("--snapshot " + quoted(folder.path("ball.png")) + " --size 200x150 --backend osmesa --stats " +
            quoted(stats) + " " + options + " " + quoted(stream));
    INFO(options << "\n" << result.output);
    REQUIRE(result.status == kDone);
    CHECK(result.output.empty());
    return nlohmann::json::parse(folder.read("stats.json"));
  };
  const nlohmann::json whole = snapshot("");
  CHECK(whole["vectors"] > 500);
  CHECK(whole["splats"] == "cpu");
  CHECK(whole["colors"] > 10);
  CHECK(snapshot("--splats gl")["splats"] == "gl");
  // About half of a ball's splats face the viewer.
  const nlohmann::json few = snapshot("--budget 800");
  CHECK(few["vectors"] > 90);
  CHECK(few["vectors"] <= 800);
  CHECK(snapshot("--max-bytes 1000")["vectors"] > 20);
  const nlohmann::json lossy = snapshot("--loss 1");
  CHECK(lossy["vectors"] > 100);
  CHECK(snapshot("--loss 30%:5")["vectors"] == snapshot("--loss 0.3:5")["vectors"]);
  CHECK(run("--snapshot x.png --loss 1.5 " + quoted(stream)).status == kUsage);
  CHECK(run("--snapshot x.png --loss 130% " + quoted(stream)).status == kUsage);
  CHECK(run("--snapshot x.png --splats fast " + quoted(stream)).status == kUsage);
  CHECK(run("--snapshot x.png --budget 0 " + quoted(stream)).status == kUsage);
}

TEST_CASE("export and encode edit Gaussian splats and name what they remove") {
  const ScratchFolder folder;
  const gs::qnv::Gaussians splats = gs::test::random_gaussians(300, 1);
  const auto bytes = export_splats_ply(splats);
  const auto& file = std::get<std::vector<std::byte>>(bytes);
  const std::string in = folder.write("in.ply", std::string(reinterpret_cast<const char*>(file.data()), file.size()));
  for (const char* name : {"out.3dgs.ply", "out.spz", "out.sog", "out.glb", "out.qnv"}) {
    const std::string out = folder.path(name), command = name == std::string("out.qnv") ? "encode" : "export";
    const Run result =
        run(command + " --crop-box=-1,-1,-1,1,1,1 --min-opacity 20% --move 10,0,0 " + quoted(in) + " " + quoted(out));
    INFO(result.output);
    REQUIRE(result.status == kDone);
    CHECK(result.output.find(" of 300 splats are cropped") != std::string::npos);
    CHECK(result.output.find(" of 300 splats have less than the minimum opacity") != std::string::npos);
    const nlohmann::json facts = info(out);
    CHECK(facts["vectors"] > 10);
    CHECK(facts["vectors"] < 200);
  }
  CHECK(run("export --crop-sphere 50,0,0,1 " + quoted(in) + " " + quoted(folder.path("a.spz")))
            .output.find("--crop-sphere leaves no splat of 300") != std::string::npos);
  const std::string regions = folder.path("regions.3dgs.ply");
  REQUIRE(run("export --crop-box=-9,-9,-9,0,9,9 --crop-box 0,-9,-9,9,9,9 --remove-sphere 0,0,0,0.5 --remove-box "
              "0,0,0,9,9,9 " +
              quoted(in) + " " + quoted(regions))
              .status == kDone);
  std::size_t left = 0;
  for (const glm::vec3& p : splats.positions)
    left += glm::length(p) > 0.5f && !(p.x >= 0 && p.y >= 0 && p.z >= 0) ? 1 : 0;
  CHECK(info(regions)["vectors"] == left);
  const std::string world = folder.write("ball.wrl", kBall);
  const Run refused = run("export --exposure 1 " + quoted(world) + " " + quoted(folder.path("b.wrl")));
  CHECK(refused.status != kDone);
  CHECK(refused.output.find("--exposure edits Gaussian splats; expected a file of splats") != std::string::npos);
}
