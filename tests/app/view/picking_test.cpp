#include "app/view/picking.h"

#include "qnv/base/geometry.h"
#include "tests/geometries.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <limits>
#include <string>

namespace {

using namespace gs;
using namespace gs::app;

/// Returns a square of side 2 in the plane z = 0.
std::shared_ptr<const vrml::Mesh> square_mesh() {
  auto mesh = std::make_shared<vrml::Mesh>();
  mesh->positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  for (const glm::vec3& p : mesh->positions) mesh->bounds.add(p);
  return mesh;
}

std::optional<Hit> pick(const render::RenderList& list, const Ray& ray, const PickOptions& options = {}) {
  return Picker().pick(list, ray, options);
}

render::RenderList list_of(std::initializer_list<glm::mat4> places) {
  render::RenderList list;
  const auto mesh = square_mesh();
  for (const glm::mat4& place : places) {
    render::DrawItem item;
    item.mesh = mesh;
    item.world_from_node = place;
    list.items.push_back(item);
  }
  return list;
}
glm::mat4 at(float z) { return glm::translate(glm::mat4(1), {0, 0, z}); }

/// Returns a disc of area 3.14 in the plane z = 0 that faces +z and covers 1.7 around the origin.
std::shared_ptr<qnv::Splats> disc() {
  auto geometry = std::make_shared<qnv::Splats>();
  geometry->positions = {{0, 0, 0}};
  geometry->normals = {{0, 0, 1}};
  geometry->weights = {3.14159f};
  return geometry;
}

/// Returns ten layers of vectors from z = 0 to -0.9.
std::shared_ptr<qnv::Volume> fog_volume(float opacity) {
  auto geometry = std::make_shared<qnv::Volume>();
  geometry->description.spacing = 0.1f;
  geometry->description.transfer = {{0, {}, opacity}, {1, {}, opacity}};
  for (int i = 0; i < 10 * 441; ++i) {
    geometry->positions.emplace_back(0.1f * static_cast<float>(i % 21 - 10),
                                     0.1f * static_cast<float>(i / 21 % 21 - 10), -0.1f * static_cast<float>(i / 441));
    geometry->normals.emplace_back(0, 0, 1);
    geometry->weights.push_back(i < 5 * 441 ? 1.0f : 2.0f);  // the farther half has the longer gradients
    geometry->classes.push_back(i < 5 * 441 ? 100 : 200);
  }
  geometry->description.box = {{-1, -1, -0.9f}, {1, 1, 0}};
  return geometry;
}

template <class Content>
void add(render::RenderList& list, const std::shared_ptr<Content>& content, const glm::mat4& place) {
  render::SplatItem item;
  item.geometry = shared_geometry(content);
  item.world_from_node = place;
  list.splats.push_back(std::move(item));
}

const Ray kAhead{{0, 0, 0}, {0, 0, -1}};

}  // namespace

TEST_CASE("picks overlays in perspective also in a parallel projection") {
  Pose pose;
  pose.position = {0, 0, 10};
  pose.field_of_view = glm::radians(90.0f);
  pose.height = 40;
  render::RenderList list =
      list_of({glm::translate(glm::mat4(1), {16, 0, 0}), glm::translate(glm::mat4(1), {8, 0, 0})});
  list.items[1].overlay = list.overlays = true;
  const glm::dvec2 size{200, 200}, pixel{180, 100};  // 0.8 of half the picture
  const render::SightLine line = sight_line(pose, pixel, size);
  CHECK(Picker().pick(list, line)->item == 0);
  PickOptions options;
  options.overlay_line = overlay_line(pose, pixel, size);
  const auto hit = Picker().pick(list, line, options);
  REQUIRE(hit);
  CHECK(hit->item == 1);
  CHECK(hit->point.x == Approx(8));
  options.overlay_line = overlay_line(pose, {20, 100}, size);
  CHECK(Picker().pick(list, sight_line(pose, {180, 100}, size), options)->item == 0);
  pose.height = 0;
  CHECK_FALSE(overlay_line(pose, pixel, size));
}

TEST_CASE("picks overlays first, which never collide") {
  render::RenderList list = list_of({at(0), at(-3), at(-5)});
  list.items[1].overlay = list.items[2].overlay = true;
  list.overlays = true;
  Picker picker;
  const Ray ray{{0.2f, 0.1f, 8}, {0, 0, -1}};
  const auto hit = picker.pick(list, ray);
  REQUIRE(hit);
  CHECK(hit->item == 1);
  CHECK(hit->distance == Approx(11));
  render::ItemBvh items;
  const render::SightLine line{{0.2, 0.1, 8}, {0, 0, -1}};
  const auto met = items.nearest(list, line, 1000, render::Sought::met);
  REQUIRE(met);
  CHECK(met->item == 0);
  list.items[0].collidable = false;
  CHECK_FALSE(items.nearest(list, line, 1000, render::Sought::met));
  CHECK(items.near(list, {-9, -9, -9}, {9, 9, 9}, 100).empty());
  // Without the other items in the way, the ray hits the first item again.
  list.items[1].world_from_node = list.items[2].world_from_node = glm::translate(glm::mat4(1), {9, 0, 0});
  list.items[0].collidable = true;
  CHECK(picker.pick(list, ray)->item == 0);
}

