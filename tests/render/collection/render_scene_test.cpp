#include "render/collection/render_scene.h"

#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <memory>
#include <random>
#include <string>

namespace gs::render::render_scene_test {
namespace {

/// World that receives events. Its RenderScene follows them; a full collection is compared with it.
class World {
 public:
  explicit World(const std::string& body, vrml::Language language = vrml::Language::vrml97)
      : scene_(std::make_unique<vrml::SceneGraph>("text.wrl")) {
    Diagnostics diagnostics;
    if (language == vrml::Language::x3d) scene_->texts().at(0).set_language(language, 40);
    (void)vrml::Parser(*scene_, diagnostics).parse_fragment(body);
    REQUIRE(diagnostics.errors() == 0);
    execution_ = std::make_unique<vrml::Execution>(*scene_);
    names_ = std::make_unique<vrml::NodeNames>(*scene_);
    render_ = std::make_unique<RenderScene>(*scene_, images_, geometries_, meshes_);
    execution_->start(1000);
    (void)execution_->changes().take();
    render_->gather(bound(), viewer_);
  }

  template <class T>
  void send(const std::string& target, T value) {
    const std::size_t point = target.rfind('.');
    const vrml::NodeId node = names_->find(target.substr(0, point));
    REQUIRE(node);
    const vrml::InterfaceDeclaration* event = scene_->node(node).type->find_event_in(target.substr(point + 1));
    REQUIRE(event);
    execution_->step(1000 + ++steps_ * 0.01);
    CHECK(execution_->send(*scene_, node, *event, vrml::FieldValue(std::move(value))));
  }
  bool update() {
    const auto changes = execution_->changes().take();
    forget_changed(meshes_, changes);
    return render_->update(changes, bound(), viewer_);
  }
  void move_to(const glm::vec3& viewer) { viewer_ = viewer; }
  [[nodiscard]] const RenderList& list() const { return render_->list(); }
  [[nodiscard]] std::size_t gathered() const { return render_->gathered(); }
  [[nodiscard]] vrml::SceneGraph& scene() { return *scene_; }
  [[nodiscard]] vrml::NodeId find(const std::string& name) { return names_->find(name); }

  /// Checks that the list equals a full collection, bit for bit.
  void check() {
    MeshCache meshes;
    const BoundNodes nodes = bound();
    const RenderList fresh = collect(*scene_, images_, meshes, viewer_, geometries_, &nodes);
    const RenderList& kept = list();
    REQUIRE(kept.items.size() == fresh.items.size());
    for (std::size_t i = 0; i < kept.items.size(); ++i) {
      const DrawItem &a = kept.items[i], &b = fresh.items[i];
      INFO("item " << i);
      CHECK(a.world_from_node == b.world_from_node);
      CHECK(a.material.diffuse == b.material.diffuse);
      CHECK(a.material.transparency == b.material.transparency);
      CHECK(a.material.lit == b.material.lit);
      CHECK(a.texture.transform == b.texture.transform);
      CHECK((a.texture.image == nullptr) == (b.texture.image == nullptr));
      if (a.texture.image && b.texture.image) CHECK(a.texture.image->pixels == b.texture.image->pixels);
      CHECK(a.mesh->positions == b.mesh->positions);
      CHECK(a.mesh->colors == b.mesh->colors);
      CHECK(a.directional_lights == b.directional_lights);
      CHECK(a.clip_planes == b.clip_planes);
      CHECK((a.style == nullptr) == (b.style == nullptr));
      if (a.style && b.style) CHECK(*a.style == *b.style);
      CHECK(path(kept, a.place) == path(fresh, b.place));
    }
    CHECK(kept.clip_planes == fresh.clip_planes);
    CHECK(kept.bounds.lower == fresh.bounds.lower);
    CHECK(kept.bounds.upper == fresh.bounds.upper);
    REQUIRE(kept.lights.size() == fresh.lights.size());
    for (std::size_t i = 0; i < kept.lights.size(); ++i) {
      CHECK(kept.lights[i].location == fresh.lights[i].location);
      CHECK(kept.lights[i].direction == fresh.lights[i].direction);
      CHECK(kept.lights[i].intensity == fresh.lights[i].intensity);
    }
    REQUIRE(kept.viewpoints.size() == fresh.viewpoints.size());
    for (std::size_t i = 0; i < kept.viewpoints.size(); ++i)
      CHECK(kept.viewpoints[i].world_from_camera == fresh.viewpoints[i].world_from_camera);
    CHECK(kept.background.sky_colors == fresh.background.sky_colors);
    CHECK(kept.background.world_from_background == fresh.background.world_from_background);
    CHECK(kept.navigation.speed == fresh.navigation.speed);
    CHECK(kept.fog.visibility_range == fresh.fog.visibility_range);
    CHECK(kept.fog.color == fresh.fog.color);
    CHECK(kept.fog.fog_from_world == fresh.fog.fog_from_world);
  }

