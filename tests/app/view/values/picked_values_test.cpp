#include "app/view/values/picked_values.h"

#include "tests/app/view/derived/volume_balls.h"

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

TEST_CASE("returns the projected value along a ray through a volume") {
  const auto grid = test_balls::grid_of(test_balls::ball(21));
  const glm::dmat4 same(1.0);
  const glm::dvec3 middle = glm::dvec3(3, 0, 0) + glm::dvec3(5), ahead(0, 0, -1);
  const auto at = [&](VolumeMode mode, const glm::dvec3& off) {
    return projected_value(*grid, mode, same, middle + off + glm::dvec3(0, 0, 50), ahead);
  };
  const auto most = at(VolumeMode::maximum, {0, 0, 0});
  REQUIRE(most);
  CHECK(most->value == 100);
  CHECK(most->voxel->z == Approx(10).margin(0.5));
  CHECK(at(VolumeMode::maximum, {1, 0, 0})->value == Approx(80));
  CHECK(at(VolumeMode::minimum, {0, 0, 0})->value == 0);
  const auto average = at(VolumeMode::average, {0, 0, 0});
  CHECK(average->value == Approx(100 * 10.0 / 21).margin(2));
  CHECK_FALSE(average->voxel);
  CHECK_FALSE(at(VolumeMode::maximum, {6, 0, 0}));
  CHECK_FALSE(projected_value(*grid, VolumeMode::maximum, same, middle + glm::dvec3(0, 0, 50), -ahead));
  // From inside, only values ahead count.
  CHECK(projected_value(*grid, VolumeMode::maximum, same, middle - glm::dvec3(0, 0, 2), ahead)->value <= 60.1);
  CHECK_FALSE(projected_value(*grid, VolumeMode::maximum, same, {std::nan(""), 0, 0}, ahead));
}

}  // namespace gs::app::picked_values_test
