#include "app/formats/export/export.h"
#include "app/formats/gltf/gltf.h"
#include "app/formats/mesh/points.h"
#include "app/formats/splats/splats.h"
#include "vrml/syntax/parser.h"

#include "tests/app/geometry_shapes.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace {

using namespace gs;
using namespace gs::test;
using namespace gs::app;
using gs::qnv::Kind;
using gs::qnv::Rgb8;
using gs::vrml::Color;

Bytes written(const qnv::Geometry& geometry, Exported (*write)(const qnv::Geometry&, const ExportOptions&),
              const ExportOptions& options = {}) {
  auto result = write(geometry, options);
  if (const auto* problem = std::get_if<std::string>(&result)) {
    FAIL("not exported: " << *problem);
    return {};
  }
  return std::move(std::get<Bytes>(result));
}

struct Tolerance {
  float position, normal, area;  // units; dot product below 1; logarithm
  int color;
};

void check_same(const Splats& a, const Splats& b, const Tolerance& tolerance) {
  REQUIRE(a.size() == b.size());
  float position = 0, normal = 0, area = 0;
  int color = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < 3; ++k) position = std::max(position, std::abs(a.positions[i][k] - b.positions[i][k]));
    normal = std::max(normal, 1 - dot(a.normals[i], b.normals[i]));
    area = std::max(area, std::abs(std::log(a.weights[i] / b.weights[i])));
    color = std::max({color, std::abs(a.colors[i].r - b.colors[i].r), std::abs(a.colors[i].g - b.colors[i].g),
                      std::abs(a.colors[i].b - b.colors[i].b)});
  }
  CHECK(position <= tolerance.position);
  CHECK(normal <= tolerance.normal);
  CHECK(area <= tolerance.area);
  CHECK(color <= tolerance.color);
  CHECK(b.description.total == Approx(a.description.total).epsilon(0.07));
}

/// Returns a sphere off the origin, with normals to both poles.
Splats model() {
  Splats geometry = sphere(999, 2, {3, -1, 0.5f});
  geometry.normals[0] = {0, 0, 1};
  geometry.normals[1] = {0, 0, -1};
  geometry.normals[2] = glm::vec3(1e-5f, 0, -1);
  return geometry;
}

qnv::Volume volume_vectors() {
  qnv::Volume geometry;
  static_cast<qnv::VectorArrays&>(geometry) = sphere(10);
  geometry.colors.clear();
  geometry.description.spacing = 0.25f;
  geometry.description.transfer = {{0.0f, {0, 0, 0}, 0.0f}, {0.5f, {255, 0, 0}, 0.5f}, {1.0f, {255, 255, 255}, 1.0f}};
  for (int i = 0; i < 10; ++i) geometry.classes.push_back(static_cast<std::uint8_t>(i * 28));  // 0..252
  return geometry;
}

TEST_CASE("lists each export format with its extension") {
  CHECK(export_format_of("a.ply")->name == "ply");
  CHECK(export_format_of("dir.spz/a.3DGS.PLY")->name == "3dgs-ply");
  CHECK(export_format_of("a.glb")->name == "glb");
  CHECK(export_format_of("a.spz")->name == "spz");
  CHECK(export_format_of("a.v3.spz")->name == "spz3");
  CHECK(export_format_of("a.wrl")->name == "vrml97");
  CHECK(export_format_of("a.patches.wrl")->name == "vrml97-patches");
  CHECK(export_format_of("a.exe") == nullptr);
  CHECK(export_format_of("") == nullptr);
  std::set<std::string_view> names, extensions;
  for (const ExportFormat& format : export_formats()) {
    CHECK(names.insert(format.name).second);
    CHECK(extensions.insert(format.extension).second);
  }
}

TEST_CASE("restores PLY points bit for bit") {
  const Splats geometry = model();
  const Bytes bytes = written(geometry, export_points_ply);
  CHECK(is_points_ply(bytes));
  CHECK(bytes.size() - string_of(bytes).find("end_header\n") - 11 == 999 * 31);
  const Splats back = vectors_of(import_points_ply, bytes);
  CHECK(back.positions == geometry.positions);
  CHECK(back.weights == geometry.weights);
  CHECK(back.colors == geometry.colors);
  check_same(geometry, back, {0, 1e-6f, 0, 0});
  Bytes short_one(bytes.begin(), bytes.begin() + 1200);
  check_hostile(import_points_ply, short_one, 31);
}

