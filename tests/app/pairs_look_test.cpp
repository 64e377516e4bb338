// Tests of lights, materials and textures that must look alike.
#include "tests/app/pairs.h"

#include "render/image/image_codecs.h"

#include <cmath>

namespace gs::app::pairs_look_test {

using namespace pairs;

namespace {

const std::string kDark =
    "NavigationInfo { headlight FALSE }\nViewpoint { position 2.2 2.4 5 orientation -0.74 0.66 0.12 0.55 }\n";
const std::string kLit = kDark + "DirectionalLight { direction -0.3 -1 -0.6 ambientIntensity 0.4 }\n";

std::string shape(const std::string& appearance, const std::string& geometry = "Box { size 2 1 1.5 }") {
  return "Shape { appearance Appearance { " + appearance + " } geometry " + geometry + " }\n";
}
std::string material(const std::string& fields) { return "material Material { " + fields + " } "; }
/// A square that faces the viewer.
const std::string kSquare =
    "IndexedFaceSet { coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0 ] } coordIndex [ 0 1 2 3 ] "
    "texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } }";
const std::string kColors = "image 4 2 3 0xff4040 0x40ff40 0x4040ff 0xffff40 0xff40ff 0x40ffff 0xffffff 0x808080 ";

}  // namespace

TEST_CASE("draws equal pictures wherever a light is written (VRML97 4.6.6, 6.16, 6.35, 6.45)") {
  Studio studio;
  const std::string ball = shape(material("diffuseColor 0.9 0.7 0.5 specularColor 0.4 0.4 0.4"), "Sphere { }");
  const std::string box = shape(material("diffuseColor 0.2 0.7 0.9"));
  const auto alike = [&](const std::string& what, const std::string& a, const std::string& b) {
    check_alike(studio, what, kDark + a, kDark + b);
  };
  alike("before and behind", "DirectionalLight { direction -1 -1 -1 }" + ball,
        ball + "DirectionalLight { direction -1 -1 -1 }");
  alike("turned",
        "Group { children [ Transform { rotation 0 1 0 0.7 children [ DirectionalLight { direction 0 0 -1 } " + ball +
            " ] } ] }",
        "DirectionalLight { direction " + number(-std::sin(0.7)) + " 0 " + number(-std::cos(0.7)) +
            " } Transform { rotation 0 1 0 0.7 children " + ball + " }");
  alike("directional light of a group",
        "Group { children [ DirectionalLight { direction -1 -1 -1 } " + ball +
            " ] } Transform { translation 1.5 0 0 children " + box + " }",
        "Transform { translation 1.5 0 0 children " + box + " } Group { children [ Group { children " + ball +
            " } DirectionalLight { direction -1 -1 -1 } ] }");
  for (const std::string light :
       {"PointLight { %location 1 2 3 radius 20 attenuation 0 0.3 0.02 }",
        "SpotLight { %location 1 2 3 direction -0.3 -0.5 -0.8 cutOffAngle 0.6 beamWidth 0.2 radius 20 }"}) {
    const std::string kind = light.substr(0, light.find(' '));
    const auto with = [&](const std::string& more) {
      std::string text = light;
      return text.replace(text.find('%'), 1, more);
    };
    alike(kind + ": outside of its group", "Group { children " + with("") + " }" + ball, ball + with(""));
    alike(kind + ": moved",
          "Transform { translation 0.5 0 -1 children " + with("") + " } Transform { translation 0.5 0 -1 children " +
              ball + " }",
          "Transform { translation 0.5 0 -1 children [ " + ball + with("") + " ] }");
    alike(kind + ": colour and intensity", with("color 1 0.5 0.2 intensity 0.5 ") + ball,
          with("color 0.5 0.25 0.1 ") + ball);
    alike(kind + ": twice", with("intensity 0.3 ") + with("intensity 0.3 ") + ball, with("intensity 0.6 ") + ball);
  }
  // Attenuation and radius use the light's own coordinate system.
  alike("scaled PointLight",
        "Transform { scale 2 2 2 children PointLight { location 0.5 1 1.5 attenuation 0 0.6 0 radius 10 } }" + ball,
        "PointLight { location 1 2 3 attenuation 0 0.3 0 radius 20 }" + ball);
  alike("attenuation below 1", "PointLight { location 1 2 3 attenuation 0.1 0 0 }" + ball,
        "PointLight { location 1 2 3 attenuation 1 0 0 }" + ball);
  alike("radius", "PointLight { location 1 2 3 radius 1 }" + box + "DirectionalLight { direction -1 -1 -1 }",
        box + "DirectionalLight { direction -1 -1 -1 }");
  alike("a beam wider than the cut-off",
        "SpotLight { location 1 2 3 direction -0.3 -0.6 -0.8 cutOffAngle 0.4 beamWidth 1.5 }" + ball,
        "SpotLight { location 1 2 3 direction -0.3 -0.6 -0.8 cutOffAngle 0.4 beamWidth 0.4 }" + ball);
  CHECK(studio.old_worlds() >= 15);
}

TEST_CASE("draws the headlight like an equal DirectionalLight (VRML97 6.29)") {
  Studio studio;
  const std::string shapes = shape(material("diffuseColor 0.9 0.7 0.5 specularColor 0.5 0.5 0.5"), "Sphere { }");
  check_alike(studio, "along -Z", "Viewpoint { position 0 0 4 }" + shapes,
              "NavigationInfo { headlight FALSE } Viewpoint { position 0 0 4 } DirectionalLight { }" + shapes);
  check_alike(studio, "turned with the viewer", "Viewpoint { position 4 0 0 orientation 0 1 0 1.5707963 }" + shapes,
              "NavigationInfo { headlight FALSE } Viewpoint { position 4 0 0 orientation 0 1 0 1.5707963 } "
              "DirectionalLight { direction -1 0 0 }" +
                  shapes);
  CHECK(studio.old_worlds() >= 4);
}

TEST_CASE("takes colours from the sources of the lighting tables (VRML97 4.14, Tables 4.5 and 4.6)") {
  Studio studio;
  const auto alike = [&](const std::string& what, const std::string& a, const std::string& b) {
    check_alike(studio, what, kLit + a, kLit + b);
  };
  const std::string one = "PixelTexture { image 1 1 1 0x80 } ", two = "PixelTexture { image 1 1 2 0x8040 } ",
                    three = "PixelTexture { image 1 1 3 0x80ff40 } ", four = "PixelTexture { image 1 1 4 0x80ff4060 } ";
  const std::string wall = shape(material("diffuseColor 0 0 0 emissiveColor 0 0 0.6"), "Box { size 3 3 0.1 }");
  const auto before_wall = [&](const std::string& text) {
    return "Transform { translation 0 0 -2 children " + wall + " }" + text;
  };
  const std::string half = number(128.0 / 255), quarter = number(64.0 / 255), part = number(96.0 / 255);
  // A Shape without Material is unlit.
  const auto unlit = [&](const std::string& color, const std::string& more = "") {
    return shape(material("diffuseColor 0 0 0 ambientIntensity 0 emissiveColor " + color + more));
  };
  alike("no Appearance", "Shape { geometry Box { size 2 1 1.5 } }", unlit("1 1 1"));
  alike("no Material", shape(""), unlit("1 1 1"));
  alike("unlit, intensity", shape("texture " + one), unlit(half + half + half));
  alike("unlit, RGB", shape("texture " + three), unlit(half + "1 " + quarter));
  alike("unlit, intensity and alpha", before_wall(shape("texture " + two)),
        before_wall(unlit(half + half + half, " transparency " + number(1 - 64.0 / 255))));
  alike("unlit, RGB and alpha", before_wall(shape("texture " + four)),
        before_wall(unlit(half + "1 " + quarter, " transparency " + number(1 - 96.0 / 255))));
  const std::string color = "color Color { color [ 0.9 0.5 0.2, 0.9 0.5 0.2, 0.9 0.5 0.2, 0.9 0.5 0.2 ] } ";
  const std::string square =
      "IndexedFaceSet { coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0 ] } coordIndex [ 0 1 2 3 ] ";
  alike("unlit, Color node", "Shape { geometry " + square + color + "} }",
        shape(material("diffuseColor 0 0 0 emissiveColor 0.9 0.5 0.2"), square + "}"));
  // With Material: a Color node replaces diffuseColor. An intensity texture multiplies it, an RGB texture replaces it.
  const std::string rest = "specularColor 0.2 0.2 0.2 ambientIntensity 0.5 emissiveColor 0.1 0 0 ";
  alike("lit, Color node", shape(material(rest + "diffuseColor 0 1 0"), square + color + "}"),
        shape(material(rest + "diffuseColor 0.9 0.5 0.2"), square + "}"));
  alike("lit, intensity", shape(material(rest + "diffuseColor 0.8 0.6 0.4") + "texture " + one),
        shape(material(rest + "diffuseColor " + number(0.8 * 128 / 255) + number(0.6 * 128 / 255) +
                       number(0.4 * 128 / 255))));
  alike("lit, intensity and Color node", shape(material(rest) + "texture " + one, square + color + "}"),
        shape(material(rest + "diffuseColor " + number(0.9 * 128 / 255) + number(0.5 * 128 / 255) +
                       number(0.2 * 128 / 255)),
              square + "}"));
  alike("lit, RGB", shape(material(rest + "diffuseColor 0 0 1") + "texture " + three),
        shape(material(rest + "diffuseColor " + half + "1 " + quarter)));
  alike("lit, RGB and Color node", shape(material(rest) + "texture " + three, square + color + "}"),
        shape(material(rest + "diffuseColor " + half + "1 " + quarter), square + "}"));
  alike("lit, intensity and alpha",
        before_wall(shape(material("diffuseColor 1 1 1 transparency 0.9") + "texture " + two)),
        before_wall(shape(material("diffuseColor " + half + half + half + " transparency " + number(1 - 64.0 / 255)))));
  alike("lit, RGB and alpha", before_wall(shape(material("diffuseColor 0 1 0 transparency 1") + "texture " + four)),
        before_wall(
            shape(material("diffuseColor " + half + "1 " + quarter + " transparency " + number(1 - 96.0 / 255)))));
  alike("lit, RGB and transparency", before_wall(shape(material("transparency 0.5") + "texture " + three)),
        before_wall(shape(material("diffuseColor " + half + "1 " + quarter + " transparency 0.5"))));
  alike("an empty PixelTexture", shape(material(rest + "diffuseColor 0.8 0.6 0.4") + "texture PixelTexture { }"),
        shape(material(rest + "diffuseColor 0.8 0.6 0.4")));
  CHECK(studio.old_worlds() >= 32);
}

TEST_CASE("draws equal pictures by texture coordinates and by TextureTransform (VRML97 6.22, 6.33, 6.48, 6.49)") {
  Studio studio;
  const std::string view = "Viewpoint { position 0 0 3 }\n";
  const auto textured = [&](const std::string& texture, const std::string& coordinates) {
    return view +
           shape("texture PixelTexture { " + kColors + texture + " } ",
                 "IndexedFaceSet { coord Coordinate { point [ -1 -1 0, 1 -1 0, 1 1 0, -1 1 0 ] } coordIndex [ 0 1 2 "
                 "3 ] texCoord TextureCoordinate { point [ " +
                     coordinates + " ] } }");
  };
  const auto transformed = [&](const std::string& transform) {
    return view +
           shape("texture PixelTexture { " + kColors + " } textureTransform TextureTransform { " + transform + " } ",
                 kSquare);
  };
  /// Tc' = -C * S * R * C * T * Tc, as 6.49 prints it.
  const auto by_formula = [](glm::dvec2 center, double rotation, glm::dvec2 scale, glm::dvec2 translation) {
    std::string text;
    for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
      const glm::dvec2 p = corner + translation + center;
      const glm::dvec2 turned(p.x * std::cos(rotation) - p.y * std::sin(rotation),
                              p.x * std::sin(rotation) + p.y * std::cos(rotation));
      const glm::dvec2 result = turned * scale - center;
      text += number(result.x) + number(result.y);
    }
    return text;
  };
  const auto alike = [&](const std::string& what, const std::string& a, const std::string& b) {
    check_alike(studio, what, a, b, 40);  // texels end at pixel edges
  };
  alike("translation", transformed("translation 0.3 0.2"), textured("", by_formula({0, 0}, 0, {1, 1}, {0.3, 0.2})));
  alike("scale", transformed("scale 2 3"), textured("", by_formula({0, 0}, 0, {2, 3}, {0, 0})));
  alike("rotation", transformed("rotation 0.5"), textured("", by_formula({0, 0}, 0.5, {1, 1}, {0, 0})));
  alike("rotation about a center", transformed("rotation 0.5 center 0.5 0.5"),
        textured("", by_formula({0.5, 0.5}, 0.5, {1, 1}, {0, 0})));
  alike("all of it", transformed("rotation 0.7 center 0.4 0.1 scale 1.5 0.7 translation 0.2 0.6"),
        textured("", by_formula({0.4, 0.1}, 0.7, {1.5, 0.7}, {0.2, 0.6})));
  alike("repeated", textured("", "0 0, 2 0, 2 2, 0 2"), textured("", "-3 5, -1 5, -1 7, -3 7"));
  // Clamped coordinates show the colours of the edge. From s = 1 on this is the right column, from t = 1 on the top
  // row.
  alike("clamped", textured("repeatS FALSE repeatT FALSE", "2 2, 3 2, 3 3, 2 3"),
        view + shape("texture PixelTexture { image 1 1 3 0x808080 }", kSquare));
  alike(
      "clamped in s alone", textured("repeatS FALSE", "2 0, 3 0, 3 1, 2 1"),
      view + shape("texture PixelTexture { image 4 2 3 0xffff40 0xffff40 0xffff40 0xffff40 0x808080 0x808080 0x808080 "
                   "0x808080 }",
                   kSquare));
  alike(
      "clamped in t alone", textured("repeatT FALSE", "0 -2, 1 -2, 1 -1, 0 -1"),
      view + shape("texture PixelTexture { image 4 2 3 0xff4040 0x40ff40 0x4040ff 0xffff40 0xff4040 0x40ff40 0x4040ff "
                   "0xffff40 }",
                   kSquare));

