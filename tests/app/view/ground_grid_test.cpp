#include "app/view/ground_grid.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

// Tests of the grid on the ground.
namespace gs::app::ground_grid_test {

namespace {

WideBox box(const glm::vec3& lower, const glm::vec3& upper) { return {lower, upper}; }

}  // namespace

TEST_CASE("draws a grid of 1, 2 or 5 units with about ten squares below the objects") {
  for (double size = 1e-5; size < 1e6; size *= 1.37) {
    const auto half = static_cast<float>(size / 2);
    const double spacing = grid_spacing(box({-half, 0, -half}, {half, half / 10, half}), {});
    const double squares = size / spacing, power = std::pow(10.0, std::round(std::log10(spacing) - 0.3));
    INFO(size);
    CHECK(squares > 6.5);
    CHECK(squares < 17);
    const double digit = spacing / power;
    CHECK((std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 || std::abs(digit - 5) < 1e-6 ||
           std::abs(digit - 0.5) < 1e-6 || std::abs(digit - 10) < 1e-5));
  }
  CHECK(grid_spacing({}, {}) == 0);
  CHECK(grid_spacing(box({1, 1, 1}, {1, 1, 1}), {}) == 0);
  CHECK(ground_grid({}, {}) == nullptr);
  constexpr float kMax = std::numeric_limits<float>::max();
  CHECK(ground_grid(box({-kMax, 0, 0}, {kMax, 1, 1}), {}) == nullptr);
  CHECK(ground_grid(box({1e9f, 0, 0}, {1e9f + 64, 1, 1}), {}) != nullptr);
}

TEST_CASE("places the grid below the objects for any up axis, and extends it around them") {
  const WideBox bounds = box({-3, -2, 1}, {4, 5, 8});
  for (const UpAxis axis : {UpAxis::y, UpAxis::z, UpAxis::minus_y, UpAxis::x}) {
    const Upright upright = upright_of(axis);
    const auto grid = ground_grid(bounds, upright);
    REQUIRE(grid);
    float ground = std::numeric_limits<float>::infinity();
    for (const glm::vec3 corner : {glm::vec3(bounds.lower), glm::vec3(bounds.upper)})
      ground = std::min(ground, glm::dot(corner, upright.up));
    for (const render::DrawItem& item : grid->items) {
      CHECK(item.mesh->primitive == vrml::Mesh::Primitive::lines);
      for (std::size_t i = 0; i < item.mesh->positions.size(); ++i)
        CHECK(std::abs(glm::dot(glm::vec3(item.world_from_node * glm::dvec4(item.mesh->positions[i], 1)), upright.up) -
                       ground) < 1e-4f);
    }
    const glm::vec3 size = grid->bounds.size();
    CHECK(glm::dot(size, glm::abs(upright.right())) > 7);
    CHECK(glm::dot(size, glm::abs(upright.front)) > 7);
  }
  GroundGrids grids;
  const auto first = grids.of(bounds, {});
  CHECK(grids.of(bounds, {}) == first);
  CHECK(grids.of(bounds, upright_of(UpAxis::z)) != first);
}

}  // namespace gs::app::ground_grid_test
