// Tests of files of vectors as worlds, and of QNV nodes.
#include "app/formats/content_types.h"
#include "app/loading/world_loader.h"
#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/records/record.h"
#include "qnv/codecs/shared/encode_options.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/volume_files.h"
#include "tests/app/worlds.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/records/record_fields.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <string>

using namespace gs;
using namespace gs::app;
using test::string_of;

namespace {

std::string ball_stream(std::size_t count) {
  qnv::EncodeOptions options;
  options.metadata = {{"title", "a ball"}};
  auto encoded = qnv::encode_vectors(test::sphere(count), options);
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  return string_of(std::get<qnv::EncodedStream>(encoded).bytes);
}

double area(const qnv::VectorView& geometry) {
  double sum = 0;
  for (const float weight : geometry.weights) sum += weight;
  return sum;
}

// Returns the only geometry of a world.
const qnv::Geometry& only_geometry(const LoadedWorld& world) {
  INFO(said(world));
  REQUIRE(world.geometries.size() == 1);
  CHECK(world.geometries.begin()->first->type->name == "QNV");
  return *world.geometries.begin()->second;
}

// Returns the two numbers of a QNV node's `vectors`.
std::string words_of(const qnv::RecordFields& fields) {
  const std::uint64_t bits = qnv::join_fields(fields);
  return std::to_string(static_cast<std::int32_t>(bits & 0xffffffff)) + " " +
         std::to_string(static_cast<std::int32_t>(bits >> 32)) + " ";
}

}  // namespace

TEST_CASE("opens a QNV stream as a shape: whole, truncated and compressed") {
  const ScratchFolder folder;
  const std::string bytes = ball_stream(3000), file = folder.write("ball.qnv", bytes);
  const LoadedWorld world = load_world(file);
  const qnv::Geometry& geometry = only_geometry(world);
  CHECK(geometry.size() == 3000);
  CHECK(area(geometry) == Approx(12.566370614).epsilon(0.001));
  CHECK(world.title == "a ball");
  CHECK(world.diagnostics.errors() + world.diagnostics.warnings() == 0);
  REQUIRE(world.scene->roots().size() == 2);
  const vrml::NodeId qnv = world.scene->get<vrml::SFNode>(world.scene->roots()[1], "geometry");
  CHECK(world.scene->get<vrml::MFString>(qnv, "url")[0].view() == "ball.qnv");
  CHECK(world.scene->get<vrml::SFVec3f>(qnv, "bboxSize").x == Approx(2).epsilon(0.01));

  const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
  const std::string packed = string_of(test::gzipped(std::vector<std::byte>(first, first + bytes.size())));
  CHECK(only_geometry(load_world(folder.write("packed.qnv", packed))).size() == 3000);

  // Every prefix is a coarser ball with the same area, without errors.
  std::size_t before = 0;
  LoadOptions cut;
  for (cut.max_bytes = 3000; cut.max_bytes < bytes.size(); cut.max_bytes += 1500) {
    const LoadedWorld part = load_world(file, cut);
    INFO(cut.max_bytes << " " << said(part));
    CHECK(part.diagnostics.errors() + part.diagnostics.warnings() == 0);
    CHECK_FALSE(part.truncated);
    CHECK(only_geometry(part).size() >= before);
    CHECK(area(only_geometry(part)) == Approx(12.566370614).epsilon(0.01));
    before = only_geometry(part).size();
  }
  CHECK(before > 1500);
  // A truncated file is reported; one without a header is refused.
  const LoadedWorld early = load_world(folder.write("early.qnv", bytes.substr(0, bytes.size() / 2)));
  CHECK(early.diagnostics.errors() == 0);
  CHECK(said(early).find("early.qnv: warning: byte ") != std::string::npos);
  CHECK(only_geometry(early).size() > 0);
  const LoadedWorld none = load_world(folder.write("none.qnv", bytes.substr(0, 50)));
  CHECK_FALSE(none.scene);
  CHECK(none.diagnostics.errors() == 1);
}

