#include "render/rays/item_bvh.h"

#include <catch2/catch.hpp>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace gs;
using render::ItemBvh;
using render::MeshBvh;
using render::SightLine;

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

class Source {
 public:
  explicit Source(unsigned seed) : engine_(seed) {}
  double number(double least, double most) { return std::uniform_real_distribution<double>(least, most)(engine_); }
  std::uint32_t below(std::size_t count) {
    return static_cast<std::uint32_t>(std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_));
  }
  glm::dvec3 place(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  SightLine line(double size) { return {place(3 * size), place(1)}; }

 private:
  std::mt19937 engine_;
};

void set_bounds(vrml::Mesh& mesh) {
  for (const std::uint32_t i : mesh.indices) mesh.bounds.add(mesh.positions[i]);
}

// Returns triangles of sizes over several orders of magnitude, including thin, flat and repeated ones.
vrml::Mesh soup(Source& source, std::size_t triangles) {
  vrml::Mesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const glm::dvec3 middle = source.place(1);
    const double size = std::pow(10.0, source.number(-3, 0));
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(glm::vec3(middle + source.place(size)));
    for (std::uint32_t k = 0; k < 3; ++k)
      mesh.indices.push_back(static_cast<std::uint32_t>(source.below(20) == 0 ? 3 * i : 3 * i + k));
    if (source.below(10) == 0)
      for (std::uint32_t k = 0; k < 3; ++k) mesh.indices.push_back(static_cast<std::uint32_t>(3 * i + k));
  }
  set_bounds(mesh);
  return mesh;
}

std::shared_ptr<vrml::Mesh> grid(int side, double height) {
  auto mesh = std::make_shared<vrml::Mesh>();
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x)
      mesh->positions.push_back({x, y, static_cast<float>(height * std::sin(x * 0.7) * std::cos(y * 0.3))});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto corner = static_cast<std::uint32_t>(y * (side + 1) + x);
      const auto above = corner + static_cast<std::uint32_t>(side) + 1;
      for (const std::uint32_t i : {corner, corner + 1, above + 1, corner, above + 1, above})
        mesh->indices.push_back(i);
    }
  set_bounds(*mesh);
  return mesh;
}

void check_same(const vrml::Mesh& mesh, const MeshBvh& tree, const SightLine& line) {
  const auto found = tree.nearest(mesh, line), wanted = render::nearest_of_all(mesh, line);
  REQUIRE(found.has_value() == wanted.has_value());
  if (!found) return;
  CHECK(found->distance == wanted->distance);
  CHECK(found->triangle == wanted->triangle);
  CHECK(found->weights == wanted->weights);
}

}  // namespace

TEST_CASE("finds in a tree of triangles the result of a full search") {
  Source source(7);
  for (const std::size_t triangles : {1, 20, 33, 100, 1000, 5000}) {
    const vrml::Mesh mesh = soup(source, triangles);
    const MeshBvh tree(mesh);
    CHECK(tree.bytes() <= 26 * mesh.indices.size() / 3);
    for (int i = 0; i < 300; ++i) {
      SightLine line = source.line(1);
      if (i % 3 == 0) line.direction = glm::dvec3(source.place(1)) - line.origin;
      if (i % 5 == 0) line.direction[static_cast<int>(source.below(3))] = 0;
      if (i % 7 == 0) line.farthest = source.number(0, 2);
      check_same(mesh, tree, line);
    }
  }
}

TEST_CASE("meets a flat grid with lines along axes, edges and corners") {
  const auto mesh = grid(40, 0);
  const MeshBvh tree(*mesh);
  for (int y = 0; y <= 80; ++y)
    for (int x = 0; x <= 80; ++x) {
      const auto hit = tree.nearest(*mesh, {{x * 0.5, y * 0.5, 3}, {0, 0, -2}});
      REQUIRE(hit);
      CHECK(hit->distance == 1.5);
    }
  CHECK_FALSE(tree.nearest(*mesh, {{3, 3, 0}, {1, 0, 0}}));  // in its plane
  CHECK_FALSE(tree.nearest(*mesh, {{3, 3, 3}, {0, 0, 1}}));
  CHECK_FALSE(tree.nearest(*mesh, {{41, 3, 3}, {0, 0, -1}}));
  CHECK_FALSE(tree.nearest(*mesh, {{3, 3, 3}, {0, 0, -1}, 2.9}));
}