TEST_CASE("writes vectors with triangles as a PLY mesh") {
  qnv::IndexedMesh geometry;
  static_cast<qnv::VectorArrays&>(geometry) = sphere(4);
  geometry.triangles = {0, 1, 2, 2, 1, 3};
  const Bytes bytes = written(geometry, export_points_ply);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  CHECK(text.find("element face 2\nproperty list uchar uint vertex_indices\nend_header\n") != std::string::npos);
  REQUIRE(bytes.size() > 26);
  const auto at = [&](std::size_t from_end) { return std::to_integer<int>(bytes[bytes.size() - from_end]); };
  CHECK(std::vector<int>{at(26), at(25), at(21), at(17), at(13), at(12), at(8), at(4)} ==
        std::vector<int>{3, 0, 1, 2, 3, 2, 1, 3});
}

TEST_CASE("restores 3DGS PLY") {
  const Splats geometry = model();
  const Bytes bytes = written(geometry, export_splats_ply);
  CHECK(is_splats_ply(bytes));
  CHECK_FALSE(is_splats_compressed_ply(bytes));
  CHECK(bytes.size() - string_of(bytes).find("end_header\n") - 11 == 999 * 68);
  const Splats back = vectors_of(import_splats_ply, bytes);
  check_same(geometry, back, {0, 1e-6f, 1e-5f, 0});
  CHECK(metadata(back, "splats not discs").empty());
}

TEST_CASE("restores SPZ within its quantisation steps") {
  const Splats geometry = model();
  for (auto* write : {export_spz, export_spz3}) {
    const Bytes bytes = written(geometry, write);
    CHECK(is_splats_spz(bytes) == (write == export_spz));
    const Splats back = vectors_of(import_splats_spz, bytes);
    // The largest coordinate is 5: 20 bits after the point. Two scales to 1/32 in their logarithm, quaternions to 1/723
    // per component, colours to 0.282 / 38.25 of 255 plus rounding.
    check_same(geometry, back, {0.51f / (1 << 20), 2e-5f, 0.0626f, 2});
    CHECK(metadata(back, "splats not discs").empty());
    check_hostile(import_splats_spz, bytes, 211);
  }
  CHECK(written(geometry, export_spz).size() < 999 * 20);
  CHECK(std::holds_alternative<std::string>(export_spz(Splats(), {})));
  CHECK(std::holds_alternative<std::string>(export_spz3(Splats(), {})));
}

TEST_CASE("adapts the fixed point of SPZ to the coordinates") {
  for (const float size : {1e-3f, 1.0f, 1e5f, 1e9f}) {
    const Splats geometry = sphere(50, size);
    const Splats back = vectors_of(import_splats_spz, written(geometry, export_spz));
    REQUIRE(back.size() == 50);
    // Up to 2^23, the largest coordinate determines the precision. Larger coordinates exceed the format.
    if (size < 1e6f) CHECK(length(back.positions[7] - geometry.positions[7]) <= size * 3e-7f + 1e-7f);
  }
}

struct Glb {
  nlohmann::json document;
  Bytes binary;
};
Glb read_glb(const Bytes& bytes) {
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bytes.at(at), 4);
    return value;
  };
  REQUIRE(string_of(bytes).substr(0, 4) == "glTF");
  REQUIRE(word(4) == 2);
  REQUIRE(word(8) == bytes.size());
  REQUIRE(word(16) == 0x4e4f534a);
  const std::size_t length = word(12);
  REQUIRE(length % 4 == 0);
  Glb glb;
  glb.document = nlohmann::json::parse(string_of(bytes).substr(20, length));
  if (20 + length < bytes.size()) {
    REQUIRE(word(20 + length + 4) == 0x004e4942);
    REQUIRE(word(20 + length) % 4 == 0);
    glb.binary.assign(bytes.begin() + static_cast<std::ptrdiff_t>(28 + length), bytes.end());
    REQUIRE(glb.binary.size() == word(20 + length));
  }
  return glb;
}

