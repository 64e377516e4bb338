// Tests of encode and info, as a user runs them.
#include "tests/app/commands/vector_commands.h"
#include "app/commands/common/vectors_of.h"
#include "app/commands/encode.h"
#include "app/formats/export/export.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <csignal>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

TEST_CASE("encode: makes a stream with the area, title and source of a world, and info prints them") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), out = folder.path("ball.qnv");
  const Run result = run("encode --vectors 20000 " + quoted(world) + " " + quoted(out));
  INFO(result.output);
  REQUIRE(result.status == kDone);
  CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
  CHECK(result.output.starts_with(world + " "));
  CHECK(result.output.find(" -> " + out + " ") != std::string::npos);
  const nlohmann::json facts = info(out);
  CHECK(facts["type"] == "QNV");
  CHECK(facts["payload"] == "packed");
  CHECK(facts["kind"] == "surface");
  CHECK(facts["colors"] == "one");
  CHECK(facts["color"] == "#ff0000");
  CHECK(facts["area"] == Approx(kBallArea).epsilon(0.02));
  CHECK(facts["metadata"]["title"] == "The ball");
  CHECK(facts["metadata"]["source"] == "ball.wrl");
  CHECK(facts["metadata"]["units"] == "m");
  CHECK(facts["damaged_chunks"] == 0);
  CHECK(facts["vectors"] > 10000);
  CHECK(facts["vectors"] < 40000);
  std::size_t shown = 0, chunks = 0;
  for (const auto& level : facts["levels"]) {
    shown += level["shown"].get<std::size_t>();
    chunks += level["chunks"].get<std::size_t>();
  }
  CHECK(shown == facts["vectors"]);
  CHECK(chunks == facts["chunks"]);
  CHECK(run("info " + quoted(out)).output.find("title: The ball") != std::string::npos);
}

TEST_CASE("info prints version, profile, components, units and metadata of an X3D world") {
  const ScratchFolder folder;
  const std::string world =
      folder.write("world.x3dv",
                   "#X3D V3.3 utf8\nPROFILE Interactive\nCOMPONENT NURBS:2\n"
                   "META \"title\" \"The world\"\nMETA \"creator\" \"A\"\nMETA \"creator\" \"B\"\n"
                   "UNIT length inch 0.0254\nShape { geometry Box { } }");
  const nlohmann::json facts = info(world);
  CHECK(facts["type"] == "X3D in classic encoding");
  CHECK(facts["title"] == "The world");
  CHECK(facts["version"] == "3.3");
  CHECK(facts["profile"] == "Interactive");
  CHECK(facts["components"] == nlohmann::json({"NURBS:2"}));
  CHECK(facts["units"][0]["name"] == "inch");
  CHECK(facts["metadata"]["creator"] == "A; B");
}

TEST_CASE("encode reports which properties of splats discs discard, and info names Gaussians") {
  const ScratchFolder folder;
  const std::string note = "splats become opaque surface splats, without their opacity";
  std::string opaque;
  for (const float f : {1.0f, 2.0f, 3.0f, 0.5f, 0.25f, 0.001f}) opaque.append(reinterpret_cast<const char*>(&f), 4);
  opaque += "\x10\x20\x30\xff\xff\x80\x80\x80";
  std::string translucent = opaque;
  translucent[27] = '\x40';
  const std::string a = folder.write("opaque.splat", opaque), b = folder.write("glass.splat", translucent),
                    out = folder.path("out.qnv");
  CHECK(run("encode " + quoted(a) + " " + quoted(out)).output.find("opaque surface splats") == std::string::npos);
  CHECK_FALSE(info(a)["metadata"].contains("splats as discs"));
  const Run kept = run("encode " + quoted(b) + " " + quoted(out) + " 2>&1 >/dev/null");
  CHECK(kept.status == kDone);
  CHECK(kept.output ==
        b + ": note: positions, shapes, opacities and colours of splats are rounded; info names the errors\n");
  CHECK(info(out)["payload"] == "gaussians");
  const Run encoded = run("encode --method records " + quoted(b) + " " + quoted(out) + " 2>&1 >/dev/null");
  CHECK(encoded.status == kDone);
  CHECK(encoded.output == b + ": note: " + note + "\n");
  const nlohmann::json facts = info(b);
  CHECK(facts["kind"] == "Gaussians");
  CHECK(facts["harmonics"] == 0);
  CHECK_FALSE(facts["metadata"].contains("splats as discs"));
  CHECK(info(out)["kind"] == "surface");
  CHECK(info(out)["metadata"]["splats as discs"] == "opaque surface splats, without their opacity");
}