TEST_CASE("loses one chunk to damage in a stream, and reports its position") {
  const ScratchFolder folder;
  std::string bytes = ball_stream(3000);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  const LoadedWorld world = load_world(folder.write("ball.qnv", bytes));
  const qnv::Geometry& geometry = only_geometry(world);
  CHECK(geometry.size() > 1000);
  CHECK(geometry.size() < 3000);
  CHECK(said(world).find("a chunk is damaged") != std::string::npos);
  CHECK(world.diagnostics.errors() == 0);
}

TEST_CASE("loads vectors of QNV nodes in the main scene, in Inlines and in PROTO instances") {
  const ScratchFolder folder;
  folder.write("ball.qnv", ball_stream(500));
  folder.write("inner.wrl", "#VRML V2.0 utf8\nShape { geometry QNV { url [ \"missing.qnv\" \"ball.qnv\" ] } }\n");
  const LoadedWorld world = load_world(folder.write(
      "world.wrl",
      "#VRML V2.0 utf8\nPROTO Ball [ field MFString from [] ] { Shape { geometry QNV { url IS from } } }\n"
      "Shape { geometry DEF A QNV { url \"ball.qnv\" } }\nBall { from \"ball.qnv\" }\nInline { url \"inner.wrl\" }\n"
      "Inline { url \"ball.qnv\" }\nShape { geometry QNV { url \"nowhere.qnv\" } }\n"
      "Shape { geometry QNV { url \"ball.qnv\" transfer [ 0 1 0 0 0  1 0 0 1 1 ] } }\n"));
  INFO(said(world));
  CHECK(world.geometries.size() == 5);
  std::size_t own = 0;
  for (const auto& [node, geometry] : world.geometries) {
    CHECK(geometry->size() == 500);
    own += geometry->description().transfer.size();
  }
  CHECK(own == 2);
  CHECK(world.diagnostics.errors() == 0);
  CHECK(world.diagnostics.warnings() == 1);
  CHECK(said(world).find("QNV: cannot find 'nowhere.qnv'") != std::string::npos);
}

TEST_CASE("replaces the fallback PROTO of a QNV node by its stream") {
  const ScratchFolder folder;
  folder.write("ball.qnv", ball_stream(500));
  const std::string text =
      "#VRML V2.0 utf8\nPROTO QNV [ exposedField MFString url [] ] { PointSet { } }\nShape { geometry QNV { url "
      "\"ball.qnv\" } }\n";
  const LoadedWorld world = load_world(folder.write("world.wrl", text));
  CHECK(only_geometry(world).size() == 500);
  const vrml::NodeId geometry = world.scene->get<vrml::SFNode>(world.scene->roots()[0], "geometry");
  CHECK(&world.scene->node(world.scene->resolve(geometry)) == world.geometries.begin()->first);
  // Without the stream, the fallback remains.
  const ScratchFolder other;
  const LoadedWorld fallback = load_world(other.write("world.wrl", text));
  CHECK(fallback.geometries.empty());
  const vrml::NodeId kept = fallback.scene->get<vrml::SFNode>(fallback.scene->roots()[0], "geometry");
  CHECK(fallback.scene->node(fallback.scene->resolve(kept)).type->name == "PointSet");
}

TEST_CASE("places records inside a QNV node in its bounding box") {
  const ScratchFolder folder;
  const std::string words = words_of({0, 512, 1023, 16, 0, 32767, 255}) + words_of({1023, 0, 0, 0, 0, 1, 0});
  const auto node = [&](const std::string& fields) {
    return load_world(folder.write(
        "world.wrl", "#VRML V2.0 utf8\nShape { geometry QNV { vectors [ " + words + "] " + fields + " } }\n"));
  };
  const LoadedWorld world = node("bboxCenter 1 2 3 bboxSize 2 4 8 transfer [ 0 1 0 0 1  1 0 0 1 1 ]");
  const auto geometry = content_of<qnv::Splats>(only_geometry(world));
  REQUIRE(geometry.size() == 2);
  CHECK(geometry.positions[0].x == Approx(0).margin(0.002));
  CHECK(geometry.positions[0].y == Approx(2).margin(0.004));
  CHECK(geometry.positions[0].z == Approx(7).margin(0.008));
  CHECK(geometry.weights[0] == Approx(32));  // the largest side: 4 by 8
  CHECK(geometry.weights[1] == Approx(32.0 / 32767));
  REQUIRE(geometry.colors.size() == 2);
  CHECK(geometry.colors[0] == qnv::Rgb8{0, 0, 255});
  CHECK(geometry.colors[1] == qnv::Rgb8{255, 0, 0});
  const LoadedWorld volume = node("bboxSize 1 1 1 profile \"VOLUME\"");
  const auto vectors = content_of<qnv::Volume>(only_geometry(volume));
  CHECK(vectors.classes == std::vector<std::uint8_t>{255, 0});
  CHECK(vectors.weights[0] == Approx(1));
  for (const char* bad : {"", "bboxSize 0 0 0", "bboxSize 1e30 1e30 1e30", "bboxSize -1 2 2"}) {
    const LoadedWorld none = node(bad);
    CHECK(none.geometries.empty());
    CHECK(said(none).find("expected bboxCenter and bboxSize") != std::string::npos);
  }
}

