#include "app/view/derived/volume_scene.h"

#include "tests/app/view/derived/volume_balls.h"

#include <catch2/catch.hpp>

#include <memory>

namespace gs::app::volume_scene_test {

TEST_CASE("replaces the vectors of a volume in a render list, and adds a surface or a projection") {
  render::RenderList list;
  list.changes = render::next_change();
  qnv::Volume volume{qnv::GeometryBase{}};
  list.splats.resize(2);
  list.splats[0].geometry = std::make_shared<const qnv::Geometry>(volume);
  list.splats[1].geometry = std::make_shared<const qnv::Geometry>(qnv::Splats(qnv::GeometryBase{}));
  const glm::dmat4 place(2.0);
  VolumeScene scene;
  CHECK(&scene.with_content(list, place, {}) == &list);

  VolumeContent content;
  content.vectors = std::make_shared<const qnv::Geometry>(volume);
  const render::RenderList& shared = scene.with_content(list, place, content);
  REQUIRE(shared.splats.size() == 2);
  CHECK(shared.splats[0].geometry == content.vectors);
  CHECK(shared.splats[1].geometry == list.splats[1].geometry);
  const std::uint64_t changes = shared.changes;
  CHECK(changes != list.changes);
  CHECK(scene.with_content(list, place, content).changes == changes);

  content = {};
  content.surface = std::make_shared<const vrml::Mesh>();
  content.surface_color = {1, 0, 0};
  content.hides_vectors = true;
  content.clip = glm::dvec4(0, 0, 1, 0);
  const render::RenderList& surface = scene.with_content(list, place, content);
  CHECK(surface.changes != changes);
  CHECK(surface.splats.size() == 1);  // only the volume is hidden
  REQUIRE(surface.items.size() == 1);
  CHECK(surface.items[0].mesh == content.surface);
  CHECK(surface.items[0].material.diffuse == glm::vec3(1, 0, 0));
  CHECK(surface.items[0].world_from_node == place);
  REQUIRE(surface.items[0].clip_planes.size() == 1);
  CHECK(surface.clip_planes[surface.items[0].clip_planes[0]] == *content.clip);

  const auto grid = test_balls::grid_of(test_balls::ball(5));
  content = {};
  content.projection = std::get<0>(projection_of(*grid, {}, own_budget()));
  const render::RenderList& projection = scene.with_content(list, place, content);
  CHECK(projection.splats.size() == 1);
  REQUIRE(projection.items.size() == 1);
  CHECK(projection.items[0].volume == content.projection->look);
  CHECK(projection.items[0].world_from_node == place * content.projection->volume_from_box);
  CHECK(projection.items[0].clip_planes.empty());
}

}  // namespace gs::app::volume_scene_test