TEST_CASE("writes GLB with KHR_gaussian_splatting") {
  const Splats geometry = model();
  const Bytes bytes = written(geometry, export_glb, {"b\xffll \"1\"", {}});
  const Glb glb = read_glb(bytes);
  const auto& document = glb.document;
  CHECK(document["extensionsUsed"] == nlohmann::json{"KHR_gaussian_splatting"});
  CHECK_FALSE(document.contains("extensionsRequired"));
  const auto& primitive = document["meshes"][0]["primitives"][0];
  CHECK(primitive["mode"] == 0);
  CHECK(primitive["extensions"]["KHR_gaussian_splatting"]["kernel"] == "ellipse");
  CHECK(primitive["extensions"]["KHR_gaussian_splatting"]["colorSpace"] == "srgb_rec709_display");
  CHECK(primitive["attributes"].size() == 6);
  CHECK(glb.binary.size() == 999 * 60);
  const auto floats = [&](const char* name, std::size_t width) {
    const auto& accessor = document["accessors"][primitive["attributes"][name].get<std::size_t>()];
    REQUIRE(accessor["componentType"] == 5126);
    REQUIRE(accessor["count"] == 999);
    const auto& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    REQUIRE(view["byteOffset"].get<std::size_t>() % 4 == 0);
    REQUIRE(view["byteLength"].get<std::size_t>() == 999 * width * 4);
    std::vector<float> values(999 * width);
    std::memcpy(values.data(), &glb.binary.at(view["byteOffset"].get<std::size_t>()), values.size() * 4);
    return values;
  };
  const auto positions = floats("POSITION", 3), rotations = floats("KHR_gaussian_splatting:ROTATION", 4);
  const auto scales = floats("KHR_gaussian_splatting:SCALE", 3),
             opacities = floats("KHR_gaussian_splatting:OPACITY", 1);
  const auto dc = floats("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", 3);
  SplatModel splats;
  splats.axes = kFromRightUpBack;
  splats.resize(999);
  glm::vec3 least(1e9f), most(-1e9f);
  for (std::size_t i = 0; i < 999; ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = 3 * i + static_cast<std::size_t>(k);
      splats.positions[i][k] = positions[at];
      splats.scales[i][k] = scales[at];
      splats.dc[i][k] = dc[at];
      least[k] = std::min(least[k], positions[at]);
      most[k] = std::max(most[k], positions[at]);
    }
    for (int k = 0; k < 4; ++k) splats.rotations[i][k] = rotations[4 * i + static_cast<std::size_t>(k)];
    splats.opacities[i] = opacities[i];
  }
  check_same(geometry, vectors_of_splats(splats), {0, 1e-6f, 1e-5f, 0});
  const auto& accessor = document["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
  for (int k = 0; k < 3; ++k) {
    CHECK(accessor["min"][static_cast<std::size_t>(k)].get<float>() == least[k]);
    CHECK(accessor["max"][static_cast<std::size_t>(k)].get<float>() == most[k]);
  }
}

TEST_CASE("shows the points of the GLB by its own glTF reader") {
  const Splats geometry = model();
  const Bytes bytes = written(geometry, export_glb);
  const Imported result = imported("glTF", bytes);
  CHECK(result.diagnostics.errors() == 0);
  CHECK(result.points() == geometry.positions);
  const Color color = result.colors()[300];
  CHECK(color.r == Approx(static_cast<float>(geometry.colors[300].r) / 255).margin(0.03));
  CHECK(color.b == Approx(200.0f / 255).margin(0.01));
  const Glb empty = read_glb(written(Splats(), export_glb));
  CHECK(empty.binary.empty());
  CHECK_FALSE(empty.document.contains("meshes"));
}

Imported parsed(const std::string& text) {
  Imported result;
  gs::vrml::parse(text, *result.scene, result.diagnostics);
  return result;
}

TEST_CASE("writes VRML97 points for any browser") {
  const Splats geometry = model();
  const std::string text = string_of(written(geometry, export_vrml97_points, {"a \"title\"\n\\", "ball.qnv"}));
  CHECK(text.starts_with("#VRML V2.0 utf8"));
  const Imported world = parsed(text);
  CHECK(world.messages().empty());
  const auto shapes = world.all("Shape");
  REQUIRE(shapes.size() == 1);
  const auto instance = world.scene->get<gs::vrml::SFNode>(shapes[0], "geometry");
  const auto points = world.scene->resolve_as(instance, gs::vrml::NodeKind::point_set);
  REQUIRE(points);
  CHECK(world.scene->get<gs::vrml::MFString>(instance, "url")[0] == "ball.qnv");
  CHECK(world.scene->get<gs::vrml::SFVec3f>(instance, "bboxSize").x == Approx(4).margin(0.02));
  const auto coordinates = world.scene->get<gs::vrml::SFNode>(points, "coord");
  const auto& array = world.scene->get<gs::vrml::MFVec3f>(coordinates, "point");
  REQUIRE(array.size() == geometry.size());
  CHECK(std::equal(array.begin(), array.end(), geometry.positions.begin()));
  const auto colors = world.scene->get<gs::vrml::SFNode>(points, "color");
  const auto& color = world.scene->get<gs::vrml::MFColor>(colors, "color");
  REQUIRE(color.size() == geometry.size());
  for (std::size_t i = 0; i < geometry.size(); ++i) REQUIRE(std::lround(color[i].g * 255) == geometry.colors[i].g);
}

