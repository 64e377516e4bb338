#include "app/view/picking.h"

#include "render/collection/render_scene.h"
#include "vrml/events/execution.h"
#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

using namespace gs;
using namespace gs::app;

namespace {

/// Running world with a render list that follows its changes, and the cached geometry of its sensors.
class World {
 public:
  explicit World(const std::string& body) : scene_("text.wrl") {
    Diagnostics diagnostics;
    (void)vrml::parse("#VRML V2.0 utf8\n" + body, scene_, diagnostics);
    REQUIRE(diagnostics.errors() == 0);
    execution_ = std::make_unique<vrml::Execution>(scene_);
    names_ = std::make_unique<vrml::NodeNames>(scene_);
    render_ = std::make_unique<render::RenderScene>(scene_, images_, geometries_, meshes_);
    execution_->start(1000);
    (void)execution_->changes().take();
    render_->gather({}, {0, 0, 10});
  }
  template <class T>
  void send(const std::string& node, const std::string& event, T value) {
    const vrml::NodeId id = names_->find(node);
    execution_->step(execution_->now() + 1);
    CHECK(
        execution_->send(scene_, id, *scene_.node(id).type->find_event_in(event), vrml::FieldValue(std::move(value))));
    const auto changes = execution_->changes().take();
    (void)render_->update(changes, {}, {0, 0, 10});
  }
  /// Returns each sensor with the number of its items. Checks that the cache has the fresh result.
  std::string sensors() {
    std::string text;
    const auto& known = cache_.of(*execution_, render_->list());
    const auto fresh = sensor_geometry(*execution_, render_->list());
    CHECK(known.size() == fresh.size());
    for (std::size_t i = 0; i < std::min(known.size(), fresh.size()); ++i) {
      CHECK(known[i].items == fresh[i].items);
      text += std::string(scene_.node(known[i].sensor.node).name) + std::to_string(known[i].items.size()) + ' ';
    }
    return text;
  }
  vrml::NodeId node(const std::string& name) { return names_->find(name); }
  [[nodiscard]] const render::RenderList& list() const { return render_->list(); }

 private:
  vrml::SceneGraph scene_;
  render::Images images_;
  render::Geometries geometries_;
  render::MeshCache meshes_;
  std::unique_ptr<vrml::Execution> execution_;
  std::unique_ptr<vrml::NodeNames> names_;
  std::unique_ptr<render::RenderScene> render_;
  SensorGeometries cache_;
};

}  // namespace

TEST_CASE("keeps the geometry of sensors up to date while sensors and children change") {
  World world(
      "DEF A TouchSensor { } Shape { geometry Box { } } DEF G Group { children [ DEF B TouchSensor { enabled FALSE } "
      "Shape "
      "{ geometry Box { } } Shape { geometry Cone { } } ] } DEF T Transform { } DEF C PlaneSensor { }");
  CHECK(world.sensors() == "A3 C3 ");
  world.send("B", "set_enabled", true);
  CHECK(world.sensors() == "A1 C1 B2 ");
  world.send("T", "set_translation", vrml::SFVec3f(1, 0, 0));
  CHECK(world.sensors() == "A1 C1 B2 ");
  world.send("G", "removeChildren", vrml::MFNode{world.node("B")});
  CHECK(world.sensors() == "A3 C3 ");
  world.send("T", "addChildren", vrml::MFNode{world.node("B"), world.node("G")});
  CHECK(world.sensors().find("B2") != std::string::npos);
}

TEST_CASE("copies the places above the chosen items only") {
  World world(
      "Transform { translation 1 0 0 children Transform { translation 2 0 0 children [ Shape { geometry Box { } } DEF "
      "S "
      "Shape { geometry Cone { } } ] } } Shape { geometry Sphere { } }");
  const render::RenderList some = only(world.list(), {1, 2});
  REQUIRE(some.items.size() == 2);
  CHECK(some.places.size() == 4);
  Hit hit;
  hit.item = 0;
  const std::vector<vrml::PathStep> path = path_of(some, hit);
  REQUIRE(path.size() == 3);
  CHECK(path[2].node == world.node("S"));
  CHECK(path[2].world_from_parent[3].x == 3);
  CHECK(path[1].world_from_parent[3].x == 1);
  hit.item = 1;
  CHECK(path_of(some, hit).size() == 1);
}
