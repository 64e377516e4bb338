#include "render/collection/shapes/shape_layers.h"

#include "render/collection/render_scene.h"
#include "tests/render/x3d_scene.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace gs::render::shape_layers_test {
using namespace gs::render::testing;
namespace {

using Coordinates = TextureLayer::Coordinates;
using Mode = TextureLayer::Mode;
using Target = TextureLayer::Target;

const std::string kRed = "PixelTexture { image 1 1 3 0xFF0000 }", kGrey = "PixelTexture { image 1 1 2 0x80FF }";

RenderList list_of(const std::string& body, const std::string& header = "#X3D V4.0 utf8\n") {
  vrml::SceneGraph scene("test.x3dv");
  Diagnostics diagnostics;
  REQUIRE(vrml::parse(header + body, scene, diagnostics) == vrml::ParseOutcome::complete);
  for (const Diagnostic& each : diagnostics.entries()) FAIL_CHECK(each.message);
  MeshCache meshes;
  RenderList list = collect(scene, {}, meshes);
  list.viewpoints.clear();
  list.places.clear();
  REQUIRE(list.items.size() == 1);
  return list;
}

std::string shape(const std::string& appearance, const std::string& geometry = "Box { }") {
  return "Shape { appearance Appearance { " + appearance + " } geometry " + geometry + " }";
}

/// Returns the layers of the only Shape.
std::vector<TextureLayer> layers_of(const std::string& body, const std::string& header = "#X3D V4.0 utf8\n") {
  const RenderList list = list_of(body, header);
  REQUIRE(list.items[0].layered);
  return list.items[0].layered->layers;
}

}  // namespace

TEST_CASE("draws a Material and one texture of X3D without layers") {
  const RenderList modern = list_of(shape("material Material { } texture " + kRed));
  CHECK(!modern.items[0].layered);
  CHECK(modern.items[0].texture.modulates);
  CHECK(!list_of(shape("material Material { } texture " + kRed), "#X3D V3.3 utf8\n").items[0].texture.modulates);
}

TEST_CASE("takes colour and transparency of an UnlitMaterial (X3D 12.4.9)") {
  const RenderList list = list_of(shape("material UnlitMaterial { emissiveColor 1 0.5 0 transparency 0.25 }"));
  CHECK(!list.items[0].material.lit);
  CHECK(list.items[0].material.diffuse == glm::vec3(1, 0.5f, 0));
  CHECK(list.items[0].material.transparency == 0.25f);
}

TEST_CASE("makes a layer per texture of a MultiTexture, with modes, sources and functions (X3D 18.4.3)") {
  const RenderList list = list_of(
      shape("texture MultiTexture { mode [ \"ADD\" \"SUBTRACT / REPLACE\" ] source [ \"\" \"FACTOR\" ] function [ "
            "\"COMPLEMENT\" ] color 1 0.5 0 alpha 0.25 texture [ " +
            kRed + " " + kGrey + " " + kRed + " ] }"));
  REQUIRE(list.items[0].layered);
  const LayeredMaterial& material = *list.items[0].layered;
  CHECK(material.model == LayeredMaterial::Model::unlit);
  CHECK(material.factor == glm::vec4(1, 0.5f, 0, 0.25f));
  REQUIRE(material.layers.size() == 3);
  CHECK(material.layers[0].color_mode == Mode::add);
  CHECK(material.layers[0].function == TextureLayer::Function::complement);
  CHECK(material.layers[1].color_mode == Mode::subtract);
  CHECK(material.layers[1].alpha_mode == Mode::replace);
  CHECK(material.layers[1].source == TextureLayer::Source::factor);
  CHECK(material.layers[2].color_mode == Mode::modulate);
}