TEST_CASE("builds a tree of NaN, huge and coincident triangles") {
  Source source(8);
  vrml::Mesh mesh = soup(source, 500);
  const float endless = std::numeric_limits<float>::infinity(), huge = std::numeric_limits<float>::max();
  const auto spoil = [&](float number) {
    for (int i = 0; i < 40; ++i)
      mesh.positions.mutable_data()[source.below(mesh.positions.size())][static_cast<int>(source.below(3))] = number;
  };
  spoil(kNoNumber);
  spoil(endless);
  const MeshBvh broken(mesh);
  for (int i = 0; i < 500; ++i) check_same(mesh, broken, source.line(1));
  spoil(huge);
  spoil(-huge);
  const MeshBvh vast(mesh);  // the hits on such triangles depend on rounding
  for (int i = 0; i < 500; ++i)
    if (const auto hit = vast.nearest(mesh, source.line(1))) CHECK(hit->distance >= 0);
  vrml::Mesh same;
  same.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (std::uint32_t i = 0; i < 30'000; ++i) same.indices.push_back(i % 3);
  set_bounds(same);
  const MeshBvh tree(same);
  CHECK(tree.bytes() <= 26 * 10'000);
  const auto hit = tree.nearest(same, {{0.25, 0.25, 1}, {0, 0, -1}});
  REQUIRE(hit);
  CHECK(hit->triangle == 0);
  CHECK(hit->weights == glm::dvec3(0.5, 0.25, 0.25));
  // Sizes that grow by powers of ten split badly. The depth must stay bounded.
  vrml::Mesh growing;
  for (std::uint32_t i = 0; i < 3 * 5000; ++i) {
    growing.positions.push_back(glm::vec3(std::pow(1.017, i / 3), i % 3 == 1 ? 1 : 0, i % 3 == 2 ? 1 : 0));
    growing.indices.push_back(i);
  }
  set_bounds(growing);
  const MeshBvh deep(growing);
  for (const double size : {1.0, 1e3, 1e20}) check_same(growing, deep, {{-1, 0.2, 0.2}, {size, 0, 0}});
}

TEST_CASE("returns the nearest item with its point, normal and texture coordinate in world space") {
  render::RenderList list;
  ItemBvh rays;
  CHECK_FALSE(rays.nearest(list, {}));
  const auto plane = grid(10, 0);
  const auto add = [&](const glm::mat4& place) {
    list.items.emplace_back();
    list.items.back().mesh = plane;
    list.items.back().world_from_node = place;
  };
  add(glm::translate(glm::mat4(1), {0, 0, -9}));
  add(glm::scale(glm::translate(glm::mat4(1), {0, 0, -4}), {1, 2, -3}));
  add(glm::mat4(0.0f));
  add(glm::mat4(kNoNumber));
  const auto hit = rays.nearest(list, {{2.5, 5, 0}, {0, 0, -1}});
  REQUIRE(hit);
  CHECK(hit->item == 1);
  CHECK(hit->triangle.distance == 4);
  CHECK(hit->point == glm::dvec3(2.5, 5, -4));
  CHECK(hit->normal == glm::dvec3(0, 0, -1));  // mirrored: front and back swap
  CHECK(hit->texture_coordinate == glm::vec2(0.25f, 0.25f));
  // The hit item moves away, and another item is added.
  list.items[1].world_from_node = glm::translate(glm::mat4(1), {50, 0, -4});
  CHECK(rays.nearest(list, {{2.5, 5, 0}, {0, 0, -1}})->item == 0);
  auto smooth = std::make_shared<vrml::Mesh>(*grid(10, 0));
  for (std::size_t i = 0; i < smooth->positions.size(); ++i) {
    smooth->normals.push_back({0.6f, 0, 0.8f});
    smooth->texture_coordinates.push_back({smooth->positions[i].x * 2, 7});
  }
  list.items[2].mesh = smooth;
  list.items[2].world_from_node = glm::rotate(glm::mat4(1), glm::radians(-90.0f), {0, 0, 1});
  const auto turned = rays.nearest(list, {{2.5, -2.5, 5}, {0, 0, -1}});
  REQUIRE(turned);
  CHECK(turned->item == 2);
  CHECK(glm::distance(turned->normal, glm::dvec3(0, -0.6, 0.8)) < 1e-6);
  CHECK(glm::distance(turned->texture_coordinate, glm::vec2(5, 7)) < 1e-5f);
  list.items[2].mesh = nullptr;
  CHECK(rays.nearest(list, {{2.5, -2.5, 5}, {0, 0, -1}}) == std::nullopt);
  const double nan = kNoNumber;
  for (const SightLine& line :
       {SightLine{{nan, 0, 0}, {0, 0, -1}}, SightLine{{2.5, 5, 0}, {0, 0, 0}}, SightLine{{2.5, 5, 0}, {0, 0, nan}}})
    CHECK_FALSE(rays.nearest(list, line));
}

TEST_CASE("finds items at their present positions after any moves") {
  Source source(9);
  std::vector<std::shared_ptr<const vrml::Mesh>> meshes;
  for (int i = 0; i < 5; ++i) meshes.push_back(std::make_shared<vrml::Mesh>(soup(source, 10 + 40 * i)));
  render::RenderList list;
  list.items.resize(60);
  const auto set = [&](render::DrawItem& item) {
    item.mesh = meshes[source.below(meshes.size())];
    item.world_from_node = glm::mat4(glm::rotate(glm::translate(glm::dmat4(1), source.place(8)), source.number(0, 6),
                                                 glm::normalize(source.place(1) + 2.0)));
  };
  for (render::DrawItem& item : list.items) set(item);
  ItemBvh rays;
  for (int round = 0; round < 200; ++round) {
    for (int i = 0; i < 3; ++i) set(list.items[source.below(list.items.size())]);
    if (round % 50 == 49) set(list.items.emplace_back());
    const SightLine line = source.line(8);
    const auto found = rays.nearest(list, line);
    const auto wanted = ItemBvh().nearest(list, line);
    double nearest = std::numeric_limits<double>::infinity();
    for (const render::DrawItem& item : list.items) {
      const glm::dmat4 inside = glm::inverse(glm::dmat4(item.world_from_node));
      if (const auto hit = render::nearest_of_all(
              *item.mesh, {inside * glm::dvec4(line.origin, 1), inside * glm::dvec4(line.direction, 0)}))
        nearest = std::min(nearest, hit->distance);
    }
    REQUIRE(found.has_value() == std::isfinite(nearest));
    REQUIRE(wanted.has_value() == found.has_value());
    if (found) CHECK(found->triangle.distance == nearest);
    if (found) CHECK(found->item == wanted->item);
  }
}

TEST_CASE("limits the cached trees of meshes, and drops them with their meshes") {
  render::RenderList list;
  ItemBvh rays;
  for (int i = 0; i < 3; ++i) {
    list.items.emplace_back();
    list.items.back().mesh = grid(10, 1);  // 200 triangles
    list.items.back().world_from_node = glm::translate(glm::mat4(1), {20 * i, 0, 0});
  }
  const auto look = [&](int i, std::size_t most) {
    return rays.nearest(list, {{20 * i + 5, 5, 9}, {0, 0, -1}}, most).has_value();
  };
  CHECK_FALSE(look(0, 199));
  CHECK(rays.bytes() == 0);
  CHECK(look(0, 400));
  const std::size_t one = rays.bytes();
  CHECK(one > 0);
  CHECK(look(1, 400));
  CHECK(look(2, 400));
  CHECK(rays.bytes() <= 2 * one);
  list.items.clear();
  CHECK_FALSE(rays.nearest(list, {}));
  CHECK(rays.bytes() == 0);
}