TEST_CASE("writes shaded colours for points of one colour, which browsers do not light") {
  Splats geometry = sphere(100);
  geometry.colors.clear();
  geometry.color = {200, 200, 200};
  const Imported world = parsed(string_of(written(geometry, export_vrml97_points)));
  float least = 1, most = 0;
  const auto colors = world.all("Color");
  REQUIRE_FALSE(colors.empty());
  for (const Color& c : world.scene->get<gs::vrml::MFColor>(colors[0], "color")) {
    least = std::min(least, c.r);
    most = std::max(most, c.r);
  }
  CHECK(most == Approx(200.0f / 255).margin(0.05));
  CHECK(least < 0.4f);
}

TEST_CASE("writes VRML97 patches with the areas and sides of the splats") {
  const Splats geometry = model();
  const Imported world = parsed(string_of(written(geometry, export_vrml97_patches)));
  CHECK(world.messages().empty());
  const auto faces = world.scene->resolve_as(world.scene->get<gs::vrml::SFNode>(world.only("Shape"), "geometry"),
                                             gs::vrml::NodeKind::indexed_face_set);
  REQUIRE(faces);
  const auto& points = world.scene->get<gs::vrml::MFVec3f>(world.scene->get<gs::vrml::SFNode>(faces, "coord"), "point");
  const auto& index = world.scene->get<gs::vrml::MFInt32>(faces, "coordIndex");
  REQUIRE(points.size() == 4 * geometry.size());
  REQUIRE(index.size() == 5 * geometry.size());
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const glm::vec3 a = points[4 * i + 1] - points[4 * i], b = points[4 * i + 3] - points[4 * i];
    const glm::vec3 normal(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    REQUIRE(length(normal) == Approx(geometry.weights[i]).epsilon(1e-3));
    REQUIRE(dot(normal, geometry.normals[i]) == Approx(geometry.weights[i]).epsilon(1e-3));
    REQUIRE(length(points[4 * i] + points[4 * i + 2] - geometry.positions[i] * 2.0f) < 1e-5f);
    REQUIRE(index[5 * i + 3] == static_cast<std::int32_t>(4 * i + 3));
  }
}

TEST_CASE("exports volumes as balls in the colours of their transfer function") {
  const qnv::Volume geometry = volume_vectors();
  const Splats points = vectors_of(import_points_ply, written(geometry, export_points_ply));
  REQUIRE(points.size() == 10);
  CHECK(points.colors[9].r == 255);
  CHECK(points.colors[9].g == 249);  // class 252: between 0.5 and 1 by 0.9765
  CHECK(points.weights[0] == 0.0625f);
  CHECK(dot(points.normals[4], geometry.normals[4]) == Approx(-1));
  // The first splat is invisible.
  const Splats splats = vectors_of(import_splats_spz, written(geometry, export_spz));
  CHECK(splats.size() == 9);
  CHECK(metadata(splats, "splats not discs") == "9");
  for (auto* write : {export_vrml97_points, export_vrml97_patches})
    CHECK(parsed(string_of(written(geometry, write))).messages().empty());
}

TEST_CASE("leaves out vectors with invalid numbers in exports") {
  Splats geometry = sphere(6);
  geometry.positions[0].x = NAN;
  geometry.weights[1] = INFINITY;
  geometry.weights[2] = 0;
  geometry.normals[3].y = -INFINITY;
  CHECK(vectors_of(import_splats_ply, written(geometry, export_splats_ply)).size() == 2);
  CHECK(vectors_of(import_splats_spz, written(geometry, export_spz)).size() == 2);
  CHECK(vectors_of(import_points_ply, written(geometry, export_points_ply)).size() == 2);
  CHECK(read_glb(written(geometry, export_glb)).binary.size() == 120);
  for (const ExportFormat& format : export_formats()) {
    (void)format.write(geometry, {});
    (void)format.write(Splats(), {});
  }
  for (auto* write : {export_vrml97_points, export_vrml97_patches}) {
    CHECK(parsed(string_of(written(geometry, write))).messages().empty());
    CHECK(parsed(string_of(written(Splats(), write))).messages().empty());
  }
}

TEST_CASE("exports the PROTO that replaces the QNV node") {
  const Bytes file = file_bytes(std::filesystem::path(GHOSTSPACE_TESTS).parent_path() / "assets/protos/QNV.wrl");
  REQUIRE_FALSE(file.empty());
  const Imported world =
      parsed(string_of(file) + "Shape { geometry QNV { url \"a.qnv\" detail 2 bboxSize 1 2 3 vectors [ 1, 2 ] } }\n");
  CHECK(world.messages().empty());
  CHECK(world.scene->resolve_as(world.scene->get<gs::vrml::SFNode>(world.only("Shape"), "geometry"),
                                gs::vrml::NodeKind::point_set));
}

}  // namespace