TEST_CASE("chooses texture coordinates and transforms of a material's texture by its mapping (X3D 12.2.4)") {
  const auto layers = layers_of(shape(
      "material Material { normalTexture " + kRed + " normalTextureMapping \"b\" diffuseTexture " + kRed +
          " diffuseTextureMapping \"a\" } textureTransform MultiTextureTransform { textureTransform [ TextureTransform "
          "{ mapping \"b\" scale 2 2 } TextureTransform { mapping \"a\" scale 3 3 } ] }",
      "IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 -1 ] texCoord "
      "MultiTextureCoordinate { texCoord [ TextureCoordinate { mapping \"a\" point [ 0 0 1 0 0 1 ] } "
      "TextureCoordinate { mapping \"b\" point [ 1 1 0 0 0 1 ] } ] } }"));
  REQUIRE(layers.size() == 2);
  CHECK(layers[0].target == Target::main);
  CHECK(layers[0].set == 0);
  CHECK(layers[0].transform[0][0] == 3);
  CHECK(layers[1].target == Target::normal);
  CHECK(layers[1].set == 1);
  CHECK(layers[1].transform[0][0] == 2);
}

TEST_CASE("generates texture coordinates with each mode (X3D 18.4.8)") {
  for (const auto& [mode, coordinates] : std::initializer_list<std::pair<std::string, Coordinates>>{
           {"SPHERE", Coordinates::sphere},
           {"CAMERASPACENORMAL", Coordinates::camera_normal},
           {"CAMERASPACEPOSITION", Coordinates::camera_position},
           {"CAMERASPACEREFLECTIONVECTOR", Coordinates::camera_reflection},
           {"SPHERE-LOCAL", Coordinates::sphere_local},
           {"COORD", Coordinates::position},
           {"NOISE", Coordinates::noise},
           {"SPHERE-REFLECT", Coordinates::refraction}}) {
    const auto layers = layers_of(
        shape("texture " + kRed,
              "ElevationGrid { xDimension 2 zDimension 2 height [ 0 0 0 0 ] texCoord TextureCoordinateGenerator { mode "
              "\"" +
                  mode + "\" } }"));
    REQUIRE(layers.size() == 1);
    CHECK(layers[0].coordinates == coordinates);
  }
}

TEST_CASE("replaces the colour by an RGB texture in X3D 3, and modulates it in X3D 4 (X3D 17.2.2)") {
  const std::string body = shape("material Material { } texture " + kRed,
                                 "ElevationGrid { xDimension 2 zDimension 2 height [ 0 0 0 0 ] texCoord "
                                 "TextureCoordinateGenerator { } }");
  CHECK(layers_of(body, "#X3D V3.3 utf8\n")[0].color_mode == Mode::replace);
  CHECK(layers_of(body, "#X3D V3.3 utf8\n")[0].alpha_mode == Mode::off);
  CHECK(layers_of(body)[0].color_mode == Mode::modulate);
}

TEST_CASE("stacks textures and reads pixels to volumes, with the box as coordinates (X3D 33.4)") {
  const auto stacked = layers_of(shape("texture ComposedTexture3D { texture [ " + kRed + " " + kRed + " ] }"));
  REQUIRE(stacked.size() == 1);
  CHECK(stacked[0].kind == TextureLayer::Kind::volume);
  CHECK(stacked[0].image->slices == 2);
  // The box becomes a matrix from positions of the default Box.
  CHECK(stacked[0].coordinates == Coordinates::position);
  CHECK(stacked[0].transform * glm::vec4(-1, -1, 1, 1) == glm::vec4(0, 0, 1, 1));
  const auto pixels = layers_of(shape("texture PixelTexture3D { image [ 1 1 2 2 1 2 3 4 ] }"));
  REQUIRE(pixels.size() == 1);
  CHECK(pixels[0].image->slices == 2);
  CHECK(pixels[0].image->pixels == std::vector<std::uint8_t>{2, 1, 4, 3});  // rows of an Image begin at the top
}