TEST_CASE("encode: keeps Gaussian splats, and export writes them again") {
  const ScratchFolder folder;
  const qnv::Gaussians cloud = splat_cloud(400, 1);
  const auto exported = export_splats_ply(cloud);
  const auto* bytes = std::get_if<std::vector<std::byte>>(&exported);
  REQUIRE(bytes);
  const std::string ply = folder.write("cloud.ply", {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  const std::string stream = folder.path("cloud.qnv"), back = folder.path("back.3dgs.ply");
  const Run encoded = run("encode " + quoted(ply) + " " + quoted(stream));
  INFO(encoded.output);
  REQUIRE(encoded.status == kDone);
  CHECK(encoded.output.find("400 Gaussians") != std::string::npos);
  const nlohmann::json facts = info(stream);
  CHECK(facts["payload"] == "gaussians");
  CHECK(facts["vectors"] == 400);
  CHECK(facts["harmonics"] == 1);
  CHECK(facts["errors_at_the_end"]["opacity"][1] == Approx(1.0 / 63));
  CHECK(facts["damaged_chunks"] == 0);
  std::size_t chunks = 0;
  for (const auto& level : facts["levels"]) chunks += level["chunks"].get<std::size_t>();
  CHECK(chunks < facts["chunks"]);  // those of harmonics have no level
  CHECK(run("export " + quoted(stream) + " " + quoted(back)).status == kDone);
  const nlohmann::json again = info(back);
  CHECK(again["vectors"] == 400);
  CHECK(again["area"] == Approx(info(ply)["area"].get<double>()).epsilon(0.02));
  for (const char* name : {"back.spz", "back.splats.glb", "back.v3.spz"}) {
    CHECK(run("export " + quoted(stream) + " " + quoted(folder.path(name))).status == kDone);
    if (std::string_view(name).ends_with(".spz")) CHECK(info(folder.path(name))["vectors"] == 400);
  }
  const std::string fine = folder.path("fine.qnv"), encode = "encode " + quoted(ply) + " " + quoted(fine);
  REQUIRE(run(encode + " --error 1%").status == kDone);
  CHECK(info(fine)["errors_at_the_end"]["position_in_deviations"][0] <= 0.01);
  CHECK(info(fine)["errors_at_the_end"]["position_in_deviations"][0] > 0.009);
  CHECK(info(fine)["bytes"] > facts["bytes"]);
  CHECK(run(encode + " --error 1 2>&1").output.find("expected a percentage above 0") != std::string::npos);
  CHECK(run(encode + " --lossless 2>&1").output.find("splats are rounded") != std::string::npos);
  CHECK(run("encode --method gaussians " + quoted(folder.write("ball.wrl", kBall)) + " " + quoted(stream) + " 2>&1")
            .output.find("--method gaussians applies to Gaussian splats only") != std::string::npos);
}

TEST_CASE("removes unfinished files of killed processes beside the output of a command") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), broken = folder.write("broken.stl", "");
  std::filesystem::create_directory(folder.path("out"));
  const auto leave = [&] {
    folder.write("out/.ghostspace-99-7", "half");
    folder.write("out/.ghostspace-99-7.png", "mine");
    folder.write(".ghostspace-99-7", "elsewhere");
  };
  const auto removed = [&] {
    return !std::filesystem::exists(folder.path("out/.ghostspace-99-7")) &&
           folder.read("out/.ghostspace-99-7.png") == "mine" && folder.read(".ghostspace-99-7") == "elsewhere";
  };
  leave();
  CHECK(run("encode --vectors 1000 " + quoted(world) + " " + quoted(folder.path("out/a.qnv"))).status == kDone);
  CHECK(removed());
  leave();  // at the start, also after a failed run
  CHECK(run("encode " + quoted(broken) + " " + quoted(folder.path("out/b.qnv"))).status != kDone);
  CHECK(removed());
}

