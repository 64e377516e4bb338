#include "app/formats/export/export.h"

#include "tests/app/formats_helpers.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

qnv::IndexedMesh square() {
  qnv::IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.weights.assign(4, 0.25f);
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  mesh.color = {255, 128, 0};
  return mesh;
}

std::string text_of_export(const Exported& exported) {
  REQUIRE(std::holds_alternative<Bytes>(exported));
  return string_of(std::get<Bytes>(exported));
}

}  // namespace

TEST_CASE("STL export: writes binary facets in world units") {
  qnv::IndexedMesh mesh = square();
  mesh.description.origin = {100, 0, 0};
  ExportOptions options;
  options.title = "solid part";
  const std::string stl = text_of_export(export_stl(qnv::Geometry(std::move(mesh)), options));
  REQUIRE(stl.size() == 84 + 2 * 50);
  CHECK(stl.starts_with("GhostSpace solid part"));
  float facet[12];
  std::memcpy(facet, stl.data() + 84, sizeof facet);
  CHECK(facet[2] == 1);  // normal
  CHECK(facet[3] == 100);
  CHECK(facet[6] == 101);
  CHECK(std::holds_alternative<std::string>(export_stl(qnv::Geometry())));
}

TEST_CASE("OBJ export: writes colours, normals, and a material with its texture beside the file") {
  qnv::IndexedMesh mesh = square();
  std::vector<CompanionFile> beside;
  ExportOptions options;
  options.name = "part";
  options.beside = &beside;
  std::string obj = text_of_export(export_obj(qnv::Geometry(mesh), options));
  CHECK(obj.find("mtllib part.mtl\n") != std::string::npos);
  CHECK(obj.find("f 1//1 2//2 3//3\n") != std::string::npos);
  REQUIRE(beside.size() == 1);
  CHECK(string_of(beside[0].bytes).find("Kd 1 0.5019608 0") != std::string::npos);
  mesh.colors = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {0, 0, 0}};
  obj = text_of_export(export_obj(qnv::Geometry(mesh)));
  CHECK(obj.find("v 1 0 0 0 1 0\n") != std::string::npos);
  CHECK(obj.find("mtllib") == std::string::npos);
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  auto picture = std::make_shared<qnv::SurfacePicture>();
  picture->bytes = bytes_of("\x89PNG");
  mesh.picture = picture;
  beside.clear();
  obj = text_of_export(export_obj(qnv::Geometry(mesh), options));
  CHECK(obj.find("vt 1 1\n") != std::string::npos);
  CHECK(obj.find("usemtl textured\nf 1/1/1 2/2/2 3/3/3\n") != std::string::npos);
  REQUIRE(beside.size() == 2);
  CHECK(beside[0].name == "part.png");
  CHECK(string_of(beside[1].bytes).find("map_Kd part.png\n") != std::string::npos);
  CHECK(std::holds_alternative<std::string>(export_obj(qnv::Geometry())));
}

TEST_CASE("export formats report the properties that they do not keep") {
  qnv::IndexedMesh mesh = square();
  const auto losses = [&](const char* path) {
    std::string text;
    for (const std::string& loss : export_losses(*export_format_of(path), qnv::Geometry(mesh))) text += loss + "\n";
    return text;
  };
  CHECK(losses("a.glb").empty());
  CHECK(losses("a.ply").empty());
  CHECK(losses("a.obj").empty());
  CHECK(losses("a.stl").find("colours are left out") != std::string::npos);
  CHECK(losses("a.spz").find("2 triangles become splats") != std::string::npos);
  mesh.texture_coordinates.resize(4);
  mesh.picture = std::make_shared<qnv::SurfacePicture>();
  mesh.description.metadata = {{"specular", "1 1 1"}};
  CHECK(losses("a.ply").find("texture becomes colours") != std::string::npos);
  CHECK(losses("a.stl").find("texture is left out") != std::string::npos);
  CHECK(losses("a.glb").find("specular") != std::string::npos);
  CHECK(losses("a.obj").empty());
}