TEST_CASE("hits the nearest face from either side, in any order") {
  const render::RenderList list = list_of({at(-5), at(-2), at(3)});
  const auto hit = pick(list, {{0.5f, -0.25f, 0}, {0, 0, -1}});
  REQUIRE(hit);
  CHECK(hit->distance == Approx(2));
  CHECK(hit->item == 1);
  const auto behind = pick(list, {{0, 0, 0}, {0, 0, 1}});
  REQUIRE(behind);
  CHECK(behind->item == 2);
  CHECK_FALSE(pick(list, {{1.5f, 0, 0}, {0, 0, -1}}));
  CHECK_FALSE(pick(list, {{0, 0, 0}, {1, 0, 0}}));
}

TEST_CASE("measures distances in world space under scale and rotation") {
  const glm::mat4 place = glm::rotate(glm::scale(at(-4), glm::vec3(3, 2, 5)), 0.4f, glm::vec3(0, 0, 1));
  const auto hit = pick(list_of({place}), {{0.3f, 0.2f, 1}, {0, 0, -1}});
  REQUIRE(hit);
  CHECK(hit->distance == Approx(5));
}

TEST_CASE("survives flat, singular, empty and very many shapes") {
  render::RenderList list = list_of({glm::mat4(0.0f), at(-2)});
  list.items.emplace_back();
  CHECK(pick(list, {{0, 0, 0}, {0, 0, -1}})->item == 1);
  PickOptions one;
  one.max_triangles = 1;
  CHECK_FALSE(pick(list, {{0, 0, 0}, {0, 0, -1}}, one));
  CHECK_FALSE(pick({}, {}));
}

TEST_CASE("hides splats and polygons behind each other") {
  render::RenderList list = list_of({at(-3)});
  add(list, disc(), at(-2));
  add(list, disc(), at(-4));
  const auto disc_first = pick(list, kAhead);
  REQUIRE(disc_first);
  CHECK(disc_first->distance == Approx(2));
  CHECK(disc_first->splat == std::size_t{0});
  list.splats.erase(list.splats.begin());
  const auto polygon_first = pick(list, kAhead);
  REQUIRE(polygon_first);
  CHECK(polygon_first->distance == Approx(3));
  CHECK_FALSE(polygon_first->splat);
  CHECK(polygon_first->item == 0);
  // Beside the polygon, the splat behind it is hit.
  const auto beside = pick(list, {{1.3f, 0, 0}, {0, 0, -1}});
  REQUIRE(beside);
  CHECK(beside->distance == Approx(4));
  CHECK(beside->splat == std::size_t{0});
}

TEST_CASE("hits splats under transformations, and from behind if two-sided") {
  render::RenderList list;
  add(list, disc(), glm::scale(at(-4), {2, 0.5f, 3}));
  CHECK(pick(list, {{3.3f, 0, 0}, {0, 0, -1}})->distance == Approx(4));
  CHECK_FALSE(pick(list, {{3.5f, 0, 0}, {0, 0, -1}}));
  CHECK(pick(list, {{0, 0.8f, 0}, {0, 0, -1}}));
  CHECK_FALSE(pick(list, {{0, 0.9f, 0}, {0, 0, -1}}));
  const Ray behind{{0, 0, -9}, {0, 0, 1}};
  CHECK_FALSE(pick(list, behind));
  auto two_sided = disc();
  two_sided->description.two_sided = true;
  list.splats[0].geometry = shared_geometry(two_sided);
  CHECK(pick(list, behind)->distance == Approx(5));
}

TEST_CASE("hits volumes where they are dense, before objects behind them") {
  render::RenderList list = list_of({at(-5)});
  add(list, fog_volume(0.9f), at(-2));
  Picker picker;
  const auto hit = picker.pick(list, kAhead);
  REQUIRE(hit);
  CHECK(hit->distance == Approx(2).margin(0.11));
  CHECK(hit->splat == std::size_t{0});
  list.items[0].world_from_node = at(-1);
  CHECK_FALSE(picker.pick(list, kAhead)->splat);
  CHECK(picker.pick(list, kAhead)->distance == Approx(1));
}

TEST_CASE("hits a faint volume only if nothing else is hit") {
  render::RenderList list = list_of({at(-5)});
  add(list, fog_volume(0.02f), at(-2));
  const auto through = pick(list, kAhead);
  REQUIRE(through);
  CHECK(through->distance == Approx(5));
  CHECK_FALSE(through->splat);
  list.items.clear();
  const auto faint = pick(list, kAhead);
  REQUIRE(faint);
  CHECK(faint->splat == std::size_t{0});
  CHECK((faint->distance > 2.2f && faint->distance < 2.7f));
}