 private:
  [[nodiscard]] BoundNodes bound() const {
    const auto node_of = [&](std::string_view type) -> const vrml::Node* {
      const vrml::NodeChange found = execution_->stacks().bound(*vrml::built_in_node_type(type));
      return found.scene ? &found.scene->node(found.node) : nullptr;
    };
    return {node_of("Viewpoint"), node_of("NavigationInfo"), node_of("Background"), node_of("Fog")};
  }
  static std::string path(const RenderList& list, std::uint32_t place) {
    std::string text;
    for (; place != kNoPlace; place = list.places[place].parent)
      text += std::to_string(list.places[place].node.index) + "<";
    return text;
  }

  std::unique_ptr<vrml::SceneGraph> scene_;
  Images images_;
  Geometries geometries_;
  MeshCache meshes_;
  std::unique_ptr<vrml::Execution> execution_;
  std::unique_ptr<vrml::NodeNames> names_;
  std::unique_ptr<RenderScene> render_;
  glm::vec3 viewer_{0, 0, 10};
  int steps_ = 0;
};

const std::string kWorld = R"(
DEF Sky Background { skyColor 0 0 1 } DEF Dusk Background { skyColor 1 0 0 }
DEF Slow NavigationInfo { speed 2 }
DEF Outer Transform { children [
  DEF Lamp PointLight { location 1 2 3 } DEF Sun DirectionalLight { direction 0 -1 0 }
  DEF Eye Viewpoint { position 0 0 5 }
  DEF Inner Transform { translation 1 0 0 children [
    DEF Ball Shape { appearance Appearance { material DEF Paint Material { }
        texture DEF Dots PixelTexture { image 1 1 1 0x80 } textureTransform DEF Turn TextureTransform { } }
      geometry Box { size 1 2 3 } }
    DEF Turner Billboard { children Shape { geometry Cone { } } } ] }
  Transform { translation 0 3 0 children USE Inner } ] }
Shape { geometry DEF Faces IndexedFaceSet { coord DEF Points Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] }
  coordIndex [ 0 1 2 ] color DEF Paints Color { color [ 1 0 0, 0 1 0, 0 0 1 ] } } appearance USE Look }
DEF Levels LOD { range [ 20 ] level [ Shape { geometry Sphere { } } Shape { geometry Cylinder { } } ] }
DEF Choice Switch { whichChoice 0 choice [ Shape { geometry Box { } } Shape { geometry Sphere { } } ] }
DEF Late Transform { }
)";

std::string world_text() {
  std::string text = kWorld;
  text.replace(text.find("USE Look"), 8, "DEF Look Appearance { material USE Paint }");
  return text;
}

}  // namespace

TEST_CASE("changes the number of a list exactly when the list changes") {
  World world(
      "DEF T Transform { children Shape { appearance Appearance { material DEF M Material { } } geometry Box { } } }");
  std::uint64_t before = world.list().changes;
  CHECK(before != 0);
  CHECK_FALSE(world.update());
  CHECK(world.list().changes == before);
  const auto is_another = [&] { return std::exchange(before, world.list().changes) != before; };
  world.send("T.set_translation", vrml::SFVec3f{1, 2, 3});
  CHECK(world.update());
  CHECK(is_another());
  world.send("M.set_diffuseColor", vrml::SFColor{1, 0, 0});
  CHECK(world.update());
  CHECK(is_another());
  CHECK_FALSE(world.update());
  CHECK_FALSE(is_another());
  World other("Shape { geometry Box { } }");
  CHECK(other.list().changes != world.list().changes);
}

TEST_CASE("moves a changed Transform's items in place") {
  World world(world_text());
  world.check();
  CHECK_FALSE(world.update());
  world.send("Outer.translation", vrml::SFVec3f{3, 0, 0});
  CHECK(world.update());
  world.check();
  world.send("Inner.rotation", vrml::SFRotation{0, 1, 0, 1});
  world.send("Outer.scale", vrml::SFVec3f{2, 2, 2});
  CHECK(world.update());
  world.check();
  world.send("Inner.scale", vrml::SFVec3f{0, 0, 0});
  CHECK(world.update());
  world.check();
  CHECK(world.gathered() == 1);
}

