#include "qnv/mesh/survey.h"
#include "tests/qnv/surface_shapes.h"

#include <catch2/catch.hpp>

#include <limits>
#include <span>

namespace gs::qnv::survey_test {

TEST_CASE("averages the colours of a surface by area") {
  const glm::vec3 o(0), x(1, 0, 0), y(0, 1, 0);
  SurfaceSurvey survey;
  survey.add(Triangles{triangle_of(o, x, y, {200, 40, 0})});
  CHECK(!survey.colored);
  CHECK(survey.mean_color() == Rgb8{200, 40, 0});
  survey.add(Triangles{triangle_of(o, 3.0f * x, y, {100, 80, 40})});  // a triangle three times as large
  CHECK(survey.colored);
  CHECK(survey.mean_color() == Rgb8{125, 70, 30});
  // Triangles that are not finite do not count.
  survey.add(Triangles{triangle_of(o, x, glm::vec3(std::numeric_limits<float>::infinity()), {0, 0, 255})});
  CHECK(survey.mean_color() == Rgb8{125, 70, 30});
}

TEST_CASE("gives a surface without area the colour of its first corner") {
  SurfaceSurvey survey;
  survey.add(Triangles{triangle_of(glm::vec3(0), glm::vec3(1), glm::vec3(2), {1, 2, 3}),
                       triangle_of(glm::vec3(0), glm::vec3(1), glm::vec3(2), {9, 9, 9})});
  CHECK(survey.colored);
  CHECK(survey.mean_color() == Rgb8{1, 2, 3});
}

TEST_CASE("adds the statistics of parts of a surface") {
  const Triangles ball = sphere(8, 2, {1, 2, 3}, true);
  SurfaceSurvey whole, parts, empty;
  whole.add(ball);
  for (const std::size_t first : {std::size_t{0}, ball.size() / 3}) {
    SurfaceSurvey part;
    part.add(std::span(ball).subspan(first, first == 0 ? ball.size() / 3 : ball.size() - first));
    parts.add(part);
    parts.add(empty);
  }
  CHECK(parts.triangles == whole.triangles);
  CHECK(parts.box.lower == whole.box.lower);
  CHECK(parts.box.upper == whole.box.upper);
  CHECK(parts.area == Approx(whole.area));
  CHECK(parts.volume == Approx(whole.volume));
  CHECK(parts.colored);
  CHECK(parts.color == whole.color);
  // Two parts of one colour each have two colours together.
  SurfaceSurvey red, blue;
  red.add(Triangles{triangle_of({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {255, 0, 0})});
  blue.add(Triangles{triangle_of({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 255})});
  red.add(blue);
  CHECK(red.colored);
}

}  // namespace gs::qnv::survey_test
