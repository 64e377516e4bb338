#include "app/picking.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace {

using namespace gs;
using namespace gs::app;

/// A square of side 2 in the plane z = 0.
std::shared_ptr<const vrml::Mesh> square() {
  auto mesh = std::make_shared<vrml::Mesh>();
  mesh->positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  for (const glm::vec3& p : mesh->positions) mesh->bounds.add(p);
  return mesh;
}

render::RenderList list_of(std::initializer_list<glm::mat4> places) {
  render::RenderList list;
  const auto mesh = square();
  for (const glm::mat4& place : places) {
    render::DrawItem item;
    item.mesh = mesh;
    item.world_from_node = place;
    list.items.push_back(item);
  }
  return list;
}
glm::mat4 at(float z) { return glm::translate(glm::mat4(1), {0, 0, z}); }

}  // namespace

TEST_CASE("The nearest face is hit, from either side, whatever the order") {
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

TEST_CASE("Distances are the world's, under scale and rotation") {
  const glm::mat4 place = glm::rotate(glm::scale(at(-4), glm::vec3(3, 2, 5)), 0.4f, glm::vec3(0, 0, 1));
  const auto hit = pick(list_of({place}), {{0.3f, 0.2f, 1}, {0, 0, -1}});
  REQUIRE(hit);
  CHECK(hit->distance == Approx(5));
}

TEST_CASE("Flat, singular, empty and too many are no trouble") {
  render::RenderList list = list_of({glm::mat4(0.0f), at(-2)});
  list.items.emplace_back();
  CHECK(pick(list, {{0, 0, 0}, {0, 0, -1}})->item == 1);
  CHECK_FALSE(pick(list, {{0, 0, 0}, {0, 0, -1}}, 1));
  CHECK_FALSE(pick({}, {}));
}