TEST_CASE("encode: adds the mesh itself with --exact, and export writes it") {
  const ScratchFolder folder;
  // With 2^11 positions along 2047 units, each one is an integer.
  const std::string mesh = folder.write(
      "mesh.obj", "v 0 0 0\nv 2047 0 0\nv 1000 2000 0\nv 500 700 1500\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const std::string stream = folder.path("mesh.qnv"), out = folder.path("out.ply");
  const Run result = run("encode --exact " + quoted(mesh) + " " + quoted(stream));
  INFO(result.output);
  REQUIRE(result.status == kDone);
  const nlohmann::json facts = info(stream);
  CHECK(facts["payload"] == "displaced");
  CHECK(facts["damaged_chunks"] == 0);
  CHECK(facts["exact"]["bits"] == 11);
  CHECK(facts["exact"]["triangles"] == 4);
  CHECK(facts["exact"]["come"] == facts["exact"]["bytes"]);
  REQUIRE(run("export " + quoted(stream) + " " + quoted(out)).status == kDone);
  const std::string ply = folder.read("out.ply");
  CHECK(ply.find("element face 4\n") != std::string::npos);
  const std::size_t count = std::stoul(ply.substr(ply.find("element vertex ") + 15));
  const std::size_t body = ply.find("end_header\n") + 11;
  std::set<std::array<float, 3>> places;
  for (std::size_t v = 0; v < count; ++v) {
    std::array<float, 3> p{};
    REQUIRE(ply.size() >= body + 31 * v + sizeof p);
    std::memcpy(p.data(), ply.data() + body + 31 * v, sizeof p);
    places.insert({std::round(p[0]), std::round(p[1]), std::round(p[2])});
  }
  CHECK(places == std::set<std::array<float, 3>>{{0, 0, 0}, {2047, 0, 0}, {1000, 2000, 0}, {500, 700, 1500}});
  REQUIRE(run("encode --exact=16 " + quoted(mesh) + " " + quoted(stream)).status == kDone);
  CHECK(info(stream)["exact"]["bits"] == 16);
  // info describes a truncated stream, too.
  const std::string bytes = folder.read("mesh.qnv");
  const nlohmann::json part = info(folder.write("part.qnv", bytes.substr(0, bytes.size() - 300)));
  CHECK(!part.contains("exact"));
  CHECK(part["vectors"] > 0);
  CHECK(run("encode --exact " + quoted(folder.write("points.xyz", "0 0 0\n1 0 0\n0 1 0\n")) + " " + quoted(stream))
            .status == kFailed);
}

TEST_CASE("encode: ends a smooth surface with the mesh itself unless --exact=none, and info prints its progress") {
  const ScratchFolder folder;
  std::string text;
  constexpr int kSide = 60;
  for (int i = 0; i < kSide * kSide; ++i)
    text += "v " + std::to_string(i % kSide) + ' ' + std::to_string(i / kSide) + ' ' +
            std::to_string(4 * std::sin(0.2 * (i % kSide)) * std::cos(0.15 * (i / kSide))) + '\n';
  for (int i = 0; i + kSide < kSide * kSide; ++i)
    if (i % kSide != kSide - 1)
      text += "f " + std::to_string(i + 1) + ' ' + std::to_string(i + 2) + ' ' + std::to_string(i + kSide + 1) +
              "\nf " + std::to_string(i + 2) + ' ' + std::to_string(i + kSide + 2) + ' ' +
              std::to_string(i + kSide + 1) + '\n';
  const std::string mesh = folder.write("waves.obj", text), out = folder.path("waves.qnv");
  REQUIRE(run("encode " + quoted(mesh) + " " + quoted(out)).status == kDone);
  const nlohmann::json facts = info(out);
  CHECK(facts["payload"] == "displaced");
  CHECK(facts["exact"]["triangles"] == 2 * (kSide - 1) * (kSide - 1));
  CHECK(facts["exact"]["bits"] >= 11);
  bool partly = false;
  const std::string bytes = folder.read("waves.qnv");
  for (std::size_t part = 1; part < 16; ++part) {
    const nlohmann::json of = info(folder.write("part.qnv", bytes.substr(0, bytes.size() * part / 16)));
    if (!of.contains("exact") || !of["exact"].contains("triangles_come")) continue;
    partly = true;
    CHECK(of["exact"]["triangles_come"] < of["exact"]["triangles"]);
  }
  CHECK(partly);
  REQUIRE(run("encode --exact=none " + quoted(mesh) + " " + quoted(out)).status == kDone);
  CHECK(!info(out).contains("exact"));
  CHECK(info(out)["triangles"] != facts["exact"]["triangles"]);
}

TEST_CASE("encode: reads a mesh that exceeds the memory from its file, and thins it") {
  const ScratchFolder folder;
  // A sheet with waves, as binary STL.
  constexpr int kSide = 160;
  std::string text(84, ' ');
  const std::uint32_t facets = 2 * kSide * kSide;
  std::memcpy(text.data() + 80, &facets, 4);
  const auto put_facet = [&text](std::array<std::array<int, 2>, 3> corners) {
    text.append(12, '\0');
    for (const auto& [i, j] : corners) {
      const float place[3] = {static_cast<float>(i), static_cast<float>(j), 3 * std::sin(0.1f * static_cast<float>(i))};
      text.append(reinterpret_cast<const char*>(place), sizeof place);
    }
    text.append(2, '\0');
  };
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      put_facet({{{i, j}, {i + 1, j}, {i, j + 1}}});
      put_facet({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  const std::string mesh = folder.write("waves.stl", text), out = folder.path("waves.qnv");
  const std::string small = " --memory 16M ";
  CHECK(info(mesh, small)["faces"] == facets);
  const Run result = run("encode --displaced" + small + quoted(mesh) + " " + quoted(out));
  INFO(result.output);
  REQUIRE(result.status == kDone);
  CHECK(result.output.find("simplified to 20971") != std::string::npos);
  nlohmann::json facts = info(out);
  CHECK(facts["payload"] == "displaced");
  CHECK(facts["two_sided"] == true);
  const double area = facts["area"];
  REQUIRE(run("encode --displaced " + quoted(mesh) + " " + quoted(out)).status == kDone);
  CHECK(area == Approx(info(out)["area"].get<double>()).epsilon(0.03));
  REQUIRE(run("encode --packed" + small + quoted(mesh) + " " + quoted(out)).status == kDone);
  CHECK(info(out)["area"] == Approx(area).epsilon(0.03));
  CHECK(run("encode --exact" + small + quoted(mesh) + " " + quoted(out)).status == kFailed);
  CHECK(run("encode --outlines" + small + quoted(mesh) + " " + quoted(folder.path("o.qnv"))).status == kFailed);
}

TEST_CASE("encode: makes records or a smaller octree of points, in the orientation of their file") {
  const ScratchFolder folder;
  std::string text;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) text += std::to_string(i) + " 0 " + std::to_string(j) + " 0 -1 0\n";
  const std::string points = folder.write("wall.xyz", text), out = folder.path("wall.qnv");
  REQUIRE(run("encode " + quoted(points) + " " + quoted(out)).status == kDone);
  CHECK(info(out)["payload"] == "records");
  CHECK(info(out)["metadata"]["up"] == "z");  // the file has the size of a survey, so +Z is up
  const std::size_t records = folder.read("wall.qnv").size();
  REQUIRE(run("encode --packed " + quoted(points) + " " + quoted(out)).status == kDone);
  CHECK(info(out)["payload"] == "packed");
  CHECK(info(out)["area"] == Approx(3600).epsilon(0.1));
  CHECK(folder.read("wall.qnv").size() < records / 4);
  CHECK(run("encode --displaced " + quoted(points) + " " + quoted(out)).status == kFailed);
}

TEST_CASE("encode: writes the same bytes for the same seed, and others for another") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall);
  const auto encode = [&](const std::string& options, const std::string& name) {
    const Run result = run("encode --vectors 3000 " + options + " " + quoted(world) + " " + quoted(folder.path(name)));
    INFO(result.output);
    REQUIRE(result.status == kDone);
    return folder.read(name);
  };
  CHECK(encode("--packed", "a.qnv") == encode("", "b.qnv"));
  const std::string records = encode("--records --seed 7", "c.qnv");
  CHECK(records == encode("--records --seed 7", "d.qnv"));
  CHECK(records != encode("--records --seed 8", "e.qnv"));
  const nlohmann::json facts = info(folder.path("c.qnv"));
  CHECK(facts["payload"] == "records");
  CHECK(facts["vectors"] == facts["vectors_at_full_detail"]);
  CHECK(facts["vectors"] <= 3000);
}

