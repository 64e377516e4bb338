// Tests of geometries one metre large and thousands of kilometres from the origin.
#include "app/encode/surface_triangles.h"
#include "app/formats/export/export.h"
#include "app/formats/mesh/points.h"
#include "app/formats/splats/splats.h"
#include "app/formats/volume/volume.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/gradients.h"
#include "render/scene/render_list.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/scratch_folder.h"
#include "tests/geometries.h"
#include "vrml/syntax/parser.h"

#include <nlohmann/json.hpp>

namespace gs::app::formats_far_test {
namespace {

using namespace gs::test;

const glm::dvec3 kFarPlace{4'500'000.25, -4'500'000.5, 3'200'000.125};

/// Returns `count` positions within half a metre of `kFarPlace`.
std::vector<glm::dvec3> far_places(std::size_t count) {
  std::vector<glm::dvec3> places;
  const Splats near = sphere(count, 0.5f);
  for (const glm::vec3& p : near.positions) places.push_back(kFarPlace + glm::dvec3(p));
  return places;
}

/// Returns the largest distance between the geometry's positions and given positions in the same order.
double farthest(const Splats& geometry, const std::vector<glm::dvec3>& places, const glm::dvec3& axes = glm::dvec3(1)) {
  REQUIRE(geometry.size() == places.size());
  double most = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const glm::dvec3 off = geometry.description.origin + glm::dvec3(geometry.positions[i]) - places[i] * axes;
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(off[k]));
  }
  return most;
}

std::string text_of(const glm::dvec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "%.9f %.9f %.9f", p.x, p.y, p.z);
  return text;
}

Bytes far_points(const std::vector<glm::dvec3>& places) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(places.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\n"
                     "property float ny\nproperty float nz\nproperty float area\nend_header\n";
  for (const glm::dvec3& p : places) text += text_of(p) + " 0 0 1 0.01\n";
  return bytes_of(text);
}

Bytes exported(const qnv::Geometry& geometry, Exported (*write)(const qnv::Geometry&, const ExportOptions&),
               const ExportOptions& options = {}) {
  auto result = write(geometry, options);
  REQUIRE(std::holds_alternative<Bytes>(result));
  return std::move(std::get<Bytes>(result));
}

constexpr double kMicrometre = 1e-6;

TEST_CASE("reads distant points without loss, from text and binary files") {
  const auto places = far_places(200);
  const Splats geometry = vectors_of(import_points_ply, far_points(places));
  CHECK(farthest(geometry, places) < 0.1 * kMicrometre);
  CHECK(geometry.description.box.size().x < 1.1f);
  std::string xyz;
  for (const glm::dvec3& p : places) xyz += text_of(p) + " 0 0 1\n";
  CHECK(farthest(vectors_of(import_points_xyz, bytes_of(xyz)), places) < 0.1 * kMicrometre);
  // Points around 0 have no origin.
  CHECK(vectors_of(import_points_xyz, bytes_of("1 2 3 0 0 1\n2 3 5 0 0 1\n-4 1 1 0 0 1\n")).description.origin ==
        glm::dvec3(0));
}

TEST_CASE("writes distant points as they were read") {
  const auto places = far_places(200);
  const Splats geometry = vectors_of(import_points_ply, far_points(places));
  CHECK(farthest(vectors_of(import_points_ply, exported(geometry, export_points_ply)), places) < 0.1 * kMicrometre);
  CHECK(farthest(vectors_of(import_splats_ply, exported(geometry, export_splats_ply)), places) < 0.1 * kMicrometre);
  // glTF has doubles only in its text.
  const Bytes glb = exported(geometry, export_glb);
  const std::string text = string_of(glb);
  const std::size_t at = text.find("\"translation\":[");
  REQUIRE(at != std::string::npos);
  const auto translation = nlohmann::json::parse(text.substr(at + 14, text.find(']', at) - at - 13));
  for (int k = 0; k < 3; ++k)
    CHECK(translation[static_cast<std::size_t>(k)].get<double>() == geometry.description.origin[k]);
  // VRML97 has float32 and a Transform.
  const std::string world = string_of(exported(geometry, export_vrml97_points));
  CHECK(world.find("translation 4500000") != std::string::npos);
  CHECK(world.find("point [\n450") == std::string::npos);
  // 24 bits per coordinate are too few.
  CHECK(std::holds_alternative<std::string>(export_spz(geometry, {})));
}

