#include "base/budget.h"

#include "vrml/mesh/mesh.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

namespace gs::budget_test {
namespace {

using namespace vrml;

constexpr std::size_t kMemory = std::size_t{8} << 20;

/// Text parsed in a world with a small memory limit.
struct Small {
  explicit Small(const std::string& body, std::size_t memory = kMemory)
      : scene("bomb.wrl", Limits{.memory = memory}), outcome(parse("#VRML V2.0 utf8\n" + body, scene, diagnostics)) {}
  [[nodiscard]] std::string said() const {
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics.entries()) text += diagnostic.text() + "\n";
    return text;
  }
  [[nodiscard]] bool said(std::string_view what) const { return said().find(what) != std::string::npos; }
  [[nodiscard]] const Budget& budget() const { return *scene.budget(); }

  Diagnostics diagnostics;
  SceneGraph scene;
  ParseOutcome outcome;
};

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  all.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

/// Returns nested PROTOs that make 2^levels Groups.
std::string laughs(int levels) {
  std::string text = "PROTO P0 [ ] { Group { children [ Shape { } ] } }\n";
  for (int i = 1; i <= levels; ++i) {
    const std::string inner = "P" + std::to_string(i - 1) + " { } ";
    text += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + inner + inner + "] } }\n";
  }
  return text;
}

}  // namespace

TEST_CASE("limits each resource of a budget, and their sum") {
  Budget budget(Limits{.memory = 3200});
  CHECK(budget.limit(Resource::meshes) == 1600);
  CHECK(budget.limit(Resource::unpacked) == 3200);
  CHECK(budget.take(Resource::meshes, 1000));
  CHECK_FALSE(budget.take(Resource::meshes, 601));
  CHECK(budget.used(Resource::meshes) == 1000);
  CHECK(budget.refusal(Resource::meshes) ==
        "more than the limit for meshes, 1600 bytes of one world (--memory raises it)");
  CHECK(budget.take(Resource::nodes, 1300));
  CHECK(budget.left(Resource::meshes) == 100);  // of 2400 in total
  CHECK_FALSE(budget.take(Resource::vectors, 101));
  CHECK(budget.used(Resource::vectors) == 0);
  CHECK(budget.refusal(Resource::vectors) ==
        "more than the limit for memory in use, 2400 bytes of one world (--memory raises it)");
  CHECK(budget.take(Resource::unpacked, 3200));  // this resource is not held
  budget.give_back(Resource::nodes, 1300);
  CHECK(budget.take(Resource::vectors, 1400));
  CHECK_FALSE(budget.take(Resource::meshes, ~std::uint64_t{0}));
}

TEST_CASE("gives a share back once") {
  const auto budget = std::make_shared<Budget>(Limits{.memory = 3200});
  {
    Share share(budget, Resource::meshes);
    CHECK(share.grow(900));
    CHECK_FALSE(share.grow(900));
    CHECK(share.amount() == 900);
    Share moved = std::move(share);
    CHECK(moved.grow(100));
    moved.shrink_to(300);
    CHECK(budget->used(Resource::meshes) == 300);
    Share other(budget, Resource::nodes);
    CHECK(other.grow(5));
    other = std::move(moved);
    CHECK(budget->used(Resource::meshes) == 300);
  }
  CHECK(budget->used(Resource::meshes) == 0);
  CHECK(budget->used(Resource::nodes) == 0);
  CHECK(Share().grow(1u << 30));  // no budget, no limit
}

