#include "render/scene/fog.h"

#include "tests/render/drawing.h"
#include "tests/render/volume_scenes.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace gs::render::fog_test {
using namespace gs::render::testing;
namespace {

/// Returns f0 of VRML97 Table 4.8.
double table_4_8(bool exponential, double distance, double visibility) {
  if (visibility <= 0) return 1;
  if (distance >= visibility) return 0;
  return exponential ? std::exp(-distance / (visibility - distance)) : (visibility - distance) / visibility;
}

/// Returns the point of the plane z = 0 at the centre of a pixel, seen from z = 10 at the default field of view.
glm::dvec3 point_at(std::uint32_t x, std::uint32_t y, double size) {
  constexpr double kTangent = 0.41421356;
  return {((x + 0.5) / size * 2 - 1) * kTangent * 10, (1 - (y + 0.5) / size * 2) * kTangent * 10, 0};
}

RenderList parsed(const std::string& body) {
  vrml::SceneGraph scene("fog.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\n" + body, scene, diagnostics);
  REQUIRE(diagnostics.errors() == 0);
  MeshCache meshes;
  RenderList list = collect(scene, {}, meshes);
  list.viewpoints.clear();  // lines of sight into the scene
  return list;
}

Fog fog_of(bool exponential, float visibility, const glm::vec3& color = {0.2f, 0.9f, 0.4f}) {
  return {.color = color, .exponential = exponential, .visibility_range = visibility};
}

}  // namespace

