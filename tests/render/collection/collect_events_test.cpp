#include "render/scene/render_list.h"
#include "vrml/events/execution.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>
#include <glm/glm.hpp>

#include <memory>
#include <string>

using namespace gs;
using namespace gs::render;

namespace {

/// Running world with its render list after events.
class LiveWorld {
 public:
  explicit LiveWorld(const std::string& body) : scene_("live.wrl") {
    Diagnostics diagnostics;
    (void)vrml::parse("#VRML V2.0 utf8\n" + body, scene_, diagnostics);
    REQUIRE(diagnostics.errors() == 0);
    execution_ = std::make_unique<vrml::Execution>(scene_);
    execution_->start(time_);
  }
  template <class T>
  RenderList after(std::string_view name, std::string_view event, T value) {
    execution_->step(++time_);
    const vrml::NodeId node = find(name);
    CHECK(execution_->send(scene_, node, *scene_.node(node).type->find_event_in(event),
                           vrml::FieldValue(std::move(value))));
    return now();
  }
  RenderList now() {
    if (!execution_->changes().take().empty()) meshes_.clear();
    const auto bound = [&](const char* type) -> const vrml::Node* {
      const vrml::NodeChange top = execution_->stacks().bound(*vrml::built_in_node_type(type));
      return top.scene ? &top.scene->node(top.node) : nullptr;
    };
    const BoundNodes nodes{bound("Viewpoint"), bound("NavigationInfo"), bound("Background")};
    return collect(scene_, {}, meshes_, {0, 0, 10}, {}, &nodes);
  }
  vrml::NodeId find(std::string_view name) const {
    for (std::uint32_t i = 1; i <= scene_.nodes().count(); ++i)
      if (scene_.nodes().at(i).name == name) return scene_.nodes().id_at(i);
    FAIL("no node named " << name);
    return {};
  }

 private:
  vrml::SceneGraph scene_;
  std::unique_ptr<vrml::Execution> execution_;
  MeshCache meshes_;
  double time_ = 1000;
};

const std::string kSquare =
    "Shape { appearance Appearance { material DEF M Material { } } geometry DEF F IndexedFaceSet { coord DEF C "
    "Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } coordIndex [ 0 1 2 -1 ] } }";

}  // namespace

TEST_CASE("updates lights after events (4.6.6)") {
  LiveWorld world(kSquare + "DEF D DirectionalLight { } DEF P PointLight { }");
  CHECK(world.now().lights.size() == 2);
  CHECK(world.after("P", "set_intensity", vrml::SFFloat{0.25F}).lights[1].intensity == 0.25F);
  CHECK(world.after("P", "set_color", vrml::SFColor{1, 0, 0}).lights[1].color == glm::vec3(1, 0, 0));
  CHECK(world.after("P", "set_location", vrml::SFVec3f(1, 2, 3)).lights[1].location == glm::dvec3(1, 2, 3));
  CHECK(world.after("D", "set_direction", vrml::SFVec3f(0, -2, 0)).lights[0].direction == glm::vec3(0, -1, 0));
  CHECK(world.after("D", "set_on", false).lights.size() == 1);
  CHECK(world.after("D", "set_on", true).items[0].directional_lights.size() == 1);
}

TEST_CASE("updates geometry, its properties and materials after events (4.7, 6.23, 6.27)") {
  LiveWorld world(kSquare +
                  "DEF S Shape { geometry DEF E ElevationGrid { xDimension 2 zDimension 2 height [ 0 0 0 0 ] } }");
  CHECK(world.now().items.at(0).mesh->indices.size() == 3);
  CHECK(world.after("F", "set_coordIndex", vrml::MFInt32{0, 1, 2, 3}).items.at(0).mesh->indices.size() == 6);
  CHECK(world.after("C", "set_point", vrml::MFVec3f{{0, 0, 0}, {7, 0, 0}, {1, 1, 0}, {0, 1, 0}})
            .items.at(0)
            .mesh->bounds.upper.x == 7);
  CHECK(world.after("E", "set_height", vrml::MFFloat{0, 0, 0, 5}).items.at(1).mesh->bounds.upper.y == 5);
  CHECK(world.after("M", "set_diffuseColor", vrml::SFColor{0, 1, 0}).items.at(0).material.diffuse ==
        glm::vec3(0, 1, 0));
  CHECK(world.after("S", "set_geometry", vrml::SFNode{}).items.size() == 1);
}

TEST_CASE("updates the bound Background after events, and uses defaults without one (4.6.10, 6.5)") {
  LiveWorld world("DEF A Background { skyColor 1 0 0 } DEF B Background { skyColor 0 1 0 }");
  CHECK(world.now().background.sky_colors[0] == glm::vec3(1, 0, 0));
  CHECK(world.after("B", "set_bind", true).background.sky_colors[0] == glm::vec3(0, 1, 0));
  CHECK(world.after("B", "set_skyColor", vrml::MFColor{{0, 0, 1}}).background.sky_colors[0] == glm::vec3(0, 0, 1));
  CHECK(world.after("B", "set_bind", false).background.sky_colors[0] == glm::vec3(1, 0, 0));
  CHECK(world.after("A", "set_bind", false).background.sky_colors[0] == glm::vec3(0, 0, 0));
}

TEST_CASE("updates the bound NavigationInfo after events (4.6.10, 6.29)") {
  LiveWorld world("DEF A NavigationInfo { speed 3 } DEF B NavigationInfo { type \"FLY\" headlight FALSE }");
  CHECK(world.now().navigation.speed == 3);
  const NavigationState other = world.after("B", "set_bind", true).navigation;
  CHECK(other.types == std::vector<std::string>{"FLY"});
  CHECK_FALSE(other.headlight);
  CHECK(world.after("B", "set_headlight", true).navigation.headlight);
  CHECK(world.after("B", "set_speed", vrml::SFFloat{9}).navigation.speed == 9);
  CHECK(world.after("B", "set_bind", false).navigation.speed == 3);
}

TEST_CASE("updates Switch, LOD, Transform and children after events (4.6.5, 6.26, 6.46, 6.52)") {
  LiveWorld world(
      "DEF S Switch { choice [ Shape { geometry Box { } } ] } DEF L LOD { level [ Group { } ] } DEF T Transform { } "
      "DEF K Switch { choice DEF Ball Shape { geometry Sphere { } } }");
  CHECK(world.now().items.empty());
  CHECK(world.after("S", "set_whichChoice", vrml::SFInt32{0}).items.size() == 1);
  const vrml::NodeId ball = world.find("Ball");
  CHECK(world.after("L", "set_level", vrml::MFNode{ball}).items.size() == 2);
  CHECK(world.after("T", "addChildren", vrml::MFNode{ball}).items.size() == 3);
  CHECK(world.after("T", "set_translation", vrml::SFVec3f(4, 0, 0)).items[2].world_from_node[3].x == 4);
  CHECK(world.after("T", "set_scale", vrml::SFVec3f(2, 2, 2)).items[2].world_from_node[0].x == 2);
  CHECK(world.after("T", "removeChildren", vrml::MFNode{ball}).items.size() == 2);
  CHECK(world.after("S", "set_whichChoice", vrml::SFInt32{-1}).items.size() == 1);
}
