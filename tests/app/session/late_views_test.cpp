// Tests of the viewer's position while parts of a world load late.
#include "app/session/session.h"

#include "tests/app/late_worlds.h"
#include "tests/app/one_world.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::late_views_test {
namespace {

using late_worlds::kHeader;
using late_worlds::Site;
using sessions::input_of;
using sessions::key;
using sessions::Kind;

/// Returns a site with small objects at x = -20 and 30. Two Inlines get their urls later.
Site site_with(const std::string& beginning) {
  Site site;
  site.put("world.wrl", kHeader + "Inline { } Inline { } " + beginning + "Shape { geometry Box { } }");
  const auto box_at = [](const std::string& x) {
    return kHeader + "Transform { translation " + x + " 0 0 children Shape { geometry Box { } } }";
  };
  site.put("left.wrl", box_at("-20"));
  site.put("right.wrl", box_at("30"));
  return site;
}

/// Session with its view, and the sequence of the viewer's positions.
struct Watched {
  explicit Watched(const Site& site) : session({{"memory://a/world.wrl"}, {}, {}, false}, site.options, [] {}) {}
  void step(std::vector<WindowEvent> events = {}) {
    (void)session.step(world_time(), input_of(std::move(events)));
    if (const View* seen = session.view(); seen && seen->document->runtime) {
      if (places.empty() || places.back() != seen->navigation.pose.position)
        places.push_back(seen->navigation.pose.position);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  [[nodiscard]] std::size_t items() const {
    const View* seen = session.panes().at(0).view();
    return seen && seen->document->runtime ? seen->list->items.size() : 0;
  }
  void wait_for(std::size_t count) {
    for (int i = 0; i < 10'000 && items() < count; ++i) step();
    REQUIRE(items() == count);
    for (int i = 0; i < 20; ++i) step();
  }
  void set_url(std::size_t root, const std::string& url) {
    Document& document = *session.view()->document;
    const vrml::SceneGraph& scene = *document.world.scene;
    CHECK(document.runtime->send(scene, scene.roots()[root], "set_url", vrml::MFString{vrml::SFString(url)}));
  }

  Session session;
  std::vector<glm::dvec3> places;
};

}  // namespace

TEST_CASE("frames the whole scene again for an unmoved viewer with each loaded part") {
  Watched world(site_with(""));
  world.wait_for(1);
  REQUIRE(world.places.size() == 1);
  world.set_url(0, "left.wrl");
  world.wait_for(2);
  world.set_url(1, "right.wrl");
  world.wait_for(3);
  REQUIRE(world.places.size() == 3);
  CHECK(world.places[1].z > world.places[0].z);
  CHECK(world.places[2].z > world.places[1].z);
  const View& seen = *world.session.view();
  CHECK(glm::distance(world.places.back(), first_pose(seen.list->bounds, seen.home_size).position) < 1e-6);
  CHECK(seen.list->bounds.lower.x == Approx(-21));
  CHECK(seen.list->bounds.upper.x == Approx(31));
}

TEST_CASE("keeps a viewer at a Viewpoint or after a movement in place as parts load") {
  Watched at_viewpoint(site_with("Viewpoint { position 0 0 12 } "));
  at_viewpoint.wait_for(1);
  at_viewpoint.set_url(0, "left.wrl");
  at_viewpoint.wait_for(2);
  CHECK(at_viewpoint.places == std::vector<glm::dvec3>{{0, 0, 12}});
  Watched moved(site_with("NavigationInfo { type [ \"EXAMINE\" \"ANY\" ] } "));
  moved.wait_for(1);
  moved.step({key(Kind::key_down, 'W')});
  for (int i = 0; i < 5; ++i) moved.step();
  moved.step({key(Kind::key_up, 'W')});
  while (moved.session.motion().moving()) moved.step();
  REQUIRE(moved.places.size() > 1);
  const glm::dvec3 place = moved.places.back();
  moved.set_url(1, "right.wrl");
  moved.wait_for(2);
  CHECK(moved.places.back() == place);
}

}  // namespace gs::app::late_views_test