TEST_CASE("interpolates fog as in VRML97 Table 4.8") {
  for (const bool exponential : {false, true})
    for (const float visibility : {0.5f, 10.0f, 3000.0f}) {
      const CameraFog fog = camera_fog(fog_of(exponential, visibility), glm::mat3(1));
      REQUIRE(fog.on);
      for (const float part : {0.0f, 0.1f, 0.5f, 0.9f, 0.999f, 1.0f, 1.001f, 50.0f}) {
        const glm::vec3 place = glm::normalize(glm::vec3(2, -3, -6)) * (part * visibility);
        CHECK(fog_interpolant(fog, place) ==
              Approx(table_4_8(exponential, glm::length(glm::dvec3(place)), visibility)).margin(1e-5));
      }
    }
  CHECK_FALSE(camera_fog(fog_of(false, 0), glm::mat3(1)).on);
  CHECK_FALSE(camera_fog(Fog{}, glm::mat3(1)).on);
  for (const float odd : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    CHECK_FALSE(camera_fog(fog_of(true, odd), glm::mat3(1)).on);
  CHECK(fogged(CameraFog{}, glm::vec3(0.3f), {0, 0, -7}) == glm::vec3(0.3f));
}

TEST_CASE("measures visibilityRange in the Fog's coordinate system (VRML97 6.19)") {
  const auto interpolant = [](const std::string& world, const glm::vec3& place) {
    return fog_interpolant(camera_fog(parsed(world).fog, glm::mat3(1)), place);
  };
  const std::string fog = "Fog { visibilityRange 10 color 1 0 0 }";
  CHECK(parsed(fog).fog.color == glm::vec3(1, 0, 0));
  CHECK_FALSE(parsed(fog).fog.exponential);
  CHECK(parsed("Fog { fogType \"EXPONENTIAL\" }").fog.exponential);
  CHECK_FALSE(parsed("Fog { fogType \"exponential\" }").fog.exponential);
  CHECK(interpolant(fog, {0, 3, -4}) == Approx(0.5));
  CHECK(interpolant("Transform { scale 2 2 2 children " + fog + " }", {0, 3, -4}) == Approx(0.75));
  // Rotation and translation of the Fog have no effect.
  CHECK(interpolant("Transform { translation 50 6 7 rotation 1 2 3 0.7 children " + fog + " }", {0, 3, -4}) ==
        Approx(0.5));
  // The Fog's coordinate system is stretched along y.
  const std::string stretched = "Transform { scale 1 4 1 children " + fog + " }";
  CHECK(interpolant(stretched, {0, 0, -5}) == Approx(0.5));
  CHECK(interpolant(stretched, {0, 5, 0}) == Approx(0.875));
  // The first Fog is bound (4.6.10). A Fog with a singular coordinate system is ignored.
  CHECK(interpolant("Fog { visibilityRange 20 } " + fog, {0, 0, -5}) == Approx(0.75));
  CHECK(interpolant("Shape { }", {0, 0, -500}) == 1);
}

TEST_CASE("fades surfaces, lines and points into the fog, but not the background (VRML97 4.14.4, 6.19)") {
  Drawing drawing;
  const glm::vec3 base(0.9f, 0.3f, 0.6f);
  for (const bool exponential : {false, true}) {
    RenderList list;
    list.fog = fog_of(exponential, 25);
    list.background.sky_colors = {{0.1f, 0.2f, 0.3f}};
    auto lines = std::make_shared<vrml::Mesh>();
    lines->primitive = vrml::Mesh::Primitive::lines;
    lines->lit = false;
    lines->solid = false;
    lines->positions = {{-4, 2, 0}, {4, 2, 0}};
    lines->indices = {0, 1};
    auto points = std::make_shared<vrml::Mesh>(*lines);
    points->primitive = vrml::Mesh::Primitive::points;
    points->positions = {{3, -3, 0}};
    points->indices = {0};
    for (const auto& mesh : {lines, points})
      for (const glm::vec3& p : mesh->positions) mesh->bounds.add(p);
    add(list, glowing(square(), base));
    DrawItem white = unlit(square(), translation({-2.5f, 0, 0}));
    add(list, white);
    DrawItem textured = unlit(square(), translation({2.5f, 0, 0}));
    textured.texture.image = std::make_shared<const Image>(Image{1, 1, 3, {51, 102, 204}});
    add(list, textured);
    add(list, glowing(lines, base));
    add(list, glowing(points, base));
    const Image image = drawing.draw(list);
    const auto expected = [&](const glm::vec3& color, const glm::dvec3& place) {
      const auto f = static_cast<float>(table_4_8(exponential, glm::length(place - glm::dvec3(0, 0, 10)), 25));
      return list.fog.color * (1 - f) + f * color;
    };
    std::size_t checked = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 0; x < 64; ++x) {
        const glm::dvec3 p = point_at(x, y, 64);
        if (std::abs(p.y) > 0.9) continue;
        INFO("pixel " << x << " " << y);
        for (const auto& [center, color] :
             {std::pair{0.0, base}, {-2.5, glm::vec3(1)}, {2.5, glm::vec3(0.2f, 0.4f, 0.8f)}})
          if (std::abs(p.x - center) < 0.9) check_color(pixel(image, x, y), expected(color, p), 1.6f), ++checked;
      }
    CHECK(checked > 400);
    check_color(pixel(image, 2, 60), {0.1f, 0.2f, 0.3f});  // the background
    // Finds line and point among the pixels.
    std::size_t line_pixels = 0, point_pixels = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 0; x < 64; ++x) {
        const glm::dvec3 p = point_at(x, y, 64);
        const bool line = std::abs(p.y - 2) < 0.3, point = glm::length(p - glm::dvec3(3, -3, 0)) < 0.4;
        const glm::vec3 drawn = pixel(image, x, y);
        if ((!line && !point) || glm::length(drawn - glm::vec3(0.1f, 0.2f, 0.3f) * 255.0f) < 3) continue;
        check_color(drawn, expected(base, p), 3);
        ++(line ? line_pixels : point_pixels);
      }
    CHECK(line_pixels > 50);
    CHECK(point_pixels > 0);
  }
}

