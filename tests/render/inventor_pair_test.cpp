// Pairs of worlds with equal pictures: one in VRML 1.0 or Inventor, the other in VRML97.

#include "render/collection/render_scene.h"
#include "tests/render/drawing.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace gs::render::inventor_pair_test {
using namespace gs::render::testing;
namespace {

struct ReadWorld {
  explicit ReadWorld(const std::string& text) : scene(std::make_unique<vrml::SceneGraph>("pair.wrl")) {
    Diagnostics diagnostics;
    (void)vrml::parse(text, *scene, diagnostics);
    for (const Diagnostic& d : diagnostics.entries()) UNSCOPED_INFO(d.text());
    REQUIRE(diagnostics.errors() == 0);
  }
  Image draw(Drawing& drawing, const Camera& camera) {
    const glm::vec3 eye(camera.world_from_camera[3]);
    return drawing.draw(collect(*scene, images, meshes, eye), camera);
  }
  std::unique_ptr<vrml::SceneGraph> scene;
  Images images;
  MeshCache meshes;
};

/// Draws both worlds from the same camera, and compares the pixels.
void check_pair(const std::string& old_world, const std::string& vrml97) {
  INFO(old_world << "\n" << vrml97);
  Drawing drawing;
  drawing.options.width = drawing.options.height = 120;
  drawing.options.samples = 4;
  const Image first = ReadWorld(old_world).draw(drawing, camera_at({0, 0, 6})),
              second = ReadWorld("#VRML V2.0 utf8\n" + vrml97).draw(drawing, camera_at({0, 0, 6}));
  REQUIRE(first.pixels.size() == second.pixels.size());
  std::size_t shown = 0, different = 0;
  for (std::size_t i = 0; i < first.pixels.size(); i += 3) {
    int most = 0, light = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      most = std::max(most, std::abs(int{first.pixels[i + c]} - int{second.pixels[i + c]}));
      light += first.pixels[i + c];
    }
    shown += light > 30 ? 1U : 0U;
    different += most > 2 ? 1U : 0U;
  }
  CHECK(shown > 200);
  CHECK(different * 500 < first.pixels.size() / 3);
}

const std::string kOld = "#VRML V1.0 ascii\n", kInventor = "#Inventor V2.1 ascii\n";
const std::string kSquare = "[ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0 ]";
const std::string kRed = "appearance Appearance { material Material { diffuseColor 1 0.2 0.2 } } ";

std::string square(const std::string& fields, const std::string& appearance = kRed) {
  return "Shape { " + appearance + "geometry IndexedFaceSet { solid FALSE creaseAngle 0.5 coord Coordinate { point " +
         kSquare + " } " + fields + " } }";
}

}  // namespace

TEST_CASE("draws transforms of VRML 1.0 equal to Transforms of VRML97") {
  check_pair(
      kOld +
          "Separator { Material { diffuseColor 1 0.2 0.2 } Translation { translation 1 0 0 } Rotation { rotation "
          "0 0 1 0.5 } Scale { scaleFactor 1 0.5 1 } Rotation { rotation 1 1 0 1 } Cube { } }",
      "Transform { translation 1 0 0 rotation 0 0 1 0.5 children Transform { scale 1 0.5 1 children Transform { "
      "rotation 1 1 0 1 children Shape { " +
          kRed + "geometry Box { } } } } }");
  // A shear, applied to the points by hand.
  check_pair(kInventor +
                 "Separator { Material { diffuseColor 1 0.2 0.2 } MatrixTransform { matrix 1 0.5 0 0 0 1 0 0 0 0 1 0 "
                 "0.5 0 0 1 } ShapeHints { creaseAngle 0.5 } Coordinate3 { point " +
                 kSquare + " } FaceSet { numVertices 4 } }",
             "Shape { " + kRed +
                 "geometry IndexedFaceSet { solid FALSE coord Coordinate { point [ -0.5 -1.5 0, 1.5 -0.5 0, "
                 "1.5 1.5 0, -0.5 0.5 0 ] } coordIndex [ 0 1 2 3 ] } }");
}