TEST_CASE("reads faces of cube maps, which reflect the world without coordinates (X3D 34.4)") {
  const auto composed = layers_of(shape("texture ComposedCubeMapTexture { frontTexture " + kRed + " }"));
  REQUIRE(composed.size() == 1);
  CHECK(composed[0].kind == TextureLayer::Kind::cube);
  CHECK(composed[0].faces[Background::front]);
  CHECK(composed[0].coordinates == Coordinates::world_reflection);
  const auto generated = layers_of(shape("texture GeneratedCubeMapTexture { update \"ALWAYS\" size 64 }"));
  REQUIRE(generated.size() == 1);
  REQUIRE(generated[0].scene_cube);
  CHECK(generated[0].scene_cube->size == 64);
  CHECK(generated[0].scene_cube->update == SceneCube::Update::always);
}

TEST_CASE("takes filters and edges of TextureProperties (X3D 18.4.10)") {
  const RenderList list = list_of(
      shape("texture PixelTexture { image 1 1 3 0xFF0000 textureProperties TextureProperties { magnificationFilter "
            "\"NEAREST_PIXEL\" minificationFilter \"AVG_PIXEL\" boundaryModeS \"CLAMP_TO_EDGE\" boundaryModeT "
            "\"MIRRORED_REPEAT\" borderColor 1 0 0 1 } }"));
  REQUIRE(list.items[0].texture.sampling);
  const Sampling& sampling = *list.items[0].texture.sampling;
  CHECK(!sampling.smooth);
  CHECK(sampling.smaller == Sampling::Filter::linear);
  CHECK(sampling.s == Sampling::Edge::clamp);
  CHECK(sampling.t == Sampling::Edge::mirror);
  CHECK(sampling.border == glm::vec4(1, 0, 0, 1));
}

TEST_CASE("takes the values of PhysicalMaterial, TwoSidedMaterial and backMaterial (X3D 12.4)") {
  const RenderList physical =
      list_of(shape("material PhysicalMaterial { baseColor 1 0.5 0 metallic 0.25 roughness 0.75 }"));
  REQUIRE(physical.items[0].layered);
  CHECK(physical.items[0].layered->model == LayeredMaterial::Model::physical);
  CHECK(physical.items[0].layered->metallic == 0.25f);
  CHECK(physical.items[0].material.diffuse.g == Approx(std::pow(0.5, 1 / 2.2)));  // a colour of a display
  CHECK(!list_of(shape("material TwoSidedMaterial { backDiffuseColor 1 0 0 }")).items[0].layered);
  const RenderList two = list_of(shape("material TwoSidedMaterial { separateBackColor TRUE backDiffuseColor 1 0 0 }"));
  REQUIRE(two.items[0].layered);
  CHECK(two.items[0].layered->back.main == glm::vec3(1, 0, 0));
  const RenderList back =
      list_of(shape("material Material { } backMaterial Material { emissiveColor 0 1 0 transparency 0.5 }"));
  REQUIRE(back.items[0].layered);
  CHECK(back.items[0].layered->back.emissive == glm::vec3(0, 1, 0));
  CHECK(back.items[0].layered->back.transparency == 0.5f);
}

TEST_CASE("takes textures of a TextureBackground and its transparency (X3D 24.4.6)") {
  const auto scene = x3d_scene("TextureBackground { leftTexture " + kRed + " transparency 0.5 }");
  MeshCache meshes;
  const RenderList list = collect(*scene, {}, meshes);
  CHECK(list.background.panorama[Background::left]);
  CHECK(!list.background.panorama[Background::right]);
  CHECK(list.background.transparency == 0.5f);
}

TEST_CASE("limits lights that are not global to their group (X3D 17.2.1.1)") {
  const auto scene = x3d_scene(
      "Group { children [ PointLight { global FALSE } DirectionalLight { global TRUE } Shape { geometry Box { } } ] } "
      "Shape { geometry Box { } }");
  MeshCache meshes;
  const RenderList list = collect(*scene, {}, meshes);
  REQUIRE(list.items.size() == 2);
  REQUIRE(list.lights.size() == 2);
  CHECK(list.items[0].directional_lights.size() == 1);
  CHECK(list.items[1].directional_lights.empty());
  const auto listed = std::count_if(list.lights.begin(), list.lights.end(), [](const Light& l) { return l.listed(); });
  CHECK(listed == 1);
}

}  // namespace gs::render::shape_layers_test
