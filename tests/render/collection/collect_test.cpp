#include "render/scene/render_list.h"
#include "tests/watched.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>
#include <glm/glm.hpp>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

using namespace gs;
using namespace gs::render;

namespace {

/// Parsed world with its render list.
struct World {
  explicit World(const std::string& body, const Limits& limits = {})
      : scene(std::make_unique<vrml::SceneGraph>("test.wrl", limits)) {
    Diagnostics diagnostics;
    vrml::parse("#VRML V2.0 utf8\n" + body, *scene, diagnostics);
    for (const Diagnostic& d : diagnostics.entries()) UNSCOPED_INFO(d.text());
    REQUIRE(diagnostics.errors() == 0);
  }
  RenderList collect(const glm::vec3& viewer = {0, 0, 10}) { return render::collect(*scene, images, meshes, viewer); }
  vrml::NodeId find(std::string_view name) const {
    for (std::uint32_t i = 1; i <= scene->nodes().count(); ++i)
      if (scene->nodes().at(i).name == name) return scene->nodes().id_at(i);
    FAIL("no node named " << name);
    return {};
  }

  std::unique_ptr<vrml::SceneGraph> scene;
  Images images;
  MeshCache meshes;
};

const std::string kBox = "Shape { geometry Box { } }\n";

glm::vec3 moved(const glm::mat4& matrix, const glm::vec3& point) { return glm::vec3(matrix * glm::vec4(point, 1)); }

void check_vector(const glm::vec3& got, const glm::vec3& expected, float margin = 1e-5f) {
  CHECK(got.x == Approx(expected.x).margin(margin));
  CHECK(got.y == Approx(expected.y).margin(margin));
  CHECK(got.z == Approx(expected.z).margin(margin));
}

}  // namespace

TEST_CASE("draws a Shape unlit white without appearance, and lit with a Material (VRML97 4.14.2)") {
  World world(
      kBox +
      "Shape { appearance Appearance { } geometry Box { } }\n"
      "Shape { appearance Appearance { material Material { diffuseColor 1 0.5 0 emissiveColor 0 0 0.25\n"
      "  specularColor 0.1 0.2 0.3 ambientIntensity 0.4 shininess 0.5 transparency 0.75 } } geometry Box { } }");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 3);
  for (int i = 0; i < 2; ++i) {
    CHECK_FALSE(list.items[i].material.lit);
    CHECK(list.items[i].material.diffuse == glm::vec3(1));
  }
  const Material& material = list.items[2].material;
  CHECK(material.lit);
  CHECK(material.diffuse == glm::vec3(1, 0.5f, 0));
  CHECK(material.emissive == glm::vec3(0, 0, 0.25f));
  CHECK(material.specular == glm::vec3(0.1f, 0.2f, 0.3f));
  CHECK(material.ambient_intensity == 0.4f);
  CHECK(material.shininess == 0.5f);
  CHECK(material.transparency == 0.75f);
  check_vector(list.bounds.lower, {-1, -1, -1});
  check_vector(list.bounds.upper, {1, 1, 1});
}

TEST_CASE("draws misplaced parts of Shapes as far as they can be meant") {
  const std::string red = "Appearance { material Material { emissiveColor 1 0 0 } }";
  const std::string green = "Appearance { material Material { emissiveColor 0 1 0 } }";
  const auto colors = [&](const std::string& text) {
    World world(text);
    std::vector<glm::vec3> found;
    for (const DrawItem& item : world.collect().items) found.push_back(item.material.emissive);
    return found;
  };
  using Colors = std::vector<glm::vec3>;
  const glm::vec3 r(1, 0, 0), g(0, 1, 0), none(0);
  // Between children: geometry, alone and after or before its Appearance; a USE; in a PROTO.
  CHECK(colors("Group { children [ Box { } " + red + " " + green + " Box { } Cone { } ] }") == Colors{r, g, none});
  CHECK(colors("Shape { geometry DEF B Box { } } Transform { children USE B }").size() == 2);
  CHECK(colors("PROTO P [ ] { Group { children [ " + green + " Sphere { } ] } } P { } P { }") == Colors{g, g});
  CHECK(colors("Switch { whichChoice 1 choice [ Group { } Box { } ] }").size() == 1);
  // In the fields of a Shape and an Appearance.
  CHECK(colors("DEF W Switch { whichChoice 1 choice [ " + red + " " + green +
               " ] } Shape { appearance USE W geometry Box { } }") == Colors{g});
  CHECK(colors("Shape { appearance " + red + " geometry Shape { appearance " + green + " geometry Box { } } }") ==
        Colors{r});
  CHECK(colors("Shape { appearance Material { emissiveColor 1 0 0 } geometry Box { } }") == Colors{r});
  CHECK(colors("Shape { appearance Appearance { material " + green + " } geometry Box { } }") == Colors{g});
  CHECK(colors("Shape { geometry Switch { whichChoice -1 choice Box { } } }").empty());
  CHECK(colors("Shape { geometry Group { children Box { } } }").size() == 1);
}