TEST_CASE("opens splats, points and volumes as shapes of vectors") {
  const ScratchFolder folder;
  const LoadedWorld points = load_world(folder.write("p.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n1 1 0 0 0 1\n"));
  CHECK(only_geometry(points).size() == 4);
  const LoadedWorld ply =
      load_world(folder.write("p.ply",
                              "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
                              "float z\nproperty float nx\n"
                              "property float ny\nproperty float nz\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n"));
  CHECK(only_geometry(ply).size() == 2);
  std::string voxels(4 * 4 * 4, '\0');
  voxels[21] = '\x64';
  const LoadedWorld volume = load_world(
      folder.write("v.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n" + voxels));
  const auto gradients = content_of<qnv::Volume>(only_geometry(volume));
  CHECK(gradients.size() == 6);  // round(0.09 * 64): the neighbours of the voxel
  CHECK(volume.scene
            ->get<vrml::SFString>(
                volume.scene->get<vrml::SFNode>(volume.scene->roots()[volume.scene->roots().size() - 1], "geometry"),
                "profile")
            .view() == "VOLUME");
  LoadOptions cut;
  cut.max_bytes = 100;
  CHECK(said(load_world(folder.path("v.nrrd"), cut)).find("cannot be read in part") != std::string::npos);
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"bad.spz", "NGSPxxxx"},
                                    {"bad.splat", "12"},
                                    {"bad.ksplat", ""},
                                    {"bad.xyz", "a b c"},
                                    {"bad.nii", "xx"}}) {
    const LoadedWorld bad = load_world(folder.write(name, bytes));
    INFO(name << "\n" << said(bad));
    CHECK_FALSE(bad.scene);
    CHECK(bad.diagnostics.errors() == 1);
    CHECK(said(bad).starts_with(folder.path(name) + ": error: "));
  }
}

TEST_CASE("opens the worlds of the program without messages") {
  const std::filesystem::path folder = std::filesystem::path(GHOSTSPACE_TESTS).parent_path() / "assets/worlds";
  int worlds = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".wrl" && entry.path().extension() != ".qnv") continue;
    const LoadedWorld world = load_world(entry.path().string());
    INFO(entry.path());
    CHECK(world.scene);
    CHECK(said(world).empty());
    ++worlds;
  }
  CHECK(worlds >= 4);
}

TEST_CASE("shows translucent splats as Gaussians and opaque discs as a surface") {
  const ScratchFolder folder;
  std::string splat;
  for (const float f : {1.0f, 2.0f, 3.0f, 0.5f, 0.25f, 0.001f}) splat.append(reinterpret_cast<const char*>(&f), 4);
  splat += "\x10\x20\x30\x40\xff\x80\x80\x80";
  const LoadedWorld world = load_world(folder.write("glass.splat", splat));
  CHECK(said(world).empty());
  CHECK(content_of<qnv::Gaussians>(only_geometry(world)).opacities == std::vector<float>{64.0f / 255});
  splat[27] = '\xff';
  CHECK(content_of<qnv::Splats>(only_geometry(load_world(folder.write("opaque.splat", splat)))).size() == 1);
}
