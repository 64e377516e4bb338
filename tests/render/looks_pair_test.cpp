// Pairs of worlds with equal pictures: one uses a field of Text, Fog or Background, the other has an equivalent without
// this field.

#include "render/collection/render_scene.h"
#include "tests/render/drawing.h"
#include "tests/vrml/encodings.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <memory>
#include <string>

namespace gs::render::looks_pair_test {
using namespace gs::render::testing;
namespace {

struct ParsedWorld {
  explicit ParsedWorld(const std::string& body) : ParsedWorld(body, vrml::Grammar::vrml97) {}
  ParsedWorld(const std::string& body, vrml::Grammar grammar)
      : scene(std::make_unique<vrml::SceneGraph>("pair.wrl")) {
    Diagnostics diagnostics;
    const std::string vrml97 = "#VRML V2.0 utf8\n" + body;
    (void)vrml::parse(grammar == vrml::Grammar::vrml97 ? vrml97 : vrml::testing::encoded(vrml97, grammar), *scene,
                      diagnostics);
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

/// Returns the pixels, in thousandths, that differ by more than rounding.
double difference(const Image& a, const Image& b) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  std::size_t others = 0;
  for (std::size_t i = 0; i < a.pixels.size(); i += 3) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(int{a.pixels[i + c]} - int{b.pixels[i + c]}));
    others += most > 2;
  }
  return 3000.0 * static_cast<double>(others) / static_cast<double>(a.pixels.size());
}

std::size_t shown(const Image& image) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3)
    count += image.pixels[i] + image.pixels[i + 1] + image.pixels[i + 2] > 30;
  return count;
}

void check_alike(const std::string& one, const std::string& other) {
  INFO(one << "\n" << other);
  Drawing drawing;
  drawing.options.width = drawing.options.height = 160;
  drawing.options.samples = 4;
  const Image first = ParsedWorld(one).draw(drawing, camera_at({0, 0, 10})),
              second = ParsedWorld(other).draw(drawing, camera_at({0, 0, 10}));
  CHECK(shown(first) > 120);
  CHECK(difference(first, second) < 2);
  for (const vrml::Grammar grammar : vrml::testing::kX3DGrammars) {
    INFO(vrml::testing::name_of(grammar));
    CHECK(ParsedWorld(one, grammar).draw(drawing, camera_at({0, 0, 10})).pixels == first.pixels);
  }
}

const std::string kPaint = "appearance Appearance { material Material { diffuseColor 1 0.8 0.2 } } ";

std::string text(const std::string& fields, const std::string& transform = "") {
  return "Transform { " + transform + " children Shape { " + kPaint + "geometry Text { " + fields + " } } }\n";
}

}  // namespace

TEST_CASE("draws Text equal to Text with explicit defaults, scales and translations") {
  const std::string word = "string \"Shore\"";
  // 6.20: the defaults.
  check_alike(text(word),
              text(word + " fontStyle FontStyle { family \"SERIF\" style \"PLAIN\" justify [ \"BEGIN\" "
                          "\"FIRST\" ] size 1 spacing 1 horizontal TRUE leftToRight TRUE topToBottom TRUE }"));
  check_alike(text(word + " fontStyle FontStyle { family [ ] style \"\" justify \"\" }"), text(word));
  // size acts like scale.
  check_alike(text(word + " fontStyle FontStyle { size 2 }"), text(word, "scale 2 2 2"));
  // Lines are size * spacing apart.
  check_alike(text("string [ \"Sea\" \"shore\" ] fontStyle FontStyle { spacing 1.5 }"),
              text("string \"Sea\"") + text("string \"shore\"", "translation 0 -1.5 0"));
  check_alike(text("string [ \"Sea\" \"\" \"shore\" ] fontStyle FontStyle { topToBottom FALSE }"),
              text("string \"Sea\"") + text("string \"shore\"", "translation 0 2 0"));
  // maxExtent of one string acts like length if the string is too long.
  check_alike(text(word + " maxExtent 1.5"), text(word + " length 1.5"));
  check_alike(text(word + " maxExtent 50"), text(word));
  // Columns follow each other like lines.
  const std::string vertical = " fontStyle DEF F FontStyle { horizontal FALSE justify \"MIDDLE\" }",
                    again = " fontStyle USE F";
  check_alike(text("string [ \"Sea\" \"tide\" ]" + vertical),
              text("string \"Sea\"" + vertical) + text("string \"tide\"" + again, "translation 1 0 0"));
}

TEST_CASE("draws Text by USE and by PROTO equal to Text without them") {
  const std::string words = "Text { string [ \"ab\" \"cd\" ] fontStyle FontStyle { style \"BOLD\" } }";
  const std::string shape = "Shape { " + kPaint + "geometry ";
  const std::string plain = "Transform { children " + shape + words + " } }\n" +
                            "Transform { translation 0 3 0 children " + shape + words + " } }";
  check_alike(plain, "Transform { children " + shape + "DEF W " + words + " } }\n" +
                         "Transform { translation 0 3 0 children " + shape + "USE W } }");
  check_alike(plain,
              "PROTO Style [ field SFString look \"BOLD\" ] { FontStyle { style IS look } }\n"
              "PROTO Words [ exposedField MFString words [ ] ] { Text { string IS words fontStyle Style { } } }\n"
              "Transform { children " +
                  shape + "Words { words [ \"ab\" \"cd\" ] } } }\nTransform { translation 0 3 0 children " + shape +
                  "Words { words [ \"ab\" \"cd\" ] } } }");
}