TEST_CASE("encode: keeps --max-bytes, or reports that it cannot") {
  const ScratchFolder folder;
  const std::string world = folder.write("ball.wrl", kBall), out = folder.path("ball.qnv");
  for (const char* payload : {"--packed", "--records"})
    for (const std::size_t most : {2000, 40000}) {
      const Run result = run("encode " + std::string(payload) + " --max-bytes " + std::to_string(most) + " " +
                             quoted(world) + " " + quoted(out));
      INFO(payload << " " << result.output);
      REQUIRE(result.status == kDone);
      CHECK(folder.read("ball.qnv").size() <= most);
      CHECK(folder.read("ball.qnv").size() > most / 2);
      CHECK(info(out)["damaged_chunks"] == 0);
    }
  const std::string before = folder.read("ball.qnv");
  for (const char* payload : {"--packed", "--records"}) {
    const Run result = run("encode " + std::string(payload) + " --max-bytes 100 " + quoted(world) + " " + quoted(out));
    INFO(result.output);
    CHECK(result.status == kFailed);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
  }
  CHECK(folder.read("ball.qnv") == before);
}

TEST_CASE("encode: encodes volumes with and without a header, and their isosurfaces") {
  const ScratchFolder folder;
  const std::string raw = folder.write("ball.raw", raw_ball()), out = folder.path("ball.qnv");
  const std::string how = " --dims 32x32x32 --type u8 --spacing 0.5,0.5,0.5 ";
  REQUIRE(run("encode --fraction 0.01" + how + quoted(raw) + " " + quoted(out)).status == kDone);
  nlohmann::json facts = info(out);
  CHECK(facts["kind"] == "volume");
  CHECK(facts["payload"] == "records");
  CHECK(facts["vectors"] == 328);  // round(0.01 * 32768)
  const Run octree = run("encode --method octree" + how + quoted(raw) + " " + quoted(folder.path("o.qnv")));
  CHECK(octree.status == kFailed);
  CHECK(octree.output.find("--method octree applies to surfaces and points only") != std::string::npos);
  const Run tight = run("encode --max-bytes 100" + how + quoted(raw) + " " + quoted(folder.path("t.qnv")));
  CHECK(tight.status == kFailed);
  REQUIRE(run("encode --max-bytes 2000" + how + quoted(raw) + " " + quoted(folder.path("t.qnv"))).status == kDone);
  CHECK(folder.read("t.qnv").size() <= 2000);
  const Run exported = run("export " + quoted(out) + " " + quoted(folder.path("ball.ply")));
  INFO(exported.output);
  CHECK(exported.status == kDone);
  CHECK(folder.read("ball.ply").find("element vertex 328") != std::string::npos);
  CHECK(facts["spacing"] == 0.5);
  REQUIRE(run("encode --vectors 1000" + how + quoted(raw) + " " + quoted(out)).status == kDone);
  CHECK(info(out)["vectors"] == 1000);
  // 200 - 200 r^2 / 196 = 100 at r = 7 sqrt(2) voxels of 0.5.
  REQUIRE(run("encode --isovalue 100" + how + quoted(raw) + " " + quoted(out)).status == kDone);
  facts = info(out);
  CHECK(facts["kind"] == "surface");
  CHECK(facts["payload"] == "displaced");
  CHECK(facts["area"] == Approx(4 * 3.14159265 * 24.5).epsilon(0.03));
  CHECK(facts["metadata"]["isovalue"] == "100");
  const Run none = run("encode --isovalue 1000" + how + quoted(raw) + " " + quoted(out));
  CHECK(none.status == kFailed);
  CHECK(none.output.find("no surface") != std::string::npos);
  const nlohmann::json volume = nlohmann::json::parse(run("info --json" + how + quoted(raw)).output);
  CHECK(volume["dimensions"] == nlohmann::json({32, 32, 32}));
  CHECK(volume["values"] == nlohmann::json({0.0, 200.0}));
  CHECK(volume["type_of_voxels"] == "u8");
  CHECK(run("encode " + quoted(raw) + " " + quoted(out)).output.find("--dims") != std::string::npos);
}

