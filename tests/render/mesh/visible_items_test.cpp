// Tests of the tree that finds the visible items of a large list. Its results are compared with a test of each item.
#include "render/mesh/visible_items.h"

#include "render/collection/render_scene.h"
#include "tests/render/drawing.h"
#include "vrml/events/execution.h"
#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace gs::visible_items_test {
namespace {

using namespace render;
using namespace render::testing;

constexpr std::size_t kItems = 3000;

RenderList scattered(std::uint64_t generation, double scale = 1, const glm::dvec3& about = glm::dvec3(0)) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-100, 100);
  RenderList list;
  const auto mesh = square();
  for (std::size_t i = 0; i < kItems; ++i) {
    DrawItem item = unlit(mesh);
    item.world_from_node = glm::dmat4(scale);
    item.world_from_node[3] = glm::dvec4(about + scale * glm::dvec3(place(random), place(random), place(random)), 1);
    list.items.push_back(std::move(item));
  }
  list.generation = generation;
  return list;
}

/// Reports whether a corner of the item's box, or a point between two, is in the view cone.
bool surely_seen(const DrawItem& item, const glm::dmat4& camera_from_world, double tangent, double near, double far) {
  for (int k = 0; k < 9; ++k) {
    const glm::dvec3 corner(k == 8 ? 0 : k & 1 ? 1 : -1, k == 8 ? 0 : k & 2 ? 1 : -1, 0);
    const glm::dvec3 p(camera_from_world * item.world_from_node * glm::dvec4(corner, 1));
    if (-p.z >= near && -p.z <= far && std::abs(p.x) <= -p.z * tangent && std::abs(p.y) <= -p.z * tangent) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("collects every item in view, and omits most others") {
  for (const double scale : {1.0, 1e-3, 1e4}) {
    const glm::dvec3 about = scale == 1 ? glm::dvec3(6.4e6, 0, -1e5) : glm::dvec3(0);
    const RenderList list = scattered(5, scale, about);
    VisibleItems visible;
    for (int turn = 0; turn < 12; ++turn) {
      const glm::dvec3 eye = about + scale * glm::dvec3(10 * turn - 60, 5, 0);
      const double angle = 0.7 * turn;
      const glm::dmat4 camera_from_world =
          glm::lookAt(eye, eye + glm::dvec3(std::sin(angle), 0.1, std::cos(angle)), glm::dvec3(0, 1, 0));
      const double near = 0.1 * scale, far = 70 * scale;
      const auto* found = visible.find(list, Frustum(camera_from_world, glm::vec2(0.4f), near, far));
      if (turn == 0) {
        CHECK(found == nullptr);  // for a single picture, no tree is built
        continue;
      }
      REQUIRE(found);
      CHECK(std::is_sorted(found->begin(), found->end()));
      CHECK(found->size() < kItems / 4);
      std::size_t seen = 0;
      for (std::uint32_t i = 0; i < kItems; ++i) {
        if (!surely_seen(list.items[i], camera_from_world, 0.4, near, far)) continue;
        ++seen;
        CHECK(std::binary_search(found->begin(), found->end(), i));
      }
      CHECK(found->size() <= 4 * seen + 100);
    }
  }
}

TEST_CASE("finds moved items, and rebuilds for a list of another generation") {
  RenderList list = scattered(5);
  VisibleItems visible;
  const glm::dmat4 camera_from_world = glm::lookAt(glm::dvec3(0, 0, 300), glm::dvec3(0, 0, 500), glm::dvec3(0, 1, 0));
  const Frustum away(camera_from_world, glm::vec2(0.4f), 1, 1000);
  const auto find = [&] { return visible.find(list, away); };
  CHECK_FALSE(find());
  REQUIRE(find());
  CHECK(find()->empty());
  list.items[77].world_from_node[3] = glm::dvec4(0, 0, 400, 1);
  list.moved.push_back(77);
  REQUIRE(find());
  CHECK(*find() == std::vector<std::uint32_t>{77});
  // If half of the items move, no tree is used.
  for (std::uint32_t i = 0; i < kItems; ++i) list.moved.push_back(i);
  CHECK_FALSE(find());
  // The items no longer move, so a new tree is built.
  for (int i = 0; i < 40; ++i) (void)find();
  REQUIRE(find());
  // The result contains the items of the same leaf.
  CHECK(find()->size() <= 8);
  CHECK(std::binary_search(find()->begin(), find()->end(), 77u));
  list.generation = 6;
  list.items[78].world_from_node[3] = glm::dvec4(0, 0, 400, 1);
  CHECK_FALSE(find());
  REQUIRE(find());
  CHECK(find()->size() <= 8);
  CHECK(std::binary_search(find()->begin(), find()->end(), 77u));
  CHECK(std::binary_search(find()->begin(), find()->end(), 78u));
  // Lists without generation, and small ones, use no tree.
  list.generation = 0;
  CHECK_FALSE(find());
  CHECK_FALSE(find());
  list.generation = 7;
  list.items.resize(VisibleItems::kMinItems - 1);
  CHECK_FALSE(find());
  CHECK_FALSE(find());
}

TEST_CASE("always collects items without a box or at infinite positions") {
  RenderList list = scattered(9);
  list.items[3].world_from_node[3].x = std::numeric_limits<double>::quiet_NaN();
  list.items[4].world_from_node[0].x = 1e300;
  list.items[5].mesh = nullptr;
  VisibleItems visible;
  const Frustum away(glm::lookAt(glm::dvec3(0, 0, 300), glm::dvec3(0, 0, 500), glm::dvec3(0, 1, 0)), glm::vec2(0.4f), 1,
                     1000);
  (void)visible.find(list, away);
  const auto* found = visible.find(list, away);
  REQUIRE(found);
  CHECK(*found == std::vector<std::uint32_t>{3, 4, 5});
}

TEST_CASE("draws many Shapes equally with and without the tree, at rest and while one moves") {
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 2000; ++i)
    text += "DEF T" + std::to_string(i) + " Transform { translation " + std::to_string(i % 50 * 3 - 75) + " 0 " +
            std::to_string(-(i / 50) * 3) +
            " children Shape { appearance Appearance { material Material { diffuseColor " +
            std::to_string(i % 7 / 7.0) + " 0.5 0.5 } } geometry Box { } } }\n";
  vrml::SceneGraph scene("test.wrl");
  Diagnostics diagnostics;
  vrml::parse(text, scene, diagnostics);
  REQUIRE(diagnostics.errors() == 0);
  vrml::Execution execution(scene);
  vrml::NodeNames names(scene);
  execution.start(1000);
  (void)execution.changes().take();
  const Images images;
  const Geometries geometries;
  MeshCache meshes;
  RenderScene world(scene, images, geometries, meshes);
  world.gather({}, {0, 5, 10});
  REQUIRE(world.list().generation != 0);
  Drawing drawing;
  const auto draw = [&](const Camera& camera) {
    const Image with = drawing.draw(world.list(), camera);
    const std::size_t items = drawing.statistics.items;
    RenderList plain = world.list();
    plain.generation = 0;
    CHECK(with.pixels == drawing.draw(plain, camera).pixels);
    CHECK(items > 0);
    CHECK(items <= drawing.statistics.items);  // boxes can miss a view that spheres around them meet
    return with;
  };
  Camera camera = camera_at({0, 5, 10});
  Image before;
  for (int i = 0; i < 3; ++i) before = draw(camera);
  // An item moves near the viewer.
  const vrml::NodeId moved = names.find("T1975");
  REQUIRE(moved);
  execution.step(1001);
  REQUIRE(execution.send(scene, moved, *scene.node(moved).type->find_event_in("set_translation"),
                         vrml::FieldValue(vrml::SFVec3f{0, 5, 0})));
  const std::uint64_t generation = world.list().generation;
  CHECK(world.update(execution.changes().take(), {}, {0, 5, 10}));
  CHECK(generation == world.list().generation);
  CHECK(world.list().moved.size() == 1);
  CHECK(draw(camera).pixels != before.pixels);
  camera.world_from_camera = camera.world_from_camera * glm::rotate(glm::dmat4(1.0), 0.5, glm::dvec3(0, 1, 0));
  (void)draw(camera);
  // Collecting again makes another list.
  world.gather({}, {0, 5, 10});
  CHECK(generation != world.list().generation);
  CHECK(world.list().moved.empty());
}

}  // namespace gs::visible_items_test