TEST_CASE("updates colours, textures, lights and viewpoints without collecting again") {
  World world(world_text());
  world.send("Paint.diffuseColor", vrml::SFColor{1, 0, 0});
  world.send("Paint.transparency", vrml::SFFloat{0.5f});
  world.send("Turn.rotation", vrml::SFFloat{0.5f});
  world.send("Lamp.location", vrml::SFVec3f{9, 9, 9});
  world.send("Sun.intensity", vrml::SFFloat{0.25f});
  world.send("Eye.position", vrml::SFVec3f{0, 0, 7});
  CHECK(world.update());
  world.check();
  CHECK(world.list().items[0].material.diffuse == glm::vec3(1, 0, 0));
  CHECK(world.gathered() == 1);
  world.send("Dusk.set_bind", vrml::SFBool{true});
  CHECK(world.update());
  world.check();
  CHECK(world.list().background.sky_colors.front() == glm::vec3(1, 0, 0));
  CHECK(world.gathered() == 1);
}

TEST_CASE("makes a geometry again when one of its nodes changes") {
  World world(world_text());
  world.send("Points.point", vrml::MFVec3f{{0, 0, 0}, {5, 0, 0}, {0, 5, 0}});
  CHECK(world.update());
  world.check();
  world.send("Paints.color", vrml::MFColor{{1, 1, 0}, {0, 1, 1}, {1, 0, 1}});
  CHECK(world.update());
  world.check();
  CHECK(world.gathered() == 1);
  // The Shape is empty at first.
  World empty("Shape { geometry IndexedFaceSet { coordIndex [ 0 1 2 ] coord DEF Points Coordinate { } } }");
  CHECK(empty.list().items.empty());
  empty.send("Points.point", vrml::MFVec3f{{0, 0, 0}, {5, 0, 0}, {0, 5, 0}});
  CHECK(empty.update());
  CHECK(empty.list().items.size() == 1);
  empty.check();
  empty.send("Points.point", vrml::MFVec3f{});
  CHECK(empty.update());
  CHECK(empty.list().items.empty());
}

TEST_CASE("collects items that appear, and drops removed ones") {
  World world(world_text());
  world.send("Choice.whichChoice", vrml::SFInt32{1});
  CHECK(world.update());
  world.check();
  world.send("Choice.whichChoice", vrml::SFInt32{-1});
  CHECK(world.update());
  world.check();
  world.send("Sun.on", vrml::SFBool{false});
  CHECK(world.update());
  world.check();
  world.send("Late.addChildren", vrml::MFNode{world.find("Ball")});
  CHECK(world.update());
  world.check();
  world.send("Late.translation", vrml::SFVec3f{0, -4, 0});
  CHECK(world.update());
  world.check();
  world.send("Late.removeChildren", vrml::MFNode{world.find("Ball")});
  CHECK(world.update());
  world.check();
}

TEST_CASE("updates levels of detail and billboards with the viewer (VRML97 6.26, 6.6)") {
  World world(world_text());
  const std::size_t gathered = world.gathered();
  world.move_to({3, 0, 10});
  CHECK(world.update());
  world.check();
  CHECK(world.gathered() == gathered);
  world.move_to({0, 0, 30});
  CHECK(world.update());
  world.check();
  CHECK(world.gathered() == gathered + 1);
}

TEST_CASE("hides items below overflowing transformations until these are valid again") {
  World world("DEF A Transform { children DEF B Transform { children Shape { geometry Box { } } } }");
  world.send("A.scale", vrml::SFVec3f{1e30f, 1e30f, 1e30f});
  CHECK(world.update());
  world.check();
  world.send("B.scale", vrml::SFVec3f{1e30f, 1e30f, 1e30f});
  CHECK(world.update());
  CHECK(world.list().items.empty());
  world.send("B.scale", vrml::SFVec3f{1, 1, 1});
  CHECK(world.update());
  CHECK(world.list().items.size() == 1);
  world.check();
}