TEST_CASE("encode, info and export: report wrong usage in one line with status 2") {
  for (const char* arguments : {"encode a.wrl",
                                "encode a.wrl b.qnv c.qnv",
                                "encode a.wrl b.wrl",
                                "encode --vectors 0 a.wrl b.qnv",
                                "encode --vectors many a.wrl b.qnv",
                                "encode --fraction 2 a.wrl b.qnv",
                                "encode --fraction 0 a.wrl b.qnv",
                                "encode --vectors 5 --max-bytes 5 a.wrl b.qnv",
                                "encode --packed --records a.wrl b.qnv",
                                "encode --exact=7 a.wrl b.qnv",
                                "encode --exact=many a.wrl b.qnv",
                                "encode --exact --packed a.wrl b.qnv",
                                "encode --exact --max-bytes 5k a.wrl b.qnv",
                                "encode --exact --outlines a.wrl b.qnv",
                                "encode --isovalue nan a.raw b.qnv",
                                "encode --dims 1x2 a.raw b.qnv",
                                "encode --type u12 a.raw b.qnv",
                                "encode --spacing 1,0,1 a.raw b.qnv",
                                "encode --seed x a.wrl b.qnv",
                                "export a.qnv",
                                "export a.qnv b.nothing",
                                "export --vrml97 a.qnv b.spz",
                                "info",
                                "info a b"}) {
    const Run result = run(arguments);
    INFO(arguments << "\n" << result.output);
    CHECK(result.status == kUsage);
    CHECK(result.output.starts_with("ghostspace: "));
  }
  CHECK(run("export a.qnv b.nothing").output.find(".3dgs.ply") != std::string::npos);
}

TEST_CASE("encode: cancels every kind of work on an interrupt") {
  const ScratchFolder folder;
  EncodeCommand options;
  for (const std::string& file : {folder.write("ball.wrl", kBall), folder.write("ball.raw", raw_ball()),
                                  folder.write("p.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n")}) {
    options.files = {file, folder.path("out.qnv")};
    if (file.ends_with(".raw")) options.raw.dimensions = {32, 32, 32};
    for (const auto isovalue : {std::optional<double>(), std::optional<double>(100)}) {
      if (isovalue && !file.ends_with(".raw")) continue;
      options.isovalue = isovalue;
      const auto input = open_input(options, file);
      REQUIRE(input);
      ProgressBar progress;
      CHECK_FALSE(progress.cancelled());
      REQUIRE(raise(SIGINT) == 0);
      while (!progress.cancelled()) std::this_thread::yield();
      CHECK(std::holds_alternative<gs::qnv::EncodeError>(encode_input(options, *input, progress)));
    }
    options.raw = {};
    options.isovalue.reset();
  }
}
