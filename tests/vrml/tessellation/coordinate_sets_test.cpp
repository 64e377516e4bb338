#include "tests/vrml/mesh_checks.h"
#include "vrml/mesh/geometry_copy.h"
#include "vrml/mesh/mesh.h"
#include "vrml/syntax/parser.h"

#include <string>

namespace gs::vrml::coordinate_sets_test {
namespace {

Mesh mesh_of(const std::string& geometry, SceneGraph& scene) {
  Diagnostics diagnostics;
  REQUIRE(parse("#X3D V3.3 utf8\nShape { geometry " + geometry + " }", scene, diagnostics) == ParseOutcome::complete);
  for (const Diagnostic& each : diagnostics.entries()) FAIL_CHECK(each.message);
  return tessellate(scene, scene.get<SFNode>(scene.roots()[0], "geometry"));
}

const std::string kFaces = "IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 -1 ] ";

}  // namespace

TEST_CASE("gives a mesh one set of coordinates per node of a MultiTextureCoordinate (X3D 18.4.4)") {
  SceneGraph scene("t.x3dv");
  const Mesh mesh = mesh_of(kFaces +
                                "texCoord MultiTextureCoordinate { texCoord [ TextureCoordinate { point [ 0 0 1 0 0 "
                                "1 ] } TextureCoordinateGenerator { } TextureCoordinate3D { point [ 1 2 3 4 5 6 7 "
                                "8 9 ] } ] } texCoordIndex [ 2 1 0 -1 ] }",
                            scene);
  REQUIRE(mesh.coordinate_sets.size() == 3);
  REQUIRE(mesh.positions.size() == 3);
  CHECK(mesh.texture_coordinates[0] == glm::vec2(0, 1));
  CHECK(mesh.coordinate_sets[0][0] == glm::vec4(0, 1, 0, 1));
  CHECK(mesh.coordinate_sets[2][0] == glm::vec4(7, 8, 9, 1));
  CHECK(mesh.coordinate_sets[2][2] == glm::vec4(1, 2, 3, 1));
}

TEST_CASE("keeps three and four texture coordinates (X3D 33.4)") {
  SceneGraph scene("t.x3dv");
  const Mesh mesh = mesh_of(kFaces + "texCoord TextureCoordinate4D { point [ 1 2 3 4 5 6 7 8 9 10 11 12 ] } }", scene);
  REQUIRE(mesh.coordinate_sets.size() == 1);
  CHECK(mesh.coordinate_sets[0][2] == glm::vec4(9, 10, 11, 12));
}

TEST_CASE("needs no sets for one TextureCoordinate or a generator") {
  SceneGraph scene("t.x3dv"), other("u.x3dv");
  CHECK(mesh_of(kFaces + "texCoord TextureCoordinate { point [ 0 0 1 0 0 1 ] } }", scene).coordinate_sets.empty());
  CHECK(mesh_of(kFaces + "texCoord TextureCoordinateGenerator { } }", other).coordinate_sets.empty());
}

TEST_CASE("copies the nodes of a MultiTextureCoordinate for other threads") {
  SceneGraph scene("t.x3dv");
  const Mesh mesh =
      mesh_of(kFaces +
                  "texCoord MultiTextureCoordinate { texCoord [ TextureCoordinate { point [ 0 0 1 0 0 1 ] } "
                  "TextureCoordinate { point [ 1 1 0 0 0 1 ] } ] } }",
              scene);
  const GeometryCopy copy = copy_geometry(scene, scene.get<SFNode>(scene.roots()[0], "geometry"), {});
  REQUIRE(copy.scene);
  CHECK(tessellate(*copy.scene, copy.geometry).coordinate_sets.size() == mesh.coordinate_sets.size());
}

}  // namespace gs::vrml::coordinate_sets_test
