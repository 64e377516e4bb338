#include "vrml/scene/coordinates/geospatial.h"

#include "vrml/mesh/mesh.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <string>

// Tests of geospatial coordinates (X3D component Geospatial).
namespace gs::vrml {
namespace {

GeoFrame frame(std::initializer_list<const char*> words) {
  MFString system;
  for (const char* word : words) system.push_back(word);
  return GeoFrame::make(system);
}

void check_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  CAPTURE(a.x, a.y, a.z, b.x, b.y, b.z);
  CHECK(glm::length(a - b) < tolerance);
}

/// X3D scene from the text of its nodes.
struct GeoScene {
  SceneGraph scene{"test.x3dv"};
  explicit GeoScene(const std::string& text) {
    Diagnostics diagnostics;
    scene.set_language(Language::x3d, 33);
    Parser(scene, diagnostics).parse_fragment(text);
    for (const Diagnostic& problem : diagnostics.entries()) UNSCOPED_INFO(problem.text());
    REQUIRE(diagnostics.errors() == 0);
  }
  [[nodiscard]] const Node& first() const { return scene.node(scene.roots()[0]); }
};

}  // namespace

TEST_CASE("converts latitude, longitude and elevation to geocentric metres", "[x3d]") {
  const GeoFrame wgs84 = frame({"GD", "WE"});
  check_near(wgs84.position({0, 0, 0}), {6378137, 0, 0}, 1e-6);
  check_near(wgs84.position({90, 0, 0}), {0, 0, 6356752.314245}, 1e-5);
  check_near(wgs84.position({0, 90, 100}), {0, 6378237, 0}, 1e-6);
  // Control point: 45 degrees north, 45 degrees east, 1,000 m.
  check_near(wgs84.position({45, 45, 1000}), {3194919.145, 3194919.145, 4488055.516}, 1e-2);
  check_near(frame({"GD", "longitude_first"}).position({45, 30, 0}), wgs84.position({30, 45, 0}), 1e-9);
  check_near(frame({"GC"}).position({1, 2, 3}), {1, 2, 3}, 1e-12);
  CHECK(frame({"GD", "CC"}).position({0, 0, 0}).x == 6378206.4);
}

TEST_CASE("converts UTM to the positions of the same latitudes and longitudes", "[x3d]") {
  // 48.8582 N, 2.2945 E is zone 31, easting 448,251.8, northing 5,411,932.7 (WGS 84).
  const glm::dvec3 tower = frame({"UTM", "Z31"}).position({5411932.678, 448251.898, 35});
  check_near(tower, frame({"GD"}).position({48.8582, 2.2945, 35}), 5);
  check_near(frame({"UTM", "Z31", "easting_first"}).position({448251.898, 5411932.678, 35}), tower, 1e-9);
  check_near(frame({"UTM", "Z56", "S"}).position({6252000, 334000, 0}), frame({"GD"}).position({-33.8568, 151.2055, 0}),
             2000);
}

TEST_CASE("inverts all coordinate systems", "[x3d]") {
  for (const auto& words : {std::initializer_list<const char*>{"GD"}, {"GD", "longitude_first"}, {"GC"}, {"GD", "IN"}})
    for (const glm::dvec3 given : {glm::dvec3(10, 20, 300), {-80, -120, 0}, {0.001, 179, 9000}}) {
      const GeoFrame one = frame(words);
      const glm::dvec3 position = one.position(given);
      check_near(one.position(one.coordinates(position)), position, 1e-4);
    }
  const GeoFrame utm = frame({"UTM", "Z33", "S"});
  check_near(utm.coordinates(utm.position({7000000, 550000, 20})), {7000000, 550000, 20}, 1e-3);
}

TEST_CASE("turns a GeoLocation so that y is up, x is east and z is south", "[x3d]") {
  const GeoScene world("GeoLocation { geoCoords 0 90 10 }");
  const glm::dmat4 matrix = geo_location_matrix(world.scene, world.first());
  check_near(glm::dvec3(matrix[3]), {0, 6378147, 0}, 1e-6);
  check_near(glm::dvec3(matrix[1]), {0, 1, 0}, 1e-12);
  check_near(glm::dvec3(matrix[0]), {-1, 0, 0}, 1e-12);
  check_near(glm::dvec3(matrix[2]), {0, 0, -1}, 1e-12);
}

TEST_CASE("makes positions relative to a GeoOrigin, and turns its up direction to y", "[x3d]") {
  const GeoScene world(
      "GeoLocation { geoCoords 48.01 11 500 geoOrigin GeoOrigin { geoCoords 48 11 500 rotateYUp TRUE } }");
  const glm::dmat4 matrix = geo_location_matrix(world.scene, world.first());
  CHECK(matrix[3].z == Approx(-1112).margin(2));  // 0.01 degrees to the north
  CHECK(std::abs(matrix[3].x) < 1e-3);
  CHECK(std::abs(matrix[3].y) < 0.2);
  CHECK(matrix[1].y == Approx(1));
}

TEST_CASE("keeps centimetres of a GeoCoordinate on the surface of the earth", "[x3d]") {
  const GeoScene world(
      "Shape { geometry IndexedFaceSet { coordIndex [ 0 1 2 ] coord GeoCoordinate { point [ 48 11 500, 48 11.0000001 "
      "500, 48.0000001 11 500 ] } } }");
  const Mesh mesh = tessellate(world.scene, world.scene.get<SFNode>(world.scene.roots()[0], "geometry"), {});
  REQUIRE(mesh.positions.size() == 3);
  CHECK(glm::length(mesh.origin) > 6e6);
  CHECK(glm::length(mesh.positions[2] - mesh.positions[0]) == Approx(0.0111).epsilon(0.02));
}

TEST_CASE("draws a GeoElevationGrid with its front side up", "[x3d]") {
  const GeoScene world(
      "Shape { geometry GeoElevationGrid { geoGridOrigin 10 20 0 xDimension 2 zDimension 2 xSpacing 0.01 zSpacing 0.01 "
      "height [ 0 0 0 100 ] } }");
  const Mesh mesh = tessellate(world.scene, world.scene.get<SFNode>(world.scene.roots()[0], "geometry"), {});
  REQUIRE(mesh.indices.size() == 6);
  const glm::dvec3 up = glm::normalize(mesh.origin);
  for (const glm::vec3& normal : mesh.normals) CHECK(glm::dot(glm::dvec3(normal), up) > 0.9);
}

TEST_CASE("accepts geospatial nodes without values, at the poles and with broken systems", "[x3d]") {
  for (const char* text : {"GeoLocation { geoSystem [ \"UTM\" \"Z99\" ] geoCoords 1e30 -1e30 5 }",
                           "GeoLocation { geoCoords 90 0 0 }", "GeoLocation { geoSystem [ \"GC\" ] }",
                           "GeoLocation { geoSystem [ \"nonsense\" \"Z\" ] geoOrigin GeoOrigin { } }"}) {
    CAPTURE(text);
    const GeoScene world(text);
    const glm::dmat4 matrix = geo_location_matrix(world.scene, world.first());
    CHECK(std::isfinite(matrix[0][0] + matrix[1][1] + matrix[2][2]));
  }
}

}  // namespace gs::vrml
