#include "app/session/running/world_runtime.h"

#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

namespace gs::app::world_runtime_test {
namespace {

struct World {
  explicit World(const std::string& body) {
    Diagnostics diagnostics;
    opened.scene = std::make_unique<vrml::SceneGraph>("text.wrl");
    (void)vrml::parse("#VRML V2.0 utf8\n" + body, *opened.scene, diagnostics);
    CHECK(diagnostics.errors() == 0);
    runtime = std::make_unique<WorldRuntime>(opened, meshes);
    runtime->start(1000);
    seen = runtime->look({0, 0, 10}, true);
  }
  vrml::NodeId read(const std::string& text) {
    Diagnostics diagnostics;
    const vrml::NodeId made = vrml::read_into(*opened.scene, "made.wrl", text, diagnostics).roots[0];
    CHECK(diagnostics.errors() == 0);
    runtime->execution().scenes().attach(*opened.scene);
    return made;
  }
  void set_children(const vrml::MFNode& children) {
    CHECK(runtime->send(*opened.scene, opened.scene->roots()[0], "set_children", vrml::FieldValue(children)));
  }
  const render::RenderList& list() {
    (void)runtime->show(*seen, {0, 0, 10});
    return seen->scene.list();
  }

  LoadedWorld opened;
  render::MeshCache meshes;
  std::unique_ptr<WorldRuntime> runtime;
  std::shared_ptr<RuntimeScene> seen;
};

vrml::MFNode only(vrml::NodeId node) {
  vrml::MFNode list;
  list.push_back(node);
  return list;
}

}  // namespace

TEST_CASE("drops images and meshes of removed nodes, also when their slots are reused") {
  World world("Group { }");
  vrml::SceneGraph& scene = *world.opened.scene;
  for (int round = 0; round < 10; ++round) {
    const vrml::NodeId shape = world.read(
        "Shape { appearance Appearance { texture ImageTexture { } } geometry IndexedFaceSet { "
        "coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 ] } }");
    const auto appearance = scene.get<vrml::SFNode>(shape, "appearance");
    const auto texture = scene.get<vrml::SFNode>(appearance, "texture");
    world.set_children(only(shape));
    REQUIRE(world.list().items.size() == 1);
    CHECK(!world.list().items[0].texture.image);
    auto image = std::make_shared<render::Image>();
    image->width = image->height = 1;
    image->components = 3;
    image->pixels.resize(3);
    const auto arrive = [&](vrml::SceneGraph* of) {
      ResourceUpdates updates;
      updates.images.push_back({{{of, texture, 0, 1}}, image});
      world.runtime->arrive(std::move(updates));
    };
    arrive(&scene);
    CHECK(world.list().items[0].texture.image == image);
    world.set_children({});
    CHECK(world.runtime->execution().lifetime().remove_unheld() == 5);
    CHECK(world.opened.images.empty());
    CHECK(world.meshes.meshes.empty());
    arrive(&scene);  // the result is too late
    const vrml::SceneGraph other("other.wrl");
    arrive(const_cast<vrml::SceneGraph*>(&other));  // result for a removed Inline
    CHECK(world.opened.images.empty());
    CHECK(world.list().items.empty());
    world.runtime->step(1001 + round);
  }
}

TEST_CASE("keeps an outdated list valid after its Inline is removed") {
  World world("Group { } Inline { }");
  vrml::SceneGraph& scene = *world.opened.scene;
  auto content = std::make_shared<vrml::SceneGraph>("part.wrl", scene.budget());
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\nShape { geometry Box { } }", *content, diagnostics);
  const std::weak_ptr<vrml::SceneGraph> watched = content;
  scene.inlines().attach(scene.roots()[1], std::move(content));
  vrml::Execution& execution = world.runtime->execution();
  execution.scenes().attach();
  execution.changes().mark_content(scene, scene.roots()[1]);
  REQUIRE(world.list().items.size() == 1);
  execution.lifetime().remove_content(scene, scene.roots()[1]);
  world.runtime->step(1001);
  const render::RenderList& behind = world.seen->scene.list();
  REQUIRE(!watched.expired());
  CHECK(behind.places[behind.items[0].place].scene == watched.lock().get());
  CHECK(world.list().items.empty());
  CHECK(watched.expired());
}

TEST_CASE("shows the new world after a replacement") {
  World world("Group { children Shape { geometry Box { } } }");
  CHECK(world.list().items.size() == 1);
  CHECK(
      world.runtime->execution().lifetime().replace_world(only(world.read("Transform { translation 7 0 0 children [ "
                                                                          "Shape { geometry Cone { } } ] }"))));
  CHECK(world.runtime->step(1001));
  REQUIRE(world.list().items.size() == 1);
  CHECK(world.list().items[0].world_from_node[3].x == 7);
}

}  // namespace gs::app::world_runtime_test