TEST_CASE("keeps the positions of vectors in a stream of records") {
  const auto places = far_places(300);
  const Splats geometry = vectors_of(import_points_ply, far_points(places));
  const auto made = gs::qnv::encode_vectors(geometry, {});
  REQUIRE(std::holds_alternative<gs::qnv::EncodedStream>(made));
  gs::qnv::StreamDecoder decoder;
  REQUIRE(decoder.push(std::get<gs::qnv::EncodedStream>(made).bytes));
  decoder.finish();
  const auto read = content_of<Splats>(decoder.geometry());
  REQUIRE(read.size() == places.size());
  double most = 0;  // largest distance of a vector from its nearest source
  for (const glm::vec3& p : read.positions) {
    double nearest = 1;
    for (const glm::dvec3& q : places) {
      const glm::dvec3 off = read.description.origin + glm::dvec3(p) - q;
      nearest = std::min(nearest, std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}));
    }
    most = std::max(most, nearest);
  }
  CHECK(most < 0.6e-3);  // half a step of a record in a box of a metre: 1/2048
}

TEST_CASE("encodes distant triangles relative to an origin, and restores their positions") {
  gs::vrml::SceneGraph scene("far.wrl");
  Diagnostics diagnostics;
  (void)gs::vrml::parse(
      "#VRML V2.0 utf8\nTransform { translation 4500000 -4500000 3200000 children Shape { geometry Box { size 1 0.3 "
      "0.01 } } }",
      scene, diagnostics);
  gs::render::MeshCache meshes;
  const gs::render::RenderList list = gs::render::collect(scene, {}, meshes);
  const SurfaceSummary summary = summarize_surface(list);
  const glm::dvec3 middle(4'500'000, -4'500'000, 3'200'000);
  const glm::dvec3 off = summary.box.upper - summary.box.lower - glm::dvec3(1.0f, 0.3f, 0.01f);
  CHECK(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) < 1e-8);
  gs::qnv::EncodeOptions options;
  options.origin = gs::qnv::local_origin(summary.box);
  CHECK(options.origin == middle);
  options.vectors = 500;
  Box box;
  const gs::qnv::TriangleSource source = [&](const gs::qnv::TriangleSink& sink) {
    return for_each_triangle(
        list,
        [&](std::span<const gs::qnv::Triangle> triangles) {
          for (const gs::qnv::Triangle& t : triangles)
            for (const glm::vec3& p : t.positions) box.add(p);
          return sink(triangles);
        },
        options.origin);
  };
  for (const auto encode : {gs::qnv::encode_surface, gs::qnv::encode_displaced}) {
    const auto made = encode(source, options, nullptr);
    REQUIRE(std::holds_alternative<gs::qnv::EncodedStream>(made));
    gs::qnv::StreamDecoder decoder;
    REQUIRE(decoder.push(std::get<gs::qnv::EncodedStream>(made).bytes));
    decoder.finish();
    const qnv::Geometry geometry = decoder.geometry();
    CHECK(geometry.description().origin == middle);
    REQUIRE(geometry.size() > 7);
    // A plate of a centimetre stays one.
    Box places;
    for (const glm::vec3& p : qnv::VectorView(geometry).positions) places.add(p);
    CHECK(places.size().z < 0.02f);
    CHECK(places.size().x > 0.9f);
  }
  CHECK(box.size().z == 0.01f);
}

TEST_CASE("reads the position of a distant volume in double precision") {
  std::string vti =
      "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 3 0 3 0 3\" Origin=\"" + text_of(kFarPlace) +
      "\" Spacing=\"0.01 0.01 0.01\"><Piece Extent=\"0 3 0 3 0 3\"><PointData Scalars=\"v\"><DataArray type=\"UInt8\" "
      "Name=\"v\" format=\"ascii\">";
  for (int i = 0; i < 64; ++i) vti += std::to_string(i * i % 97) + " ";
  vti += "</DataArray></PointData></Piece></ImageData></VTKFile>";
  const ScratchFolder folder;
  const auto opened = open_volume(folder.write("far.vti", vti));
  REQUIRE(std::holds_alternative<gs::qnv::VolumeSource>(opened));
  const auto& source = std::get<gs::qnv::VolumeSource>(opened);
  const glm::dvec3 first = source.layout.base + source.layout.origin - kFarPlace;
  CHECK(std::max({std::abs(first.x), std::abs(first.y), std::abs(first.z)}) < kMicrometre);
  const auto found = gs::qnv::gradient_vectors(source, {});
  REQUIRE(std::holds_alternative<qnv::Volume>(found));
  const auto& geometry = std::get<qnv::Volume>(found);
  CHECK(geometry.description.origin == source.layout.base);
  // On the lattice within a thousandth of a voxel.
  for (const glm::vec3& p : geometry.positions) {
    const glm::dvec3 at = (geometry.description.origin + glm::dvec3(p) - kFarPlace) / 0.01;
    for (int k = 0; k < 3; ++k) REQUIRE_EACH(std::abs(at[k] - std::round(at[k])) < 1e-3);
  }
}

}  // namespace
}  // namespace gs::app::formats_far_test