TEST_CASE("draws a MultiTexture with its own transforms, and a TrimmedSurface without its contours") {
  World world(
      "Shape { appearance Appearance { texture MultiTexture { mode [ \"MODULATE\" ] texture [ PixelTexture { image 1 1 "
      "3 "
      "0xFF0000 } PixelTexture { } ] } textureTransform MultiTextureTransform { textureTransform TextureTransform { "
      "scale "
      "2 2 } } } geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 ] "
      "texCoord "
      "MultiTextureCoordinate { texCoord [ TextureCoordinate { point [ 0.5 0.5 1 0 0 1 ] } ] } } } "
      "Shape { geometry TrimmedSurface { trimmingContour [ Contour2D { children [ ] } ] surface NurbsSurface { "
      "uDimension "
      "2 vDimension 2 uOrder 2 vOrder 2 uKnot [ 0 0 1 1 ] vKnot [ 0 0 1 1 ] controlPoint [ 0 0 0 1 0 0 0 1 0 1 1 0 ] } "
      "} }");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 2);
  REQUIRE(list.items[0].layered);
  const TextureLayer& layer = list.items[0].layered->layers[0];
  REQUIRE(layer.image);
  CHECK(layer.image->pixels[0] == 255);
  CHECK(layer.transform[0][0] == 2);
  CHECK(list.items[0].mesh->texture_coordinates[0] == glm::vec2(0.5f, 0.5f));
  CHECK(list.items[1].mesh->indices.size() > 6);
}

TEST_CASE("transforms by T * C * R * SR * S * -SR * -C (VRML97 6.52)") {
  World world("Transform { translation 10 0 0 center 1 0 0 rotation 0 0 1 1.5707963 scale 2 1 1 children " + kBox +
              "}");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 1);
  // (2 0 0): -C gives (1 0 0), S (2 0 0), R (0 2 0), C (1 2 0), T (11 2 0).
  check_vector(moved(list.items[0].world_from_node, {2, 0, 0}), {11, 2, 0});

  World oriented("Transform { scaleOrientation 0 0 1 0.78539816 scale 3 1 1 children " + kBox + "}");
  // Scaled along the diagonal (1 1 0).
  check_vector(moved(oriented.collect().items[0].world_from_node, {1, 1, 0}), {3, 3, 0});
  check_vector(moved(oriented.collect().items[0].world_from_node, {1, -1, 0}), {1, -1, 0});

  World nested("Transform { translation 1 2 3 children Transform { scale 2 2 2 children " + kBox + "} }");
  check_vector(moved(nested.collect().items[0].world_from_node, {1, 1, 1}), {3, 4, 5});
}

TEST_CASE("ignores rotations without an axis and NaN transformations") {
  World world("DEF T Transform { rotation 0 0 0 1 translation 1 0 0 children " + kBox + "}");
  check_vector(moved(world.collect().items[0].world_from_node, {1, 2, 3}), {2, 2, 3});
  world.scene->set<vrml::SFVec3f>(world.find("T"), "translation", {std::nanf(""), 0, 0});
  world.scene->set<vrml::SFVec3f>(world.find("T"), "scale", {HUGE_VALF, 1, 1});
  world.scene->set<vrml::SFRotation>(world.find("T"), "rotation", {0, 1, 0, std::nanf("")});
  check_vector(moved(world.collect().items[0].world_from_node, {1, 2, 3}), {1, 2, 3});
}

TEST_CASE("normalises rotation axes") {
  World world("Transform { rotation 0 0 7 1.5707963 children " + kBox + "}");
  check_vector(moved(world.collect().items[0].world_from_node, {1, 0, 0}), {0, 1, 0});
}

TEST_CASE("keeps small differences of large transformations") {
  World world("Transform { translation 4000000 0 0 children Transform { translation -3999999.75 0.125 0 children " +
              kBox + "} }");
  check_vector(moved(world.collect().items[0].world_from_node, {0, 0, 0}), {0.25f, 0.125f, 0});
}