TEST_CASE("stops at the limit for nodes, names and lists, and keeps the nodes before it") {
  const std::string box = "Shape { geometry Box { } }\n";
  const auto check = [](const Small& small) {
    INFO(small.said());
    CHECK(small.outcome == ParseOutcome::truncated);
    CHECK(small.diagnostics.errors() == 1);
    CHECK(small.said("more than the limit for nodes and numbers, 4 MiB"));
    CHECK(small.said("skipped the rest of the file"));
    CHECK(small.scene.roots().size() >= 1);
    CHECK(small.scene.resolve_as(small.scene.roots()[0], NodeKind::shape));
    CHECK(small.budget().used(Resource::nodes) <= small.budget().limit(Resource::nodes));
  };
  check(Small(box + repeated("Group { } ", 200'000)));
  check(Small(box + repeated("Group { children [ ", 900) + repeated("Shape { } ", 200'000)));
  check(Small(box + "Shape { geometry PointSet { coord Coordinate { point [ " + repeated("0 1 2 ", 1'000'000)));
  check(Small(box + "WorldInfo { info [ " + repeated("\"\" ", 200'000) + "] }"));
  check(Small(box + repeated("DEF a Group { } ", 100'000)));
  check(Small(box + "Script { " + repeated("field SFBool a TRUE ", 200'000) + "}"));
  check(Small(box + repeated("Script { } ", 20'000)));
  check(Small(box + repeated("EXTERNPROTO A [ ] \"\" ", 100'000)));
  check(Small(box + "DEF a TimeSensor { } " + repeated("ROUTE a.time TO a.startTime ", 100'000)));
  check(Small(box + "PixelTexture { image 2048 2048 1 " + repeated("0 ", 2048 * 2048) + "}"));
}

TEST_CASE("stops a parse in pieces at the memory limit and discards the rest") {
  SceneGraph scene("bomb.wrl", Limits{.memory = kMemory});
  Diagnostics diagnostics;
  Parser parser(scene, diagnostics);
  parser.push("#VRML V2.0 utf8\nShape { }\n");
  const std::string groups = repeated("Group { } ", 1000);
  for (int i = 0; i < 200; ++i) parser.push(groups);
  CHECK(scene.memory().exhausted());
  CHECK(parser.finish() == ParseOutcome::truncated);
  CHECK(diagnostics.errors() == 1);
  CHECK(scene.roots().size() > 1000);
}

TEST_CASE("allocates no pixels of an image that the file does not contain") {
  const Small small("Shape { appearance Appearance { texture PixelTexture { image 16384 16384 1 0 x } } }\nGroup { }",
                    std::size_t{256} << 20);
  CHECK(small.said("pixels of an image are missing"));
  CHECK(small.scene.roots().size() == 2);
  CHECK(small.budget().used(Resource::nodes) < (std::size_t{1} << 20));
}

TEST_CASE("leaves nested PROTOs empty that exceed the limit, and keeps the other nodes") {
  const Small small("Shape { }\n" + laughs(40) + "P40 { }\nP3 { }\nShape { geometry Box { } }");
  INFO(small.said());
  CHECK(small.diagnostics.errors() == 1);
  CHECK(small.said("bomb.wrl:44:1: error: "));
  CHECK(small.said("more than the limit for PROTO instances, 2 MiB of one world"));
  REQUIRE(small.scene.roots().size() == 4);
  CHECK_FALSE(small.scene.resolve(small.scene.roots()[1]));
  CHECK(small.scene.resolve_as(small.scene.roots()[2], NodeKind::group));
  CHECK(small.scene.resolve_as(small.scene.roots()[3], NodeKind::shape));
  CHECK(small.scene.nodes().count() < 300);

  // Many small instances reach the limit, too.
  const Small many(laughs(4) + repeated("P4 { }\n", 10'000) + "Shape { }");
  INFO(many.said());
  CHECK(many.said("more than the limit for PROTO instances"));
  CHECK(many.budget().used(Resource::instances) <= many.budget().limit(Resource::instances));
  CHECK(many.scene.roots().size() == 10'001);
  CHECK(many.scene.resolve(many.scene.roots()[0]));
  CHECK_FALSE(many.scene.resolve(many.scene.roots()[9999]));
}

TEST_CASE("shares one budget between the scenes of a world, and gives it back") {
  const auto budget = std::make_shared<Budget>(Limits{.memory = kMemory});
  Diagnostics diagnostics;
  const std::string text = "#VRML V2.0 utf8\n" + repeated("Group { } ", 8000);
  {
    SceneGraph first("a.wrl", budget);
    (void)parse(text, first, diagnostics);
    CHECK(diagnostics.errors() == 0);
    SceneGraph second("b.wrl", budget), third("c.wrl", budget);
    (void)parse(text, second, diagnostics);
    (void)parse(text, third, diagnostics);
    CHECK(third.memory().exhausted());
    CHECK(diagnostics.errors() > 0);
  }
  CHECK(budget->used(Resource::nodes) == 0);
  SceneGraph again("a.wrl", budget);
  (void)parse(text, again, diagnostics);
  CHECK_FALSE(again.memory().exhausted());
}

TEST_CASE("stops instantiation when the budget's stop function returns true") {
  const auto budget = std::make_shared<Budget>();
  SceneGraph scene("slow.wrl", budget);
  budget->stop_when([] { return true; });
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\n" + laughs(16) + "P16 { }", scene, diagnostics);
  CHECK(diagnostics.errors() == 0);  // the owner of the stop function reports it
  CHECK(scene.nodes().count() < 10'000);
}

TEST_CASE("leaves out geometries that exceed the memory limit, and gives back their share") {
  SceneGraph scene("", Limits{.memory = std::size_t{16} << 20});
  const auto made = [&](std::string_view type) { return scene.create(*built_in_node_type(type)); };
  const auto check = [&](NodeId id, bool some) {
    const Mesh mesh = tessellate(scene, id);
    CHECK(mesh.limited);
    CHECK(mesh.empty() != some);
    CHECK(scene.budget()->used(Resource::meshes) == 0);
    CHECK(mesh.cost() <= scene.budget()->limit(Resource::meshes));
  };
  MFVec3f spine;
  MFVec2f section;
  for (int i = 0; i < 5000; ++i) {
    spine.push_back({0, static_cast<float>(i), 0});
    section.push_back({static_cast<float>(i % 7), static_cast<float>(i % 11)});
  }
  const NodeId extrusion = made("Extrusion");
  scene.set(extrusion, "crossSection", section);
  scene.set(extrusion, "spine", spine);
  check(extrusion, false);  // fewer than two rings
  section.resize(10);
  scene.set(extrusion, "crossSection", section);
  check(extrusion, true);  // the mesh has the start of the spine
  spine.resize(50);
  scene.set(extrusion, "spine", spine);
  CHECK_FALSE(tessellate(scene, extrusion).limited);

  const NodeId grid = made("ElevationGrid");
  MFFloat heights;
  heights.resize(400 * 400);
  scene.set(grid, "height", heights);
  scene.set<SFInt32>(grid, "xDimension", 400);
  scene.set<SFInt32>(grid, "zDimension", 400);
  check(grid, false);
  scene.set<SFInt32>(grid, "zDimension", 10);
  CHECK_FALSE(tessellate(scene, grid).limited);

  const NodeId faces = made("IndexedFaceSet"), lines = made("IndexedLineSet"), points = made("PointSet");
  const NodeId coordinate = made("Coordinate");
  MFVec3f positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  MFInt32 index;
  for (int i = 0; i < 200'000; ++i)
    for (const std::int32_t corner : {0, 1, 2, -1}) index.push_back(corner);
  scene.set(coordinate, "point", positions);
  for (const NodeId node : {faces, lines, points}) scene.set<SFNode>(node, "coord", coordinate);
  for (const NodeId node : {faces, lines}) scene.set(node, "coordIndex", index);
  check(faces, false);
  check(lines, false);
  CHECK_FALSE(tessellate(scene, points).limited);
  positions.resize(2'000'000);
  scene.set(coordinate, "point", positions);
  check(points, false);
}

TEST_CASE("stops tessellation when the budget's stop function returns true") {
  const auto budget = std::make_shared<Budget>();
  SceneGraph scene("", budget);
  const NodeId faces = scene.create(*built_in_node_type("IndexedFaceSet")),
               coordinate = scene.create(*built_in_node_type("Coordinate"));
  MFInt32 index;
  for (int i = 0; i < 100'000; ++i)
    for (const std::int32_t corner : {0, 1, 2, -1}) index.push_back(corner);
  scene.set(coordinate, "point", MFVec3f{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  scene.set<SFNode>(faces, "coord", coordinate);
  scene.set(faces, "coordIndex", index);
  CHECK(tessellate(scene, faces).indices.size() == 300'000);
  int looks = 0;
  budget->stop_when([&] { return ++looks > 3; });
  const Mesh mesh = tessellate(scene, faces);
  CHECK(mesh.limited);
  CHECK_FALSE(mesh.empty());
  CHECK(mesh.indices.size() < 300'000);
}

TEST_CASE("draws primitives as scaled default primitives") {
  SceneGraph scene;
  Diagnostics diagnostics;
  (void)parse(
      "#VRML V2.0 utf8\nShape { geometry Box { size 3 4 5 } } Shape { geometry Cone { bottomRadius 2 height 7 } }\n"
      "Shape { geometry Cylinder { radius 0.5 height 3 top FALSE } } Shape { geometry Sphere { radius 9 } }\n"
      "Shape { geometry PointSet { } } Shape { geometry Sphere { radius -1 } }",
      scene, diagnostics);
  for (std::size_t i = 0; i < 4; ++i) {
    const NodeId geometry = scene.get<SFNode>(scene.roots()[i], "geometry");
    const auto scale = scale_of_primitive(scene, geometry);
    REQUIRE(scale);
    const Mesh own = tessellate(scene, geometry), standard = tessellate(scene, geometry, {.default_measures = true});
    REQUIRE(own.positions.size() == standard.positions.size());
    CHECK(own.indices == standard.indices);
    for (std::size_t k = 0; k < own.positions.size(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        REQUIRE(own.positions[k][axis] == Approx(standard.positions[k][axis] * (*scale)[axis]).margin(1e-5));
  }
  for (std::size_t i = 4; i < 6; ++i)
    CHECK_FALSE(scale_of_primitive(scene, scene.get<SFNode>(scene.roots()[i], "geometry")));
}

}  // namespace gs::budget_test
