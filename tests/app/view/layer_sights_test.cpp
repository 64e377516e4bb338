#include "app/view/layer_sights.h"

#include "app/view/navigation.h"

#include <catch2/catch.hpp>

#include <memory>
#include <utility>
#include <vector>

namespace gs::app::layer_sights_test {
namespace {

render::RenderLayer layer_in(const vrml::ClipBoundary& boundary, bool in_front) {
  auto list = std::make_shared<render::RenderList>();
  list->boundary = boundary;
  render::RenderLayer layer;
  layer.list = std::move(list);
  layer.in_front = in_front;
  return layer;
}

}  // namespace

TEST_CASE("gives one sight for a world without layers") {
  const render::RenderList list;
  const std::vector<LayerSight> sights = layer_sights(list, Pose{}, {10, 20, 100, 50});
  REQUIRE(sights.size() == 1);
  CHECK(sights[0].index == LayerSight::kActive);
  CHECK(sights[0].list == &list);
  CHECK(sights[0].place.left == 10);
  CHECK(sights[0].place.height == 50);
}

TEST_CASE("lists the layers that the pointer can meet from front to back, with their parts of the viewport") {
  render::RenderList list;
  list.layers.push_back(layer_in({0, 1, 0, 1}, false));
  list.layers.push_back(layer_in({0.5, 1, 0, 0.25}, true));
  list.layers.push_back(layer_in({0, 0.5, 0.5, 1}, true));
  list.layers[1].extent = glm::dvec2(2, 2);
  const std::vector<LayerSight> sights = layer_sights(list, Pose{}, {10, 20, 100, 40});
  REQUIRE(sights.size() == 4);
  CHECK(sights[0].index == 2);
  CHECK(sights[1].index == 1);
  CHECK(sights[2].index == LayerSight::kActive);
  CHECK(sights[3].index == 0);
  CHECK(sights[1].place.left == 60);
  CHECK(sights[1].place.top == 50);
  CHECK(sights[1].place.width == 50);
  CHECK(sights[1].place.height == 10);
  CHECK(sights[1].pose.height == 2);
  CHECK(sights[0].pose.height == 0);
}

TEST_CASE("omits layers with pickable FALSE") {
  render::RenderList list;
  list.pickable = false;
  list.layers.push_back(layer_in({0, 1, 0, 1}, true));
  const std::vector<LayerSight> sights = layer_sights(list, Pose{}, {0, 0, 10, 10});
  REQUIRE(sights.size() == 1);
  CHECK(sights[0].index == 0);
}

}  // namespace gs::app::layer_sights_test