TEST_CASE("shows the chosen child of a Switch, or none") {
  World world("DEF S Switch { choice [ Transform { translation 5 0 0 children " + kBox + "} " + kBox + "] }");
  CHECK(world.collect().items.empty());
  const vrml::NodeId id = world.find("S");
  for (const auto& [which, count] : {std::pair{0, 1}, {1, 1}, {2, 0}, {-1, 0}, {-7, 0}, {2000000000, 0}}) {
    world.scene->set<vrml::SFInt32>(id, "whichChoice", which);
    CHECK(world.collect().items.size() == static_cast<std::size_t>(count));
  }
  world.scene->set<vrml::SFInt32>(id, "whichChoice", 0);
  CHECK(world.collect().items[0].world_from_node[3].x == 5);
}

TEST_CASE("chooses a LOD level by the distance in its own coordinate system (VRML97 6.26)") {
  const auto level = [](const std::string& body, const glm::vec3& viewer) {
    const RenderList list = World(body).collect(viewer);
    return list.items.empty() ? -1 : static_cast<int>(std::lround(glm::length(list.items[0].world_from_node[0])));
  };
  const auto box = [](int size) { return "Shape { geometry Box { size " + std::to_string(2 * size) + " 1 1 } }\n"; };
  const std::string lod = "LOD { center 1 0 0 range [ 10 20 ] level [ " + box(1) + box(2) + box(3) + "] }";
  CHECK(level(lod, {1, 0, 9.9f}) == 1);
  CHECK(level(lod, {1, 0, 10}) == 2);
  CHECK(level(lod, {1, 0, 19.9f}) == 2);
  CHECK(level(lod, {1, 0, 20}) == 3);
  CHECK(level("Transform { scale 10 10 10 children " + lod + "}", {10, 0, 150}) == 20);
  CHECK(level("LOD { level [ " + box(1) + box(2) + "] }", {0, 0, 1000}) == 1);
  CHECK(level("LOD { range [ 1 2 3 ] level [ " + box(1) + box(2) + "] }", {0, 0, 1000}) == 2);  // too few levels
  CHECK(level("LOD { range [ 1 ] level [ ] }", {0, 0, 1000}) == -1);
}

TEST_CASE("turns the Z axis of a Billboard to the viewer about its axis (VRML97 6.6)") {
  const auto z_axis = [](const std::string& fields, const glm::vec3& viewer) {
    return glm::vec3(
        World("Transform { translation 0 0 -5 children Billboard { " + fields + " children " + kBox + "} }")
            .collect(viewer)
            .items.at(0)
            .world_from_node[2]);
  };
  check_vector(z_axis("", {5, 0, -5}), {1, 0, 0});
  check_vector(z_axis("", {5, 50, -5}), {1, 0, 0});
  check_vector(z_axis("", {0, 0, -9}), {0, 0, -1});
  check_vector(z_axis("", {0, 9, -5}), {0, 0, 1});  // on the axis: undefined, unchanged
  check_vector(z_axis("axisOfRotation 0 0 0", {3, 4, -5}), {0.6f, 0.8f, 0});
  check_vector(z_axis("axisOfRotation 1 0 0", {7, 2, -5}), {0, 1, 0});
}

TEST_CASE("shares meshes by USE, shows children of Anchor, Collision and Group, and hides proxies") {
  World world("Group { children [ Anchor { children DEF B " + kBox +
              "} Collision { children USE B proxy Shape { geometry Sphere { } } } USE B ] }");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 4);
  CHECK(list.items[0].mesh == list.items[1].mesh);
  CHECK_FALSE(list.items[2].visible);  // the proxy, which is collidable instead of the box
  CHECK(list.items[2].collidable);
  CHECK(list.items[0].collidable);
  CHECK_FALSE(list.items[1].collidable);
  CHECK(list.items[0].mesh == list.items[3].mesh);
  CHECK(list.items[3].visible);
  CHECK(world.collect().items[0].mesh == list.items[0].mesh);  // later frames share the mesh too
  world.meshes.clear();
  CHECK(world.collect().items[0].mesh != list.items[0].mesh);
}