TEST_CASE("ignores the parts of a volume that the style hides") {
  render::RenderList list;
  add(list, fog_volume(0.9f), at(-2));
  Picker picker;
  PickOptions options;
  options.splat_style.clip = glm::vec4(0, 0, -1, -2.75f);  // keeps z <= -2.75 of the world
  CHECK(picker.pick(list, kAhead, options)->distance == Approx(2.8).margin(0.11));
  options = {};
  options.splat_style.least_magnitude = 1.5f;
  CHECK(picker.pick(list, kAhead, options)->distance == Approx(2.5).margin(0.11));
  options = {};
  options.splat_style.transfer = {{0.5f, {}, 0}, {0.6f, {}, 0.9f}};  // class 100 is transparent
  CHECK(picker.pick(list, kAhead, options)->distance == Approx(2.5).margin(0.11));
  options.splat_style.transfer = {{0, {}, 0}};
  CHECK_FALSE(picker.pick(list, kAhead, options));
  options = {};
  list.splats[0].material.transparency = 1;
  CHECK_FALSE(picker.pick(list, kAhead, options));
  // Another geometry may have the same address. The picker must distinguish them.
  for (int i = 0; i < 20; ++i) {
    list.splats.clear();
    add(list, fog_volume(0.9f), at(-2 - static_cast<float>(i)));
    CHECK(picker.pick(list, kAhead)->distance == Approx(2 + i).margin(0.11));
  }
}

TEST_CASE("ignores invalid splats and volumes") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  render::RenderList list;
  list.splats.emplace_back();  // without a geometry
  add(list, std::make_shared<qnv::Splats>(), at(-1));
  auto broken = disc();
  broken->normals.clear();
  add(list, broken, at(-1));
  auto lost = disc();
  lost->positions[0].x = nan;
  add(list, lost, at(-1));
  add(list, disc(), glm::mat4(0.0f));
  add(list, disc(), glm::mat4(nan));
  auto fog = fog_volume(0.9f);
  fog->classes.pop_back();
  add(list, fog, at(-1));
  fog = fog_volume(nan);
  add(list, fog, at(-1));
  CHECK_FALSE(pick(list, kAhead));
  add(list, disc(), at(-7));
  CHECK(pick(list, kAhead)->splat == list.splats.size() - 1);
  CHECK_FALSE(pick(list, {{nan, 0, 0}, {0, 0, -1}}));
  CHECK_FALSE(pick(list, {{0, 0, 0}, {nan, nan, nan}}));
}

TEST_CASE("returns the path of a hit through PROTO instances and Inlines, with coordinate systems") {
  vrml::SceneGraph scene("root.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse(R"(#VRML V2.0 utf8
    PROTO Moved [ exposedField MFNode children [ ] ] { Transform { translation 0 0 -5 children IS children } }
    Moved { children DEF S Switch { whichChoice 1 choice [ Group { } DEF I Inline { } ] } })",
                    scene, diagnostics);
  auto inlined = std::make_unique<vrml::SceneGraph>("inline.wrl", scene.budget());
  (void)vrml::parse("#VRML V2.0 utf8\nTransform { scale 2 2 2 children DEF Box Shape { geometry Box { } } }", *inlined,
                    diagnostics);
  REQUIRE(diagnostics.errors() == 0);
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
    if (scene.nodes().at(i).name == "I") {
      scene.inlines().attach(scene.nodes().id_at(i), std::move(inlined));
      break;
    }
  render::MeshCache meshes;
  const render::RenderList list = render::collect(scene, {}, meshes);
  const auto hit = pick(list, {{0.5f, 0, 9}, {0, 0, -1}});
  REQUIRE(hit);
  CHECK(hit->point == glm::dvec3(0.5, 0, -3));
  CHECK(hit->normal == glm::dvec3(0, 0, 1));
  CHECK(hit->texture_coordinate == glm::vec2(0.625f, 0.5f));
  std::string names;
  const auto path = path_of(list, *hit);
  for (const vrml::PathStep& step : path) names += step.scene->node(step.node).type->name + ' ';
  CHECK(names == "Transform Switch Inline Transform Shape ");
  REQUIRE(path.size() == 5);
  const glm::dmat4 moved = glm::translate(glm::dmat4(1), {0, 0, -5});
  CHECK(path[0].world_from_parent == glm::dmat4(1));
  CHECK(path[2].world_from_parent == moved);
  CHECK(path[3].world_from_parent == moved);
  CHECK(path[4].world_from_parent == glm::scale(moved, {2, 2, 2}));
  render::RenderList nowhere;
  nowhere.items.emplace_back();
  CHECK(path_of(nowhere, Hit{}).empty());
}

TEST_CASE("directs a line of sight like the ray through the same pixel") {
  Pose pose;
  pose.orientation = glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3)));
  for (const glm::vec2& pointer : {glm::vec2(0, 0), glm::vec2(320, 100), glm::vec2(-9, 700)}) {
    const Ray ray = ray_through(pose, pointer, {640, 200});
    const render::SightLine line = sight_line(pose, pointer, {640, 200});
    CHECK(glm::distance(glm::vec3(line.direction), ray.direction) < 1e-5f);
    CHECK(line.origin == ray.origin);
  }
}
