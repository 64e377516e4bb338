#include "app/inspect/selection_marks.h"

#include "render/scene/render_list.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace gs::app::selection_marks_test {

// The smaller side of the picture has the field of view (VRML97 6.53).
TEST_CASE("draws the edges of a box where the viewer sees them") {
  Pose pose;
  pose.position = {0, 0, 10};
  pose.field_of_view = static_cast<float>(2 * std::atan(0.5));
  const Viewport viewport{100, 50, 400, 200};
  // At z = 0, ten metres away, 200 pixels are ten metres.
  const std::vector<PixelLine> lines = edges_of({{-1, -1, 0}, {1, 1, 0}}, pose, viewport);
  CHECK(lines.size() == 12);
  for (const auto& [a, b] : lines)
    for (const glm::vec2& end : {a, b}) {
      CHECK(std::abs(end.x - 300) == Approx(20));
      CHECK(std::abs(end.y - 150) == Approx(20));
    }
}

TEST_CASE("draws the circles of a sphere around its projected centre") {
  Pose pose;
  pose.position = {0, 0, 10};
  pose.field_of_view = static_cast<float>(2 * std::atan(0.5));
  const Viewport viewport{100, 50, 400, 200};
  const glm::dmat4 moved = glm::translate(glm::dmat4(1), glm::dvec3(1, 0, 0));
  const std::vector<PixelLine> lines = circles_of({-1, 0, 0}, 2, pose, viewport, moved);
  CHECK(lines.size() == 3 * 48);
  float most = 0;
  for (const auto& [a, b] : lines) most = std::max({most, std::abs(a.x - 300), std::abs(a.y - 150)});
  CHECK(most > 40);  // the circle at z = 0 has a radius of 40 pixels, and nearer points are farther out
  CHECK(most < 43);
  CHECK(circles_of({0, 0, 20}, 2, pose, viewport, glm::dmat4(1)).empty());
}

TEST_CASE("drops edges behind the viewer, and cuts edges that pass the viewer") {
  Pose pose;
  pose.position = {0, 0, 0};
  const Viewport viewport{0, 0, 100, 100};
  CHECK(edges_of({{-1, -1, 5}, {1, 1, 6}}, pose, viewport).empty());
  const std::vector<PixelLine> inside = edges_of({{-1, -1, -5}, {1, 1, 5}}, pose, viewport);
  CHECK(inside.size() == 8);  // four edges in front of the viewer, and four that pass the viewer
  for (const auto& [a, b] : inside) CHECK((std::isfinite(a.x) && std::isfinite(b.x)));
  CHECK(edges_of({}, pose, viewport).empty());
}

TEST_CASE("computes the bounds of a node over all its instances, and of the first visible one") {
  const LoadedWorld world = world_of(
      "DEF Two Group { children [ DEF One Shape { geometry DEF Box Box {} } Transform { translation 4 0 0 children USE "
      "One } ] } DEF Sensor TimeSensor {} PROTO P [] { Transform { translation 0 9 0 children Shape { geometry Box {} "
      "} } } "
      "DEF Made P {}");
  render::MeshCache meshes;
  const render::RenderList list = render::collect(*world.scene, {}, meshes);
  const auto node = [&](std::string_view name) -> NodeAt {
    for (std::uint32_t i = 1; i <= world.scene->nodes().count(); ++i)
      if (world.scene->nodes().at(i).name == name) return {world.scene.get(), world.scene->nodes().id_at(i)};
    return {};
  };
  const auto bounds = [&](std::vector<NodeAt> nodes) { return bounds_in(list, nodes); };
  CHECK(bounds({node("One")}).upper.x == Approx(5));
  CHECK(bounds({node("One")}).lower.x == Approx(-1));
  CHECK(bounds({node("Two")}).upper.x == Approx(5));
  CHECK(bounds({node("Box"), node("One"), node("Two")}).upper.y == Approx(1));
  CHECK(bounds({node("Made")}).lower.y == Approx(8));
  CHECK(bounds({node("Sensor")}).empty());
}

}  // namespace gs::app::selection_marks_test