TEST_CASE("shares one mesh between primitives of any size, node and PROTO instance") {
  World world(
      "PROTO Ball [ field SFFloat r 2 ] { Shape { geometry Sphere { radius IS r } } }\n"
      "Ball { } Ball { } Ball { r 3 } Shape { geometry Sphere { radius 2 } } Shape { geometry Box { size 2 2 2 } }\n"
      "Shape { geometry Cone { bottomRadius 2 height 3 } } Shape { geometry Cone { bottomRadius 3 height 2 } }\n"
      "Shape { geometry Cone { bottomRadius 2 height 3 side FALSE } }");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 8);
  CHECK(list.items[0].mesh == list.items[1].mesh);
  CHECK(list.items[0].mesh == list.items[3].mesh);
  CHECK(list.items[0].mesh == list.items[2].mesh);
  CHECK(list.items[0].mesh != list.items[4].mesh);
  CHECK(list.items[5].mesh == list.items[6].mesh);
  CHECK(list.items[5].mesh != list.items[7].mesh);  // this cone has no side
  check_vector(moved(list.items[2].world_from_node, {1, 1, -1}), {3, 3, -3});
  check_vector(moved(list.items[5].world_from_node, {1, 1, -1}), {2, 1.5f, -2});
  CHECK_FALSE(list.items[0].mesh->texture_coordinates.empty());
}

TEST_CASE("cuts cycles") {
  World world("DEF A Group { children [ DEF B Transform { translation 1 0 0 } " + kBox + "] }");
  const vrml::NodeId a = world.find("A"), b = world.find("B");
  world.scene->set<vrml::MFNode>(b, "children", {a, b});
  const RenderList list = world.collect();
  CHECK(list.items.size() == 1);
}

TEST_CASE("limits items and visits of a hostile tree of USEs") {
  std::string text = "DEF N0 Group { }\n", with_shape = "DEF N0 " + kBox;
  for (int i = 1; i < 60; ++i) {
    const std::string previous = " USE N" + std::to_string(i - 1);
    const std::string level = "DEF N" + std::to_string(i) + " Group { children [" + previous + previous + " ] }\n";
    text += level;
    if (i < 30) with_shape += level;
  }
  Limits limits;
  limits.visits /= watched_step(16);
  CHECK(World(text, limits).collect().items.empty());
  CHECK(World("Transform { scale 0 0 0 children [" + with_shape + "] }", limits).collect().items.size() <= 2'000'000);
}

TEST_CASE("walks deep nesting without recursion") {
  World world("DEF Root Group { }");
  vrml::NodeId parent = world.find("Root");
  const vrml::NodeType& group = *vrml::built_in_node_type("Group");
  for (int i = 0; i < 50'000; ++i) {
    const vrml::NodeId child = world.scene->create(group);
    world.scene->set<vrml::MFNode>(parent, "children", {child});
    parent = child;
  }
  CHECK(world.collect().items.empty());
}

TEST_CASE("applies DirectionalLights to their siblings and descendants, in any order (VRML97 6.16)") {
  World world("Group { children [ " + kBox + "DirectionalLight { direction 0 -1 0 } Group { children " + kBox +
              "} ] }\n" + kBox + "DirectionalLight { on FALSE }\nPointLight { }");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 3);
  REQUIRE(list.lights.size() == 2);
  CHECK(list.items[0].directional_lights == LightList{0});
  CHECK(list.items[1].directional_lights == LightList{0});
  CHECK(list.items[2].directional_lights.empty());
  CHECK(list.lights[0].kind == Light::Kind::directional);
  check_vector(list.lights[0].direction, {0, -1, 0});
  CHECK(list.lights[1].kind == Light::Kind::point);
}

TEST_CASE("transforms lights and their distances to world space") {
  World world(
      "Transform { translation 10 0 0 rotation 0 1 0 1.5707963 scale 2 2 2 children [\n"
      "  SpotLight { location 0 0 -1 direction 0 0 -3 radius 5 attenuation 1 2 4 beamWidth 0.3 cutOffAngle 0.5\n"
      "              color 1 0.5 0 intensity 0.5 ambientIntensity 0.25 } ] }");
  const RenderList list = world.collect();
  REQUIRE(list.lights.size() == 1);
  const Light& light = list.lights[0];
  CHECK(light.kind == Light::Kind::spot);
  check_vector(light.location, {8, 0, 0});
  check_vector(light.direction, {-1, 0, 0});
  CHECK(light.radius == Approx(10));
  check_vector(light.attenuation, {1, 1, 1});
  CHECK(light.beam_width == 0.3f);
  CHECK(light.cut_off_angle == 0.5f);
  CHECK(light.color == glm::vec3(1, 0.5f, 0));
  CHECK(light.intensity == 0.5f);
  CHECK(light.ambient_intensity == 0.25f);
}