TEST_CASE("gives everything beyond the visibilityRange the colour of the fog") {
  Drawing drawing;
  RenderList list;
  list.fog = fog_of(false, 9.5f);
  add(list, glowing(square(), {1, 1, 1}));
  check_color(pixel(drawing.draw(list), 32, 32), list.fog.color);
  list.fog.visibility_range = 0;
  check_color(pixel(drawing.draw(list), 32, 32), {1, 1, 1});
}

TEST_CASE("keeps fog relative to the viewer in every direction") {
  Drawing drawing;
  RenderList list;
  list.fog = fog_of(false, 20);
  list.fog.fog_from_world = glm::mat3(scale({0.5f, 1, 1}));
  add(list, glowing(square(), {1, 1, 1}));
  Camera camera = camera_at({8, 0, 0});
  camera.world_from_camera[0] = {0, 0, -1, 0};
  camera.world_from_camera[2] = {1, 0, 0, 0};
  DrawItem turned = glowing(square(), {1, 1, 1});
  turned.world_from_node =
      glm::mat4(glm::vec4(0, 0, -1, 0), glm::vec4(0, 1, 0, 0), glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 0, 1));
  add(list, turned);
  // 8 m along x are 4 units of the Fog, so the fog has a fifth of its effect.
  check_color(pixel(drawing.draw(list, camera), 32, 32), glm::mix(list.fog.color, glm::vec3(1), 0.8f), 2.1f);
}

TEST_CASE("fades transparent surfaces and keeps them transparent") {
  Drawing drawing;
  RenderList list;
  list.background.sky_colors = {{0, 0, 1}};
  list.fog = fog_of(false, 20, {1, 0, 0});
  DrawItem item = glowing(square(), {0, 1, 0});
  item.material.transparency = 0.5f;
  add(list, item);
  // f0 and alpha are both 0.5.
  check_color(pixel(drawing.draw(list), 32, 32), {0.25f, 0.25f, 0.5f}, 2.1f);
}

TEST_CASE("fades splats and volumes like surfaces, on both paths") {
  for (const bool volume : {false, true})
    for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
      INFO((volume ? "volume " : "surface ") << (path == SplatPath::cpu ? "cpu" : "gl"));
      Drawing drawing;
      drawing.options.splats = path;
      // A wall of splats in the plane z = 0.
      qnv::Geometry geometry;
      if (volume) geometry = qnv::Volume();
      qnv::VectorArrays& wall = *geometry.arrays();
      for (int y = -20; y <= 20; ++y)
        for (int x = -20; x <= 20; ++x) {
          wall.positions.push_back({x * 0.1f, y * 0.1f, 0});
          wall.normals.push_back({0, 0, 1});
          wall.weights.push_back(0.02f);
          wall.description.box.add(wall.positions.back());
        }
      RenderList list;
      SplatItem item;
      item.geometry = std::make_shared<const qnv::Geometry>(std::move(geometry));
      item.material.diffuse = {0.2f, 0.4f, 0.8f};
      list.splats.push_back(item);
      list.bounds.add(glm::vec3(-2, -2, -0.1f));
      list.bounds.add(glm::vec3(2, 2, 0.1f));
      const glm::vec3 clear = pixel(drawing.draw(list), 32, 32);
      CHECK(glm::length(clear) > 50);
      list.fog = fog_of(false, 20, {1, 0, 0});
      const glm::vec3 half = pixel(drawing.draw(list), 32, 32);
      list.fog.visibility_range = 9;
      const glm::vec3 hidden = pixel(drawing.draw(list), 32, 32);
      // The background behind a volume gets no fog. The third picture gives the part that the volume covers.
      const float covered = hidden.x / 255;
      CHECK(covered > 0.3f);
      CHECK(hidden.y < 2);
      const glm::vec3 expected = glm::vec3(255, 0, 0) * (covered * 0.5f) + clear * 0.5f;
      CHECK(glm::length(half - expected) < 6);
    }
}

}  // namespace gs::render::fog_test
