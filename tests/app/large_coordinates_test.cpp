#include "app/view/navigation.h"
#include "app/view/picking.h"
#include "tests/app/pairs.h"
#include "tests/render/drawing.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>

// Tests of objects of centimetres, a thousand to ten thousand kilometres from the origin: maps, surveys, planets.
namespace gs::app::large_coordinates_test {
namespace {

using pairs::number;
using pairs::Studio;

std::string vector(const glm::dvec3& v) { return number(v.x) + number(v.y) + number(v.z); }

/// At these coordinates float32 has steps of 1, 0.5 and 0.25 metres, and represents them exactly.
const glm::dvec3 kFar(10'000'000, -5'000'000, 3'000'000);

/// Returns boards of a few millimetres and a lamp, seen from 30 cm. `to_place` is the distant translation; all other
/// coordinates are near 0.
std::string boards(const glm::dvec3& to_place, const glm::dvec3& viewer, const std::string& boards_text) {
  return "Transform { translation " + vector(to_place) +
         " children [ NavigationInfo { headlight FALSE }\n"
         "Viewpoint { position " +
         vector(viewer) +
         " orientation 0 1 0 0.1 }\n"
         "PointLight { location 0.1 0.2 0.3 attenuation 0 2 0 }\n" +
         boards_text + "] }\n";
}
std::string boards_of(double step) {
  std::string text;
  for (int i = 0; i < 5; ++i)
    text += "Transform { translation " + vector({-0.1 + 0.04 * i, -0.06 + 0.03 * i, -step * i}) +
            "rotation 0 1 0 0.3 children Shape { appearance Appearance { material Material { diffuseColor " +
            vector({0.2 + 0.2 * i, 1 - 0.2 * i, 0.5}) + "} } geometry Box { size 0.06 0.06 0.004 } } }\n";
  return text;
}

std::size_t lit_pixels(const render::Image& image) {
  std::size_t count = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x)
      count += render::testing::pixel(image, x, y) != glm::vec3(0) ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("draws a world of centimetres ten thousand kilometres away as at the origin") {
  Studio studio;
  for (int i = 0; i < 4; ++i) {
    // The viewer moves by a third of a millimetre.
    const glm::dvec3 viewer(0.0003 * i, 0.0002 * i, 0.3 - 0.0003 * i);
    const render::Image here = studio.picture(boards({0, 0, 0}, viewer, boards_of(0.01))),
                        there = studio.picture(boards(kFar, viewer, boards_of(0.01)));
    const auto difference = pairs::compare_pictures(here, there);
    INFO("step " << i << ": " << difference.pixels << " pixels differ, by " << difference.most << " at the most");
    CHECK(difference.pixels == 0);
    CHECK(lit_pixels(here) > 100);
  }
}

TEST_CASE("keeps a mesh of large coordinates steady while the viewer moves") {
  // Returns squares of an eighth of a metre in coordinates around the origin or around (2^20, 2^19, 2^20), where
  // float32 has steps of an eighth and a sixteenth, moved to one position.
  const auto squares = [](const glm::dvec3& at, const glm::dvec3& viewer) {
    std::string points, indices;
    for (int i = 0; i < 6; ++i) {
      const double x = 0.125 * 2 * (i % 3), y = 0.125 * 2 * (i / 3);
      for (const glm::dvec2& corner :
           {glm::dvec2(0, 0), glm::dvec2(0.125, 0), glm::dvec2(0.125, 0.125), glm::dvec2(0, 0.125)})
        points += vector(at + glm::dvec3(x + corner.x, y + corner.y, 0.125 * (i % 2)));
      for (int k = 0; k < 4; ++k) indices += std::to_string(4 * i + k) + " ";
      indices += "-1 ";
    }
    return "Viewpoint { position " + vector(viewer) + " orientation 0.3 1 0.1 0.05 }\nTransform { translation " +
           vector(-at) +
           " children Shape { appearance Appearance { material Material { } } geometry IndexedFaceSet { "
           "coord Coordinate { point [ " +
           points + "] } coordIndex [ " + indices + "] } } }\n";
  };
  Studio studio;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 viewer(0.3 + 0.001 * i, 0.2, 0.9);
    const render::Image here = studio.picture(squares({0, 0, 0}, viewer)),
                        there = studio.picture(squares({1 << 20, 1 << 19, 1 << 20}, viewer));
    const auto difference = pairs::compare_pictures(here, there);
    INFO("step " << i << ": " << difference.pixels << " pixels differ, by " << difference.most << " at the most");
    CHECK(difference.pixels == 0);
    CHECK(lit_pixels(here) > 100);
  }
}

TEST_CASE("separates two faces a centimetre apart in a world as large as a planet") {
  Studio studio;
  // The sphere is behind the viewer, but the world's box extends from the viewer to behind the faces.
  const auto seen = [&](double distance, const std::string& order) {
    const auto face = [&](double z, const std::string& color) {
      const std::string half = number(distance * 0.6);
      return "Transform { translation 0 0 " + number(z) +
             " children Shape { appearance Appearance { material Material { "
             "diffuseColor 0 0 0 emissiveColor " +
             color + " } } geometry IndexedFaceSet { coord Coordinate { point [ -" + half + "-" + half + "0, " + half +
             "-" + half + "0, " + half + half + "0, -" + half + half + "0 ] } coordIndex [ 0 1 2 3 ] } } }\n";
    };
    const std::string front = face(-distance, "0 1 0"), back = face(-distance - distance * 1e-4, "1 0 0");
    return studio.picture(
        "Viewpoint { position 0 0 0 }\nTransform { translation 0 0 6371000.5 children Shape { geometry "
        "Sphere { radius 6371000 } } }\n" +
        (order == "front first" ? front + back : back + front));
  };
  for (const double distance : {0.05, 1.0, 100.0, 100'000.0})
    for (const std::string order : {"front first", "back first"}) {
      const render::Image picture = seen(distance, order);
      INFO(distance << " m, " << order);
      std::size_t others = 0;
      for (std::uint32_t y = 0; y < picture.height; ++y)
        for (std::uint32_t x = 0; x < picture.width; ++x)
          others += render::testing::pixel(picture, x, y) == glm::vec3(0, 255, 0) ? 0 : 1;
      CHECK(others == 0);
    }
}

TEST_CASE("moves by millimetres and points exactly far from the origin") {
  Pose pose;
  pose.position = kFar;
  pose.field_of_view = 1;
  Navigation state =
      start_navigation({NavigationMode::fly, {true, true, true, true, true}, true, 0.001f, {}}, {}, pose);
  NavigationInput keys;
  keys.move = {0, 0, 1};
  for (int i = 0; i < 100; ++i) state = step(state, keys, 0.1f);
  const glm::dvec3 way = state.pose.position - kFar;
  CHECK(way.x == Approx(0).margin(1e-6));
  CHECK(way.z == Approx(-0.01).margin(0.0005));  // 10 s of a millimetre a second

  render::RenderList list;
  render::DrawItem item = render::testing::unlit(render::testing::square(0.01f));
  item.world_from_node[3] = glm::dvec4(kFar + glm::dvec3(0.05, 0, -0.3), 1);
  render::testing::add(list, item);
  pose.position = kFar;
  const glm::vec2 size(800, 600);
  const float at = 300 * 0.05f / 0.3f / std::tan(0.5f);  // pixels from the centre
  const auto hit = Picker().pick(list, ray_through(pose, {400 + at, 300}, size), {});
  REQUIRE(hit);
  CHECK(glm::distance(hit->point - kFar, glm::dvec3(0.05, 0, -0.3)) < 1e-5);
  CHECK_FALSE(Picker().pick(list, ray_through(pose, {400 + at * 1.3f, 300}, size), {}));
}

}  // namespace gs::app::large_coordinates_test