TEST_CASE("lists rigid Viewpoints in file order, those of Inlines last") {
  World world(
      "Inline { }\nViewpoint { description \"one\" position 1 2 3 fieldOfView 0.5 }\n"
      "Transform { translation 5 0 0 scale 2 2 -2 rotation 0 1 0 3.14159265 children\n"
      "  DEF V Viewpoint { description \"two\" position 0 0 1 orientation 1 0 0 0.5 } }");
  auto inner = std::make_unique<vrml::SceneGraph>("inner.wrl");
  Diagnostics diagnostics;
  vrml::parse(
      "#VRML V2.0 utf8\nViewpoint { description \"inner\" } Background { skyColor 1 0 0 }\n"
      "NavigationInfo { headlight FALSE } " +
          kBox,
      *inner, diagnostics);
  world.scene->inlines().attach(world.scene->roots()[0], std::move(inner));
  const RenderList list = world.collect();
  REQUIRE(list.viewpoints.size() == 3);
  CHECK(list.viewpoints[0].description == "one");
  CHECK(list.viewpoints[0].field_of_view == 0.5f);
  check_vector(glm::vec3(list.viewpoints[0].world_from_camera[3]), {1, 2, 3});
  CHECK(list.viewpoints[1].description == "two");
  CHECK(list.viewpoints[1].name == "V");
  const glm::mat3 rotation(list.viewpoints[1].world_from_camera);
  CHECK(glm::determinant(rotation) == Approx(1));
  for (int i = 0; i < 3; ++i) CHECK(glm::length(rotation[i]) == Approx(1));
  CHECK(list.viewpoints[2].description == "inner");
  CHECK(list.items.size() == 1);
  // Bindable nodes of an Inline are not bound at start (4.6.10).
  CHECK(list.background.sky_colors[0] == glm::vec3(0));
  CHECK(list.navigation.headlight);
}

TEST_CASE("uses the first NavigationInfo and the first Background") {
  World world(
      "NavigationInfo { type [ \"EXAMINE\" \"NONE\" ] avatarSize [ 1 2 ] speed 3 visibilityLimit 4 headlight FALSE }\n"
      "NavigationInfo { speed 9 }\n"
      "Transform { rotation 1 0 0 1.5707963 scale 3 3 3 children Background { skyColor [ 0 0 1, 1 1 1 ] skyAngle 1.5\n"
      "  groundColor [ 0 1 0, 0 0.5 0, 1 0 0 ] groundAngle [ 1.2, 0.3 ] } }\nBackground { skyColor 1 0 0 }");
  const RenderList list = world.collect();
  CHECK(list.navigation.types == std::vector<std::string>{"EXAMINE", "NONE"});
  CHECK(list.navigation.avatar_size == std::array<float, 3>{1, 2, 0.75f});
  CHECK(list.navigation.speed == 3);
  CHECK(list.navigation.visibility_limit == 4);
  CHECK_FALSE(list.navigation.headlight);
  REQUIRE(list.background.sky_colors.size() == 2);
  CHECK(list.background.sky_colors[0] == glm::vec3(0, 0, 1));
  CHECK(list.background.sky_angles == std::vector<float>{1.5f});
  REQUIRE(list.background.ground_colors.size() == 3);
  CHECK(list.background.ground_angles == std::vector<float>{1.2f, 1.2f});  // angles never decrease
  check_vector(list.background.world_from_background[1], {0, 0, 1});
}

TEST_CASE("collects the first node of PROTO instances (VRML97 4.8.3)") {
  World world(
      "PROTO Place [ field SFVec3f at 1 0 0 exposedField SFColor paint 1 0 0 ] {\n"
      "  Transform { translation IS at children Shape { appearance Appearance { material Material { diffuseColor IS "
      "paint } }\n"
      "    geometry Box { } } } }\nPlace { at 7 0 0 } Place { paint 0 1 0 }");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 2);  // the declaration of the PROTO shows nothing
  CHECK(list.items[0].world_from_node[3].x == 7);
  CHECK(list.items[0].material.diffuse == glm::vec3(1, 0, 0));
  CHECK(list.items[1].world_from_node[3].x == 1);
  CHECK(list.items[1].material.diffuse == glm::vec3(0, 1, 0));
}

