#include "vrml/mesh/geometry_copy.h"

#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <thread>

namespace gs::vrml::geometry_copy_test {
namespace {

std::unique_ptr<SceneGraph> scene_of(const std::string& body, const Limits& limits = {}) {
  auto scene = std::make_unique<SceneGraph>("text.wrl", limits);
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\n" + body, *scene, diagnostics);
  CHECK(diagnostics.errors() == 0);
  return scene;
}

NodeId geometry_of(const SceneGraph& scene) { return scene.get<SFNode>(scene.roots().end()[-1], "geometry"); }

const std::string kFaces =
    "PROTO P [ exposedField MFVec3f at [ ] ] { Coordinate { point IS at } } PROTO F [ ] { IndexedFaceSet { coord P { "
    "at "
    "[ 0 0 0, 1 0 0, 1 1 0, 0 1 1 ] } color Color { color [ 1 0 0, 0 1 0, 0 0 1, 1 1 1 ] } coordIndex [ 0 1 2 3 -1 ] } "
    "} "
    "Shape { geometry F { } }";

bool same(const Mesh& a, const Mesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.colors == b.colors && a.indices == b.indices &&
         a.texture_coordinates == b.texture_coordinates && a.solid == b.solid;
}

}  // namespace

TEST_CASE("makes an equal mesh from a copied geometry on another thread, with shared arrays") {
  const auto scene = scene_of(kFaces);
  const NodeId geometry = geometry_of(*scene);
  const Mesh own = tessellate(*scene, geometry);
  REQUIRE(own.indices.size() == 6);
  GeometryCopy copy = copy_geometry(*scene, geometry);
  REQUIRE(copy.scene);
  const NodeId face_set = scene->resolve(geometry);
  CHECK(copy.scene->get<MFInt32>(copy.geometry, "coordIndex").shares_with(scene->get<MFInt32>(face_set, "coordIndex")));
  // Later events of the original do not change the copy.
  scene->set(face_set, "coordIndex", MFInt32{0, 1, 2, -1});
  scene->set(face_set, "color", SFNode{});
  Mesh made;
  std::thread([&] { made = tessellate(*copy.scene, copy.geometry); }).join();
  CHECK(same(made, own));
  CHECK(tessellate(*scene, geometry).indices.size() == 3);
}

TEST_CASE("copies an OutlineGroup with the node that refines it") {
  const auto scene = scene_of(
      "Group { children [ Shape { geometry DEF A OutlineGroup { point [ 0 0 0, 1 0 0, 0 1 0 ] coordIndex [ 0 1 2 -1 ] "
      "} } "
      "Shape { geometry OutlineGroup { refines USE A point [ 5 0 0, 6 0 0, 5 1 0 ] coordIndex [ 0 1 2 -1 ] } } ] }");
  const MFNode& shapes = scene->get<MFNode>(scene->roots()[0], "children");
  const NodeId base = scene->get<SFNode>(shapes[0], "geometry"), refiner = scene->get<SFNode>(shapes[1], "geometry");
  MeshOptions options;
  options.refiner = refiner;
  const Mesh own = tessellate(*scene, base, options);
  REQUIRE(own.indices.size() == 6);
  const GeometryCopy copy = copy_geometry(*scene, base, refiner);
  REQUIRE(copy.scene);
  options.refiner = copy.refiner;
  CHECK(same(tessellate(*copy.scene, copy.geometry, options), own));
  // A refining node is drawn with the refined one, so it has no own mesh, in the copy too.
  const GeometryCopy alone = copy_geometry(*scene, refiner);
  CHECK(tessellate(*alone.scene, alone.geometry).empty());
}

TEST_CASE("returns no copy beyond the world's budget, or for an id of no node") {
  const auto scene = scene_of(kFaces);
  CHECK_FALSE(copy_geometry(*scene, NodeId{}).scene);
  const std::uint64_t left = scene->budget()->left(Resource::nodes);
  REQUIRE(scene->budget()->take(Resource::nodes, left));
  CHECK_FALSE(copy_geometry(*scene, geometry_of(*scene)).scene);
  scene->budget()->give_back(Resource::nodes, left);
  const std::uint64_t used = scene->budget()->used(Resource::nodes);
  CHECK(copy_geometry(*scene, geometry_of(*scene)).scene);
  CHECK(scene->budget()->used(Resource::nodes) == used);  // the copy gives its share back
}

TEST_CASE("estimates the cost of a mesh from list lengths alone") {
  const auto cost = [](const std::string& geometry) {
    const auto scene = scene_of("Shape { geometry " + geometry + " }");
    return tessellation_cost(*scene, geometry_of(*scene));
  };
  const auto numbers = [](std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += " 0";
    return text;
  };
  const auto faces = [&](std::size_t corners) {
    return cost("IndexedFaceSet { coord Coordinate { point [" + numbers(300) + " ] } coordIndex [" + numbers(corners) +
                " ] }");
  };
  CHECK(faces(1000) - faces(0) == 1000);
  CHECK(faces(0) >= 100);
  const auto extrusion = [&](std::size_t points, std::size_t spine) {
    return cost("Extrusion { crossSection [" + numbers(2 * points) + " ] spine [" + numbers(3 * spine) + " ] }");
  };
  CHECK(extrusion(20, 30) == 6 * extrusion(10, 10));
  CHECK(cost("ElevationGrid { height [" + numbers(50) + " ] }") ==
        5 * cost("ElevationGrid { height [" + numbers(10) + " ] }"));
  CHECK(cost("Text { string [ \"ab\" \"cdef\" ] }") == 6 * cost("Text { string \"a\" }"));
  CHECK(cost("NULL") == 0);
}

}  // namespace gs::vrml::geometry_copy_test