TEST_CASE("updates to the list of a full collection after any events") {
  World world(world_text());
  std::mt19937 random(7);
  const auto number = [&] { return static_cast<float>(static_cast<int>(random() % 2001) - 1000) / 100; };
  for (int i = 0; i < 300; ++i) {
    switch (random() % 14) {
      case 0:
        world.send("Outer.translation", vrml::SFVec3f{number(), number(), number()});
        break;
      case 1:
        world.send("Inner.translation", vrml::SFVec3f{number(), number(), number()});
        break;
      case 2:
        world.send("Inner.rotation", vrml::SFRotation{number(), number(), number(), number()});
        break;
      case 3:
        world.send("Outer.scale", vrml::SFVec3f{number(), number(), number()});
        break;
      case 4:
        world.send("Paint.diffuseColor", vrml::SFColor{0.5f, 0, 1});
        break;
      case 5:
        world.send("Points.point", vrml::MFVec3f{{0, 0, 0}, {number(), 0, 0}, {0, number(), 0}});
        break;
      case 6:
        world.send("Choice.whichChoice", static_cast<vrml::SFInt32>(random() % 3));
        break;
      case 7:
        world.send("Lamp.location", vrml::SFVec3f{number(), number(), number()});
        break;
      case 8:
        world.send("Lamp.on", vrml::SFBool{random() % 2 == 0});
        break;
      case 9:
        world.send("Late.addChildren", vrml::MFNode{world.find(random() % 2 ? "Inner" : "Ball")});
        break;
      case 10:
        world.send("Late.set_children", vrml::MFNode{});
        break;
      case 11:
        world.move_to({number(), number(), number() * 4});
        break;
      case 12:
        world.send("Late.rotation", vrml::SFRotation{0, 0, 1, number()});
        break;
      case 13:
        world.send("Dots.image", vrml::SFImage{{1, 1, 1, static_cast<std::uint32_t>(random() % 256)}});
        break;
    }
    if (random() % 2) continue;
    (void)world.update();
    INFO("after " << i);
    world.check();
  }
  CHECK(world.gathered() < 150);
}

TEST_CASE("updates Text after events, and re-tessellates it as the viewer comes near") {
  World world(R"(
    DEF Place Transform { children Shape { geometry DEF Words Text { string "Sea" } } }
    Transform { translation 0 0 -500 children Shape { geometry USE Words } }
    Shape { geometry DEF Later Text { } })");
  REQUIRE(world.list().items.size() == 2);
  world.check();
  const auto triangles = [&](std::size_t item) { return world.list().items[item].mesh->indices.size() / 3; };
  CHECK(triangles(0) > triangles(1));
  world.send<vrml::MFString>("Words.set_string", {vrml::SFString("Sea shore")});
  CHECK(world.update());
  world.check();
  CHECK(world.gathered() == 1);
  const std::size_t middle = triangles(0), coarse = triangles(1);
  CHECK(middle > 1.2 * static_cast<double>(coarse));
  world.move_to({1, 0, 1});
  CHECK(world.update());
  world.check();
  CHECK(triangles(0) > 1.2 * static_cast<double>(middle));
  CHECK(triangles(1) == coarse);
  world.move_to({0, 0, -490});
  CHECK(world.update());
  world.check();
  CHECK(triangles(0) == coarse);
  CHECK(triangles(1) == middle);
  CHECK_FALSE(world.update());
  // The distance of a moved text is computed from its current position.
  world.send<vrml::SFVec3f>("Place.set_translation", {0, 0, -489});
  CHECK(world.update());
  world.check();
  CHECK(triangles(0) > middle);
  CHECK(world.gathered() == 1);
  // The text was empty before.
  world.send<vrml::MFString>("Later.set_string", {vrml::SFString("now")});
  CHECK(world.update());
  world.check();
  CHECK(world.list().items.size() == 3);
  CHECK(world.gathered() == 2);
}

TEST_CASE("follows ClipPlanes, styles and visible nodes of X3D") {
  World world(
      "DEF Outer Transform { children [ DEF Cut ClipPlane { } DEF Part Shape { appearance Appearance { lineProperties "
      "DEF Line LineProperties { linewidthScaleFactor 3 } } geometry Circle2D { } } ] } Shape { geometry Box { } }",
      vrml::Language::x3d);
  REQUIRE(world.list().clip_planes.size() == 1);
  CHECK(world.list().clip_planes[0] == glm::dvec4(0, 1, 0, 0));
  world.send("Outer.set_translation", vrml::SFVec3f(0, 5, 0));
  CHECK(world.update());
  CHECK(world.list().clip_planes[0] == glm::dvec4(0, 1, 0, -5));
  world.send("Line.set_linewidthScaleFactor", 7.0f);
  CHECK(world.update());
  CHECK(world.list().items[0].style->line_width == 7);
  CHECK(world.gathered() == 1);
  world.check();
  world.send("Cut.set_enabled", false);
  CHECK(world.update());
  CHECK(world.list().clip_planes.empty());
  world.send("Part.set_visible", false);
  CHECK(world.update());
  CHECK(world.list().items.size() == 1);
  world.check();
}