TEST_CASE("makes images of PixelTextures, top row first, until their field changes") {
  World world(
      "Shape { appearance Appearance { texture DEF P PixelTexture { repeatS FALSE image 1 2 3 0x102030 0x405060 }\n"
      "  textureTransform TextureTransform { translation 0.5 0 scale 2 1 center 0.25 0 } } geometry Box { } }");
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 1);
  const TextureUse& use = list.items[0].texture;
  REQUIRE(use.image);
  CHECK(use.image->width == 1);
  CHECK(use.image->height == 2);
  CHECK(use.image->components == 3);
  CHECK(use.image->pixels == std::vector<std::uint8_t>{0x40, 0x50, 0x60, 0x10, 0x20, 0x30});
  CHECK_FALSE(use.repeat_s);
  CHECK(use.repeat_t);
  CHECK_FALSE(list.items[0].mesh->texture_coordinates.empty());
  // -C * S * R * C * T: 0 -> +0.5 -> +0.25 -> * 2 -> -0.25
  check_vector(use.transform * glm::vec3(0, 0, 1), {1.25f, 0, 1});
  CHECK(world.collect().items[0].texture.image == use.image);
  vrml::PixelImage changed;
  changed.words = {1, 1, 1, 0x7F};
  world.scene->set<vrml::SFImage>(world.find("P"), "image", changed);
  const RenderList after = world.collect();
  REQUIRE(after.items[0].texture.image);
  CHECK(after.items[0].texture.image->pixels == std::vector<std::uint8_t>{0x7F});
  changed.words = {100, 100, 1, 0x7F};  // claims more pixels than it has
  world.scene->set<vrml::SFImage>(world.find("P"), "image", changed);
  CHECK_FALSE(world.collect().items[0].texture.image);
}

TEST_CASE("shows the image that was loaded for an ImageTexture") {
  World world(
      "Shape { appearance Appearance { texture DEF T ImageTexture { url \"a.png\" repeatT FALSE } } geometry DEF B Box "
      "{ } }\n"
      "Shape { geometry USE B }");
  CHECK_FALSE(world.collect().items.at(0).texture.image);
  const auto image = std::make_shared<const Image>(Image{1, 1, 3, {1, 2, 3}});
  world.images[&world.scene->node(world.find("T"))] = image;
  const RenderList list = world.collect();
  CHECK(list.items[0].texture.image == image);
  CHECK_FALSE(list.items[0].texture.repeat_t);
  CHECK_FALSE(list.items[0].mesh->texture_coordinates.empty());  // made again when texture coordinates were needed
  CHECK(list.items[1].mesh == list.items[0].mesh);
}

TEST_CASE("collects the images of a Background's url fields") {
  World world("DEF B Background { topUrl \"a.png\" frontUrl \"b.png\" }");
  const vrml::Node& node = world.scene->node(world.find("B"));
  const auto fields = node.type->url_fields();
  REQUIRE(fields.size() == Background::kFaces);
  const std::pair<Background::Face, const char*> names[] = {
      {Background::back, "backUrl"}, {Background::bottom, "bottomUrl"}, {Background::front, "frontUrl"},
      {Background::left, "leftUrl"}, {Background::right, "rightUrl"},   {Background::top, "topUrl"}};
  for (const auto& [face, name] : names) {
    CHECK(fields[face]->name == name);
    const auto image = std::make_shared<const Image>(Image{1, 1, 3, {1, 2, 3}});
    world.images = {{ImagePlace(&node, face), image}};
    const RenderList list = world.collect();
    for (std::size_t i = 0; i < Background::kFaces; ++i)
      CHECK(list.background.panorama[i] == (i == face ? image : nullptr));
  }
}

TEST_CASE("rotates and scales textures as in VRML97 6.49") {
  World world(
      "Shape { appearance Appearance { texture PixelTexture { image 1 1 1 0xFF }\n"
      "  textureTransform TextureTransform { rotation 1.5707963 scale 3 1 translation 1 0 } } geometry Box { } }");
  // S * R * T of (1 0): (2 0) -> (0 2) -> (0 2); of (0 1): (1 1) -> (-1 1) -> (-3 1)
  const glm::mat3 matrix = world.collect().items.at(0).texture.transform;
  check_vector(matrix * glm::vec3(1, 0, 1), {0, 2, 1});
  check_vector(matrix * glm::vec3(0, 1, 1), {-3, 1, 1});
}