TEST_CASE("lights Text from both sides, and mirrors it from behind") {  // 6.47.1
  ParsedWorld world("Viewpoint { } " +
                    text("string \"LLL\" fontStyle FontStyle { family \"SANS\" justify \"MIDDLE\" size 2 }"));
  Drawing drawing;
  drawing.options.width = drawing.options.height = 161;
  drawing.options.samples = 4;
  const Image front = world.draw(drawing, camera_at({0, 0, 10}));
  Camera turned = camera_at({0, 0, -10});
  turned.world_from_camera[0] = {-1, 0, 0, 0};
  turned.world_from_camera[2] = {0, 0, -1, 0};
  Image behind = world.draw(drawing, turned);
  CHECK(shown(front) > 200);
  Image mirrored = behind;
  for (std::uint32_t y = 0; y < behind.height; ++y)
    for (std::uint32_t x = 0; x < behind.width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        mirrored.pixels[(std::size_t{y} * behind.width + x) * 3 + c] =
            behind.pixels[(std::size_t{y} * behind.width + behind.width - 1 - x) * 3 + c];
  CHECK(difference(front, mirrored) < 5);
  CHECK(difference(front, behind) > 5);
}

TEST_CASE("draws small texts in one batch as one by one") {
  const std::string lights =
      "DirectionalLight { direction 1 -1 -1 color 1 0.3 0.2 ambientIntensity 0.5 } NavigationInfo { headlight TRUE } ";
  const auto label = [](const std::string& transform, const std::string& material, const std::string& word) {
    return "Transform { " + transform + " children Shape { appearance Appearance { material Material { " + material +
           " } } geometry Text { string \"" + word + "\" fontStyle FontStyle { size 0.1 } } } } ";
  };
  const std::string labels =
      label("translation -1 0.5 0", "diffuseColor 0.9 0.8 0.1", "north") +
      label("translation -1 0 1 rotation 0 1 0 0.8", "diffuseColor 0.2 0.8 0.9 emissiveColor 0.1 0 0.2", "harbour") +
      label("translation 1 -0.4 0 rotation 0 1 0 2.6", "ambientIntensity 1", "turned") +
      label("translation 1 0.4 0 scale -1 1 1", "diffuseColor 1 1 1", "mirrored") +
      label("translation -0.6 -0.8 0 scale 1.5 1 1 rotation 1 0 0 0.7", "", "stretched") +
      label("translation 0 -0.2 -1", "emissiveColor 0 0 0.6", "22.4 m");
  const std::string fog = "Fog { visibilityRange 30 color 0.2 0.3 0.2 } ";
  for (const std::string& about : {lights, fog, lights + fog, "PointLight { location 0 0 3 } " + lights})
    for (const int samples : {1, 4}) {
      INFO(about << samples);
      ParsedWorld world(about + labels);
      const Geometries geometries;
      RenderScene gathered(*world.scene, world.images, geometries, world.meshes);
      gathered.gather({}, {0, 0, 10});
      RenderList list = gathered.list();
      REQUIRE(list.items.size() == 6);
      for (const DrawItem& item : list.items) REQUIRE(item.mesh->pictured);
      Drawing drawing;
      drawing.options.width = 480;
      drawing.options.height = 360;
      drawing.options.samples = samples;
      Camera camera = camera_at({0, 0, 10});
      camera.field_of_view = 0.3f;
      const Image merged = drawing.draw(list, camera);
      // A point light differs between the pixels of a text.
      CHECK((drawing.statistics.draw_calls == 1) == (about.find("Point") == std::string::npos));
      CHECK(drawing.statistics.items == 6);
      // A slightly specular item gets a colour per pixel.
      for (DrawItem& item : list.items) item.material.specular = glm::vec3(1e-6f);
      list.generation = 0;
      const Image single = drawing.draw(list, camera);
      CHECK(drawing.statistics.draw_calls > 1);
      CHECK(shown(merged) > 300);
      CHECK(difference(merged, single) < 0.1);
    }
}

TEST_CASE("draws fog in a scaled coordinate system as its colour at that distance") {
  const std::string ball = "Shape { " + kPaint + "geometry Sphere { radius 2 } }";
  check_alike("Transform { scale 2 2 2 children Fog { visibilityRange 10 fogType \"EXPONENTIAL\" } } " + ball,
              "Fog { visibilityRange 20 fogType \"EXPONENTIAL\" } " + ball);
  check_alike("Fog { visibilityRange 0 } " + ball, ball);
  check_alike("Fog { visibilityRange 5 color 0.2 0.9 0.4 } " + ball,
              "Shape { appearance Appearance { material Material { diffuseColor 0 0 0 emissiveColor 0.2 0.9 0.4 } } "
              "geometry Sphere { radius 2 } }");
}

TEST_CASE("draws a panorama of one colour like a sky of that colour") {
  Drawing drawing;
  ParsedWorld painted("Background { frontUrl \"a.png\" leftUrl \"a.png\" rightUrl \"a.png\" skyColor 1 0 0 }"),
      sky("Background { skyColor 0.2 0.4 0.8 }");
  const auto image = std::make_shared<const Image>(Image{1, 1, 3, {51, 102, 204}});
  const vrml::Node* node = &painted.scene->node(painted.scene->roots()[0]);
  for (const auto face : {Background::front, Background::left, Background::right}) painted.images[{node, face}] = image;
  Camera camera = camera_at({3, 4, 5});
  CHECK(difference(painted.draw(drawing, camera), sky.draw(drawing, camera)) == 0);
}

}  // namespace gs::render::looks_pair_test
