#include "app/view/derived/overlay_scene.h"

#include <catch2/catch.hpp>

#include <array>

namespace gs::app::overlay_scene_test {

TEST_CASE("draws the content of other lists over a list, without picking or collisions") {
  render::RenderList below, above;
  below.items.resize(2);
  below.lights.resize(3);
  below.bounds.add(glm::dvec3(1, 1, 1));
  below.changes = render::next_change();
  above.items.resize(1);
  above.items[0].directional_lights.push_back(0);
  above.items[0].place = 7;
  above.lights.resize(1);
  above.splats.resize(1);
  above.bounds.add(glm::dvec3(-5, 0, 0));
  above.changes = render::next_change();
  OverlayScene scene;
  CHECK(&scene.with(below, {}) == &below);
  const std::array<const render::RenderList*, 1> others{&above};
  const render::RenderList& both = scene.with(below, others);
  REQUIRE(both.items.size() == 3);
  CHECK(both.splats.size() == 1);
  CHECK(both.items[2].place == render::kNoPlace);
  CHECK_FALSE(both.items[2].touchable);
  CHECK_FALSE(both.items[2].collidable);
  REQUIRE(both.items[2].directional_lights.size() == 1);
  CHECK(both.items[2].directional_lights[0] == 3);
  CHECK(both.bounds.lower.x == -5);
  CHECK(both.bounds.upper.x == 1);
  const std::uint64_t changes = both.changes;
  CHECK(scene.with(below, others).changes == changes);
  above.changes = render::next_change();
  CHECK(scene.with(below, others).changes != changes);
}

}  // namespace gs::app::overlay_scene_test