  // An image file has the same pixels.
  render::Image image{4, 2, 3, {}};
  for (const unsigned word : {0xff40ffu, 0x40ffffu, 0xffffffu, 0x808080u, 0xff4040u, 0x40ff40u, 0x4040ffu, 0xffff40u})
    for (const int shift : {16, 8, 0}) image.pixels.push_back(static_cast<std::uint8_t>(word >> shift));
  const std::vector<std::byte> png = render::encode_png(image);
  const Files from_file{{"main.wrl", view + shape("texture ImageTexture { url \"a.png\" }", kSquare)},
                        {"a.png", std::string(reinterpret_cast<const char*>(png.data()), png.size())}};
  check_alike(studio, "ImageTexture and PixelTexture", from_file,
              Files{{"main.wrl", textured("", "0 0, 1 0, 1 1, 0 1")}}, 0);
  for (const char* geometry : {"Box { }", "Cone { }", "Cylinder { }", "Sphere { }"})
    check_alike(
        studio, std::string("turned by a whole turn on a ") + geometry,
        view + shape("texture PixelTexture { " + kColors + " }", geometry),
        view + shape("texture PixelTexture { " + kColors + " } textureTransform TextureTransform { translation 2 -3 }",
                     geometry),
        40);
  CHECK(studio.old_worlds() >= 28);
}

