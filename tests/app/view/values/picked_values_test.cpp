#include "app/view/values/picked_values.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace gs::app::picked_values_test {

TEST_CASE("returns the value of the nearest vector in a volume stream") {
  qnv::Volume geometry;
  CHECK_FALSE(value_near(geometry, {0, 0, 0}));
  geometry.description.value_range = {-100, 155};
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  geometry.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  geometry.weights = {0.5f, 2, 8};
  CHECK_FALSE(value_near(geometry, {0, 0, 0}));  // colours without a key have no values
  geometry.classes = {0, 128, 255};
  REQUIRE(value_near(geometry, {0, 0, 0}));
  CHECK(value_near(geometry, {0.4, 0, 0})->value == -100);
  CHECK(value_near(geometry, {0.6, 0, 0})->value == 28);
  CHECK(value_near(geometry, {0.6, 0, 0})->gradient == 2);
  CHECK(value_near(geometry, {0, 50, 0})->value == 155);
  CHECK(value_near(geometry, {0, 50, 0})->step == 1);
  // Vectors with NaN positions are skipped.
  geometry.positions[0].x = std::nanf("");
  CHECK(value_near(geometry, {0, 0, 0})->value == 28);
  CHECK_FALSE(value_near(geometry, {std::nan(""), 0, 0}));
}

TEST_CASE("interpolates the value on a coloured surface between the corners") {
  ColorKey key{"t", 0, 100, {{0, 0, 1}, {0, 1, 1}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}};
  vrml::Mesh mesh;
  mesh.indices = {0, 1, 2, 2, 1, 3};
  CHECK_FALSE(value_on(key, mesh, {1, 0, {1, 0, 0}}));  // no colours
  for (const double value : {0, 20, 100, 60}) mesh.colors.push_back(key.color_of(value));
  CHECK(*value_on(key, mesh, {1, 0, {1, 0, 0}}) == Approx(0).margin(1e-4));
  CHECK(*value_on(key, mesh, {1, 0, {0.5, 0.25, 0.25}}) == Approx(30));
  CHECK(*value_on(key, mesh, {1, 1, {0, 0.5, 0.5}}) == Approx(40));
  CHECK_FALSE(value_on(key, mesh, {1, 2, {1, 0, 0}}));
  mesh.indices = {9, 1, 2};
  CHECK_FALSE(value_on(key, mesh, {1, 0, {1, 0, 0}}));
}

}  // namespace gs::app::picked_values_test
