// Pictures of layered materials, compared with the equations of the standard.

#include "tests/render/drawing.h"
#include "tests/render/x3d_scene.h"

#include <string>

namespace gs::render::layered_test {
using namespace gs::render::testing;
namespace {

/// Square of 2 x 2 metres in the plane z = 0, with texture coordinates 0 to 1.
const std::string kSquare =
    "IndexedFaceSet { solid FALSE coord Coordinate { point [ -1 -1 0 1 -1 0 1 1 0 -1 1 0 ] } coordIndex [ 0 1 2 3 -1 ] "
    "texCoord TextureCoordinate { point [ 0 0 1 0 1 1 0 1 ] } }";

std::string square(const std::string& appearance, const std::string& geometry = kSquare) {
  return "Shape { appearance Appearance { " + appearance + " } geometry " + geometry + " } ";
}

std::string texture(const std::string& pixel, int components = 3) {
  return "PixelTexture { image 1 1 " + std::to_string(components) + " " + pixel + " }";
}

struct Shown {
  Drawing drawing;
  /// Returns the colour in the middle of the picture.
  glm::vec3 color(const std::string& body, const glm::vec3& eye = {0, 0, 3}) {
    const auto scene = x3d_scene(body);
    MeshCache meshes;
    return pixel(drawing.draw(collect(*scene, {}, meshes), camera_at(eye)), 32, 32);
  }
};

}  // namespace

TEST_CASE("blends the textures of a MultiTexture by each mode (X3D Table 18.3)") {
  Shown shown;
  const glm::vec3 a(0.8f, 0.4f, 0.2f), b(0.6f, 0.2f, 1.0f);  // texture 0xCC6633 over 0x9933FF
  const auto mode = [&](const std::string& name) {
    return shown.color(square("texture MultiTexture { mode [ \"REPLACE\" \"" + name + "\" ] texture [ " +
                              texture("0x9933FF") + " " + texture("0xCC6633") + " ] }"));
  };
  check_color(mode("MODULATE"), a * b);
  check_color(mode("REPLACE"), a);
  check_color(mode("MODULATE2X"), 2.0f * a * b);
  check_color(mode("ADD"), a + b);
  check_color(mode("ADDSIGNED"), a + b - 0.5f);
  check_color(mode("SUBTRACT"), a - b);
  check_color(mode("ADDSMOOTH"), a + (1.0f - a) * b);
  check_color(mode("SELECTARG2"), b);
  check_color(mode("OFF"), b);
  check_color(mode("DOTPRODUCT3"), glm::vec3(4 * glm::dot(a - 0.5f, b - 0.5f)));
}

TEST_CASE("modulates the colours of a Material by its textures (X3D 17.2.2.4)") {
  Shown shown;
  // The headlight is perpendicular to the square.
  check_color(
      shown.color(square("material Material { diffuseColor 1 0.5 1 diffuseTexture " + texture("0x8080FF") + " }")),
      {0.502f, 0.251f, 1});
  check_color(shown.color(square("material Material { diffuseColor 0 0 0 emissiveColor 1 1 0.5 emissiveTexture " +
                                 texture("0xFF80FF") + " }")),
              {1, 0.502f, 0.5f});
  check_color(shown.color(square("material Material { diffuseColor 1 1 1 occlusionStrength 0.5 occlusionTexture " +
                                 texture("0x000000") + " }")),
              glm::vec3(0.5f));
  check_color(shown.color(square("material UnlitMaterial { emissiveColor 1 0.5 0 emissiveTexture " +
                                 texture("0x80FFFF") + " }")),
              {0.502f, 0.5f, 0});
}

TEST_CASE("bends the normal by a normal map (X3D 12.2.4)") {
  Shown shown;
  const auto with = [&](const std::string& normal) {
    return shown.color(square("material Material { diffuseColor 1 1 1 normalTexture " + texture(normal) + " }"));
  };
  check_color(with("0x8080FF"), glm::vec3(1), 3);
  // A normal of 45 degrees to the right.
  check_color(with("0xDA80DA"), glm::vec3(0.707f), 4);
}

TEST_CASE("reflects 1 / pi of the light from a white PhysicalMaterial, and less if it is a rough metal") {
  Shown shown;
  // Linear 1 / pi is 0.6 on displays.
  check_color(shown.color(square("material PhysicalMaterial { metallic 0 roughness 1 }")), glm::vec3(0.6f), 4);
  // A rough metal reflects a quarter of that.
  check_color(shown.color(square("material PhysicalMaterial { metallic 1 roughness 1 }")), glm::vec3(0.3125f), 6);
}

TEST_CASE("shows the colours of the back on back faces (X3D 12.4.8)") {
  Shown shown;
  const std::string body =
      square("material TwoSidedMaterial { separateBackColor TRUE diffuseColor 1 0 0 backDiffuseColor 0 1 0 }");
  check_color(shown.color(body), {1, 0, 0});
  check_color(shown.color("Transform { rotation 0 1 0 3.14159265 children " + body + " }"), {0, 1, 0});
  const std::string back = square("material Material { } backMaterial Material { diffuseColor 0 0 1 }");
  check_color(shown.color("Transform { rotation 0 1 0 3.14159265 children " + back + " }"), {0, 0, 1});
}

TEST_CASE("treats alpha as the alphaMode requests (X3D 12.4.1)") {
  Shown shown;
  const auto mode = [&](const std::string& name, const std::string& pixel) {
    return shown.color(square("alphaMode \"" + name + "\" alphaCutoff 0.4 texture " + texture(pixel, 4)));
  };
  check_color(mode("AUTO", "0xFFFFFF80"), glm::vec3(0.5f), 2);
  check_color(mode("OPAQUE", "0xFFFFFF80"), glm::vec3(1));
  check_color(mode("MASK", "0xFFFFFF80"), glm::vec3(1));
  check_color(mode("MASK", "0xFFFFFF40"), glm::vec3(0));
  check_color(mode("BLEND", "0xFFFFFF40"), glm::vec3(0.25f), 2);
}

TEST_CASE("samples volumes by three coordinates (X3D 33.4)") {
  Shown shown;
  const std::string volume =
      "texture PixelTexture3D { image [ 3 1 1 2 0xFF0000 0x00FF00 ] textureProperties TextureProperties { "
      "boundaryModeR \"CLAMP_TO_EDGE\" } }";
  const auto at = [&](const std::string& r) {
    return shown.color(square(volume,
                              "IndexedFaceSet { coord Coordinate { point [ -1 -1 0 1 -1 0 0 1 0 ] } coordIndex "
                              "[ 0 1 2 -1 ] texCoord TextureCoordinate3D { point [ 0 0 " +
                                  r + " 1 0 " + r + " 0 1 " + r + " ] } }"));
  };
  check_color(at("0.25"), {1, 0, 0});
  check_color(at("0.75"), {0, 1, 0});
}

TEST_CASE("reflects the faces of a cube map in their directions (X3D 34.4.1)") {
  Shown shown;
  const std::string cube = "texture ComposedCubeMapTexture { frontTexture " + texture("0xFF0000") + " backTexture " +
                           texture("0x00FF00") + " leftTexture " + texture("0x0000FF") + " rightTexture " +
                           texture("0xFFFF00") + " topTexture " + texture("0x00FFFF") + " bottomTexture " +
                           texture("0xFF00FF") + " }";
  // The square faces the viewer. It reflects the content behind the viewer.
  check_color(shown.color(square(cube)), {0, 1, 0});
  const auto direction = [&](const std::string& v) {
    return shown.color(square(cube,
                              "IndexedFaceSet { coord Coordinate { point [ -1 -1 0 1 -1 0 0 1 0 ] } coordIndex [ "
                              "0 1 2 -1 ] texCoord TextureCoordinate3D { point [ " +
                                  v + " " + v + " " + v + " ] } }"));
  };
  check_color(direction("0 0 -1"), {1, 0, 0});
  check_color(direction("-1 0 0"), {0, 0, 1});
  check_color(direction("1 0 0"), {1, 1, 0});
  check_color(direction("0 1 0"), {0, 1, 1});
  check_color(direction("0 -1 0"), {1, 0, 1});
}

TEST_CASE("shows a panorama of an ImageCubeMapTexture in its directions, and no texture without an image") {
  Shown shown;
  const auto body = [](const std::string& v) {
    return square("material UnlitMaterial { emissiveColor 1 1 1 } texture ImageCubeMapTexture { url \"sky.png\" }",
                  "IndexedFaceSet { coord Coordinate { point [ -1 -1 0 1 -1 0 0 1 0 ] } coordIndex [ 0 1 2 -1 ] "
                  "texCoord TextureCoordinate3D { point [ " +
                      v + " " + v + " " + v + " ] } }");
  };
  check_color(shown.color(body("0 0 1")), {1, 1, 1});
  // Columns from the direction -Z: blue, yellow in -X, red in +Z, green in +X, blue.
  auto sky = std::make_shared<Image>(Image{8, 4, 3, {}});
  for (int row = 0; row < 4; ++row)
    for (const int column : {0, 1, 1, 2, 2, 3, 3, 0}) {
      constexpr std::uint8_t kColors[4][3] = {{0, 0, 255}, {255, 255, 0}, {255, 0, 0}, {0, 255, 0}};
      sky->pixels.insert(sky->pixels.end(), kColors[column], kColors[column] + 3);
    }
  const auto with_sky = [&](const std::string& v) {
    const auto scene = x3d_scene(body(v));
    Images images;
    const auto appearance = scene->get<vrml::SFNode>(scene->roots()[0], "appearance");
    images[&scene->node(scene->get<vrml::SFNode>(appearance, "texture"))] = sky;
    MeshCache meshes;
    return pixel(shown.drawing.draw(collect(*scene, images, meshes), camera_at({0, 0, 3})), 32, 32);
  };
  check_color(with_sky("0 0 1"), {1, 0, 0});
  check_color(with_sky("1 0 0"), {0, 1, 0});
  check_color(with_sky("0 0 -1"), {0, 0, 1});
  check_color(with_sky("-1 0 0"), {1, 1, 0});
}

TEST_CASE("draws the scene around a GeneratedCubeMapTexture (X3D 34.4.2)") {
  Shown shown;
  const std::string mirror = square("texture GeneratedCubeMapTexture { update \"ALWAYS\" size 32 }");
  const std::string behind =
      "Transform { translation 0 0 8 children Shape { appearance Appearance { material UnlitMaterial { emissiveColor 1 "
      "0.5 0 } } geometry Box { } } }";
  check_color(shown.color(mirror + behind), {1, 0.5f, 0}, 3);
  check_color(shown.color(square("texture GeneratedCubeMapTexture { update \"NONE\" }") + behind), {0, 0, 0});
}

TEST_CASE("clips and hatches layered materials like others") {
  Shown shown;
  const std::string shape = square("material PhysicalMaterial { emissiveColor 1 0 0 }");
  check_color(shown.color("ClipPlane { plane 0 0 1 -1 } " + shape), {0, 0, 0});
}

TEST_CASE("dims the sky by the transparency of a Background (X3D 24.4.1)") {
  Shown shown;
  check_color(shown.color("Background { skyColor 1 0.5 0 transparency 0.5 }"), {0.5f, 0.25f, 0});
}

}  // namespace gs::render::layered_test