TEST_CASE("draws equal pictures for any order of transparent shapes and faces (VRML97 4.14)") {
  Studio studio;
  const std::string view = "NavigationInfo { headlight FALSE } Viewpoint { position 0 0 4 }\n";
  const auto square = [](double z, double x) {
    std::string text;
    for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      text += number(u + x) + number(v) + number(z) + ", ";
    return text;
  };
  const auto glass = [&](const std::string& color, const std::string& points, const std::string& index = "0 1 2 3") {
    return shape(
        material("diffuseColor 0 0 0 transparency 0.5 emissiveColor " + color),
        "IndexedFaceSet { solid FALSE coord Coordinate { point [ " + points + " ] } coordIndex [ " + index + " ] }");
  };
  const std::string red = glass("1 0 0", square(0.5, -0.3)), green = glass("0 1 0", square(0, 0)),
                    blue = glass("0 0 1", square(-0.5, 0.3));
  for (const std::string& other :
       {red + blue + green, green + red + blue, green + blue + red, blue + red + green, blue + green + red})
    check_alike(studio, "shapes", view + red + green + blue, view + other, 0);
  // Three faces of one mesh, with a colour each.
  const auto faces = [&](const std::string& index, const std::string& colors) {
    return view +
           "Shape { appearance Appearance { material Material { transparency 0.5 } } geometry IndexedFaceSet { solid "
           "FALSE coord "
           "Coordinate { point [ " +
           square(0.5, -0.3) + square(0, 0) + square(-0.5, 0.3) + " ] } coordIndex [ " + index +
           " ] colorPerVertex FALSE color Color { color [ " + colors + " ] } } } DirectionalLight { }";
  };
  const std::string in_order = faces("8 9 10 11 -1 4 5 6 7 -1 0 1 2 3 -1", "0 0 1, 0 1 0, 1 0 0");
  check_alike(studio, "faces, front first", faces("0 1 2 3 -1 4 5 6 7 -1 8 9 10 11 -1", "1 0 0, 0 1 0, 0 0 1"),
              in_order, 0);
  check_alike(studio, "faces, middle first", faces("4 5 6 7 -1 0 1 2 3 -1 8 9 10 11 -1", "0 1 0, 1 0 0, 0 0 1"),
              in_order, 0);
  // The faces are in one mesh, and in three meshes.
  const std::string three = view + "DirectionalLight { }" + [&] {
    std::string text;
    for (const auto& [z, x, color] : {std::tuple{0.5, -0.3, "1 0 0"}, {0.0, 0.0, "0 1 0"}, {-0.5, 0.3, "0 0 1"}})
      text += shape(
          material(std::string("transparency 0.5 diffuseColor ") + color),
          "IndexedFaceSet { solid FALSE coord Coordinate { point [ " + square(z, x) + " ] } coordIndex [ 0 1 2 3 ] }");
    return text;
  }();
  check_alike(studio, "one mesh and three", in_order, three, 0);
  // The nearest light comes last: it contributes half, the next a quarter, the third an eighth (4.14.4).
  for (const std::string& world : {view + blue + red + green, in_order}) {
    const render::Image image = studio.picture(world);
    const std::uint8_t* middle = image.pixels.data() + (std::size_t{32} * image.width + 32) * image.components;
    CHECK(middle[0] == Approx(127.5).margin(1.5));
    CHECK(middle[1] == Approx(63.75).margin(1.5));
    CHECK(middle[2] == Approx(31.875).margin(1.5));
  }
  // A texture's alpha is sorted like a Material's.
  const auto pane = [&](double z, double x, const std::string& word) {
    return shape(
        "texture PixelTexture { image 1 1 4 " + word + " }",
        "IndexedFaceSet { solid FALSE coord Coordinate { point [ " + square(z, x) + " ] } coordIndex [ 0 1 2 3 ] }");
  };
  const std::string a = pane(0.5, -0.3, "0xff000080"), b = pane(-0.5, 0.3, "0x0000ff80");
  check_alike(studio, "textures", view + a + b, view + b + a, 0);
  // One pane is in front of the other. Of the farther pane, 127 / 255 of one half remain.
  const render::Image panes = studio.picture(view + a + b);
  const std::uint8_t* middle = panes.pixels.data() + (std::size_t{32} * panes.width + 32) * panes.components;
  CHECK(middle[0] == Approx(128).margin(1.5));
  CHECK(middle[2] == Approx(128 * 127 / 255.0).margin(1.5));
  CHECK(studio.old_worlds() >= 18);
}

}  // namespace gs::app::pairs_look_test
