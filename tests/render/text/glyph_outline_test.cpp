#include "render/text/glyph_outline.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gs::render::glyph_outline_test {
namespace {

std::vector<glm::dvec2> square(double x, double y, double side, bool clockwise = false) {
  std::vector<glm::dvec2> corners{{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
  if (clockwise) std::reverse(corners.begin(), corners.end());
  return corners;
}

std::vector<glm::dvec2> circle(double x, double y, double radius, int corners, bool clockwise = false) {
  std::vector<glm::dvec2> result;
  for (int i = 0; i < corners; ++i) {
    const double angle = (clockwise ? -2 : 2) * std::numbers::pi * i / corners;
    result.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
  }
  return result;
}

double area_of(const std::vector<glm::dvec2>& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return std::abs(sum) / 2;
}

/// Checks that all triangles are counter-clockwise, and returns their total area.
double filled(const Contours& contours) {
  vrml::PolygonTriangulator triangulator;
  const vrml::GlyphShape shape = fill(contours, triangulator);
  REQUIRE(shape.triangles.size() % 3 == 0);
  double sum = 0;
  for (std::size_t i = 0; i < shape.triangles.size(); i += 3) {
    glm::dvec2 p[3];
    for (std::size_t k = 0; k < 3; ++k) {
      REQUIRE(shape.triangles[i + k] < shape.points.size());
      p[k] = glm::dvec2(shape.points[shape.triangles[i + k]]);
    }
    const double area = ((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x)) / 2;
    CHECK(area > -1e-9);
    sum += area;
  }
  return sum;
}

}  // namespace

TEST_CASE("fills contours of either orientation") {
  CHECK(filled({square(0, 0, 2)}) == Approx(4));
  CHECK(filled({square(0, 0, 2, true)}) == Approx(4));
  CHECK(filled({}) == 0);
  CHECK(filled({{{0, 0}, {1, 1}}}) == 0);
  CHECK(filled({{{0, 0}, {1, 1}, {2, 2}}}) == 0);
}

TEST_CASE("makes holes of contours of the other orientation, and fills contours inside them") {
  for (const bool turn : {false, true}) {
    CHECK(filled({square(0, 0, 10, turn), square(1, 1, 3, !turn)}) == Approx(91));
    // The holes are side by side, above each other and one after the other. Cuts must not cross them.
    CHECK(filled({square(0, 0, 10, turn), square(1, 1, 2, !turn), square(4, 1, 2, !turn), square(7, 1, 2, !turn),
                  square(1, 6, 2, !turn), square(4, 5, 2, !turn), square(7, 7, 2, !turn)}) == Approx(100 - 24));
    CHECK(filled({square(0, 0, 10, turn), square(2, 2, 6, !turn), square(4, 4, 2, turn)}) == Approx(100 - 36 + 4));
    // The order has no effect.
    CHECK(filled({square(4, 4, 2, turn), square(2, 2, 6, !turn), square(0, 0, 10, turn)}) == Approx(68));
    const auto ring = circle(0, 0, 4, 37, turn), inner = circle(0.5, 0, 3, 23, !turn);
    CHECK(filled({ring, inner}) == Approx(area_of(ring) - area_of(inner)));
  }
}

TEST_CASE("fills the inside of a contour of equal orientation once") {  // non-zero winding
  CHECK(filled({square(0, 0, 10), square(2, 2, 3)}) == Approx(100));
  CHECK(filled({square(0, 0, 1), square(5, 0, 1)}) == Approx(2));
}

TEST_CASE("connects many holes by cuts to the same corner") {
  Contours contours{{{0, 0}, {20, 5}, {0, 10}}};
  double expected = 100;
  for (int i = 0; i < 8; ++i) {
    contours.push_back(square(1 + i * 0.9, 4.8, 0.4, true));
    expected -= 0.16;
  }
  CHECK(filled(contours) == Approx(expected));
}

TEST_CASE("simplifies a contour within the tolerance to fewer corners") {
  const auto fine = circle(0, 0, 1, 1000);
  for (const double tolerance : {0.001, 0.01, 0.1}) {
    const auto coarse = simplified(fine, tolerance);
    CHECK(coarse.size() < fine.size() / 7);
    CHECK(coarse.size() >= 3);
    // Corners are on the circle; points between them are within the tolerance.
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      CHECK(glm::length(coarse[i]) == Approx(1));
      CHECK(glm::length((coarse[i] + coarse[(i + 1) % coarse.size()]) * 0.5) >= 1 - tolerance - 1e-9);
    }
  }
  CHECK(simplified(square(0, 0, 1), 0.01).size() == 4);
  CHECK(simplified(square(0, 0, 0.001), 0.01).size() == 3);  // thinner than the tolerance, but kept
  CHECK(simplified({}, 0.01).empty());
  CHECK(simplified({{1, 1}, {1, 1}, {1, 1}, {1, 1}}, 0.01).size() <= 4);
}

}  // namespace gs::render::glyph_outline_test