TEST_CASE("takes the NavigationInfo in a field of the bound Viewpoint (X3D 23.3.1)") {
  World world(
      "NavigationInfo { speed 9 } Viewpoint { navigationInfo DEF Own NavigationInfo { headlight FALSE speed 3 } } "
      "DEF Second Viewpoint { } Shape { geometry Box { } }",
      vrml::Language::x3d);
  CHECK_FALSE(world.list().navigation.headlight);
  CHECK(world.list().navigation.speed == 3);
  world.send<vrml::SFFloat>("Own.set_speed", 4.0f);
  CHECK(world.update());
  world.check();
  CHECK(world.list().navigation.speed == 4);
  world.send<vrml::SFBool>("Second.set_bind", true);
  CHECK(world.update());
  world.check();
  CHECK(world.list().navigation.headlight);
  CHECK(world.list().navigation.speed == 9);
}

TEST_CASE("updates the bound Fog") {
  World world(R"(
    DEF Place Transform { children DEF Mist Fog { visibilityRange 30 } }
    DEF Night Fog { visibilityRange 50 color 0 0 0 } Shape { geometry Box { } })");
  world.check();
  CHECK(world.list().fog.visibility_range == 30);
  world.send<vrml::SFFloat>("Mist.set_visibilityRange", 20.0f);
  world.send<vrml::SFColor>("Mist.set_color", {1, 0, 0});
  CHECK(world.update());
  world.check();
  CHECK(world.list().fog.visibility_range == 20);
  CHECK(world.list().fog.color == glm::vec3(1, 0, 0));
  world.send<vrml::SFVec3f>("Place.set_scale", {2, 2, 2});
  CHECK(world.update());
  world.check();
  CHECK(world.list().fog.fog_from_world == glm::mat3(0.5f));
  world.send<vrml::SFBool>("Night.set_bind", true);
  CHECK(world.update());
  world.check();
  CHECK(world.list().fog.visibility_range == 50);
  world.send<vrml::SFBool>("Night.set_bind", false);
  world.send<vrml::SFBool>("Mist.set_bind", false);
  CHECK(world.update());
  CHECK(world.list().fog.visibility_range == 0);
  CHECK(world.gathered() == 1);
}

TEST_CASE("scales a ScreenGroup so that a unit is as long as a pixel, wherever the viewer is (X3D 36.4.6)") {
  World world("Transform { scale 2 2 2 children ScreenGroup { children Shape { geometry Box { size 2 2 2 } } } }",
              vrml::Language::x3d);
  const auto unit = [&] { return glm::length(glm::dvec3(world.list().items.at(0).world_from_node[0])); };
  CHECK(unit() == Approx(pixel_length({}, 10)));
  world.move_to({0, 30, 40});
  CHECK(world.update());
  CHECK(unit() == Approx(pixel_length({}, 40)));
  CHECK(world.gathered() == 1);
  world.check();
}

TEST_CASE("fits the box of a node with bboxDisplay to its content while that moves (X3D 10.2.2)") {
  World world(
      "Group { bboxDisplay TRUE children [ Shape { geometry Box { } } DEF Inner Transform { bboxDisplay TRUE children "
      "DEF T Transform { children Shape { geometry Box { } } } } ] }",
      vrml::Language::x3d);
  REQUIRE(world.list().items.size() == 4);
  const auto box = [&](std::size_t i) { return world.list().items.at(i).mesh->bounds; };
  CHECK(box(2).upper == glm::vec3(1));
  CHECK(box(3).upper == glm::vec3(1));
  world.send<vrml::SFVec3f>("T.set_translation", {3, 0, 0});
  CHECK(world.update());
  CHECK(box(2).lower == glm::vec3(2, -1, -1));
  CHECK(box(2).upper == glm::vec3(4, 1, 1));
  CHECK(box(3).lower == glm::vec3(-1));
  CHECK(box(3).upper == glm::vec3(4, 1, 1));
  world.send<vrml::SFVec3f>("Inner.set_translation", {0, 5, 0});
  CHECK(world.update());
  CHECK(box(2).upper == glm::vec3(4, 1, 1));
  CHECK(box(3).upper == glm::vec3(4, 6, 1));
  CHECK(world.gathered() == 1);
  CHECK_FALSE(world.update());
}

}  // namespace gs::render::render_scene_test