TEST_CASE("draws materials per face and per vertex of VRML 1.0 equal to colours of VRML97") {
  const std::string state =
      "Coordinate3 { point " + kSquare + " } Material { ambientColor 0.2 0 0 diffuseColor [ 1 0 0, 0 1 0, 0 0 1 ] } ";
  const std::string white = "appearance Appearance { material Material { } } ";
  check_pair(
      kOld + state + "MaterialBinding { value PER_FACE } IndexedFaceSet { coordIndex [ 0, 1, 2, -1, 0, 2, 3, -1 ] }",
      square("coordIndex [ 0 1 2 -1 0 2 3 -1 ] colorPerVertex FALSE color Color { color [ 1 0 0, 0 1 0 ] }", white));
  check_pair(kOld + state +
                 "MaterialBinding { value PER_VERTEX_INDEXED } IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] "
                 "materialIndex [ 2, 1, 0, 2, -1 ] }",
             square("coordIndex [ 0 1 2 3 -1 ] colorIndex [ 2 1 0 2 -1 ] color Color { color [ 1 0 0, 0 1 0, 0 0 1 ] }",
                    white));
  check_pair(kInventor + state +
                 "ShapeHints { creaseAngle 0.5 } MaterialBinding { value PER_PART } LightModel { model BASE_COLOR } "
                 "TriangleStripSet { "
                 "numVertices 4 }",
             "Shape { appearance Appearance { material Material { diffuseColor 0 0 0 emissiveColor 1 0 0 } } geometry "
             "IndexedFaceSet { solid FALSE coord Coordinate { point " +
                 kSquare + " } coordIndex [ 0 1 2 -1 2 1 3 -1 ] } }");
}

TEST_CASE("draws transformed textures of VRML 1.0 equal to transformed coordinates of VRML97") {
  const std::string image = "image 2 2 3 0xff0000 0x00ff00 0x0000ff 0xffff00";
  const std::string index = "coordIndex [ 0, 1, 2, 3, -1 ]";
  // Coordinates by hand: translation * rotation * scale.
  const double angle = 0.4;
  std::string points;
  for (const auto& [s, t] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
    const double x = 2 * s, y = 2 * t;
    points += std::to_string(0.25 + std::cos(angle) * x - std::sin(angle) * y) + ' ' +
              std::to_string(std::sin(angle) * x + std::cos(angle) * y) + ", ";
  }
  const std::string coordinates = "TextureCoordinate2 { point [ 0 0, 1 0, 1 1, 0 1 ] } ";
  check_pair(kOld + "Coordinate3 { point " + kSquare + " } Texture2 { " + image +
                 " } Texture2Transform { translation 0.25 0 "
                 "rotation 0.4 scaleFactor 2 2 } " +
                 coordinates + "IndexedFaceSet { " + index + " }",
             square(index + " texCoord TextureCoordinate { point [ " + points + " ] }",
                    "appearance Appearance { material Material { } texture PixelTexture { " + image + " } } "));
}

TEST_CASE("draws texts, lines and parts of solids of VRML 1.0 equal to VRML97") {
  check_pair(
      kOld +
          "Material { diffuseColor 1 0.2 0.2 } FontStyle { size 1 family SANS } AsciiText { string [ \"ab\", \"c\" ] "
          "justification RIGHT }",
      "Shape { " + kRed +
          "geometry Text { string [ \"ab\" \"c\" ] fontStyle FontStyle { family \"SANS\" justify "
          "\"END\" } } }");
  check_pair(
      kOld + "Material { diffuseColor 1 0.2 0.2 } DrawStyle { style LINES } Coordinate3 { point " + kSquare +
          " } IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] }",
      "Shape { appearance Appearance { material Material { emissiveColor 1 0.2 0.2 } } geometry IndexedLineSet { "
      "coord Coordinate { point " +
          kSquare + " } coordIndex [ 0 1 2 3 0 ] } }");
  check_pair(kOld +
                 "Separator { Material { diffuseColor [ 1 0.2 0.2, 1 0.2 0.2 ] } MaterialBinding { value PER_PART } "
                 "Rotation { rotation 1 0 0 0.5 } Cone { } }",
             "Transform { rotation 1 0 0 0.5 children Shape { " + kRed + "geometry Cone { } } }");
}

}  // namespace gs::render::inventor_pair_test
