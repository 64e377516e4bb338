#include "render/gl/light_tree.h"
#include "tests/render/drawing.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

/// Evaluates VRML97 4.14.4 independently, in world space and in double.
glm::dvec3 equation(const Material& m, const glm::dvec3& diffuse_color, const std::vector<Light>& lights,
                    const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& viewer) {
  glm::dvec3 sum(m.emissive);
  const glm::dvec3 v = glm::normalize(viewer - point);
  for (const Light& light : lights) {
    glm::dvec3 l = -glm::normalize(glm::dvec3(light.direction));
    double attenuation = 1, spot = 1;
    if (light.kind != Light::Kind::directional) {
      const glm::dvec3 to_light = glm::dvec3(light.location) - point;
      const double d = glm::length(to_light);
      if (d > light.radius) continue;
      l = to_light / d;
      attenuation = 1 / std::max(light.attenuation.x + light.attenuation.y * d + light.attenuation.z * d * d, 1.0);
    }
    if (light.kind == Light::Kind::spot) {
      const double angle = std::acos(glm::dot(-l, glm::normalize(glm::dvec3(light.direction))));
      if (angle >= light.cut_off_angle)
        spot = 0;
      else if (angle <= light.beam_width)
        spot = 1;
      else
        spot = (angle - light.cut_off_angle) / (double{light.beam_width} - light.cut_off_angle);
    }
    const glm::dvec3 h = glm::normalize(l + v);
    const glm::dvec3 ambient = double{light.ambient_intensity} * diffuse_color * double{m.ambient_intensity};
    const glm::dvec3 diffuse = double{light.intensity} * diffuse_color * std::max(glm::dot(normal, l), 0.0);
    const glm::dvec3 specular = double{light.intensity} * glm::dvec3(m.specular) *
                                std::pow(std::max(glm::dot(normal, h), 0.0), m.shininess * 128.0);
    sum += attenuation * spot * glm::dvec3(light.color) * (ambient + diffuse + specular);
  }
  return sum;
}

constexpr double kTangent = 0.41421356;  // of half the default field of view

/// Returns the point of the plane z = 0 at the centre of a pixel, seen from z = 10.
glm::dvec3 point_at(std::uint32_t x, std::uint32_t y, double size) {
  return {((x + 0.5) / size * 2 - 1) * kTangent * 10, (1 - (y + 0.5) / size * 2) * kTangent * 10, 0};
}

Material shiny() {
  Material m;
  m.diffuse = {0.6f, 0.4f, 0.2f};
  m.emissive = {0.05f, 0.0f, 0.1f};
  m.specular = {0.3f, 0.5f, 0.4f};
  m.ambient_intensity = 0.5f;
  m.shininess = 0.15f;
  return m;
}

/// Draws a large lit square with the lights and compares many pixels with the equation.
void check_against_equation(const Material& material, std::vector<Light> lights, bool headlight) {
  Drawing drawing;
  drawing.options.headlight = headlight;
  RenderList list;
  DrawItem item;
  item.mesh = square(20);
  item.material = material;
  list.lights = lights;
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (lights[i].kind == Light::Kind::directional) item.directional_lights.push_back(static_cast<std::uint16_t>(i));
  add(list, item);
  const Image image = drawing.draw(list);
  if (headlight) lights.push_back({});  // the defaults of Light: white, along the camera's -Z
  for (std::uint32_t y = 1; y < 64; y += 9)
    for (std::uint32_t x = 2; x < 64; x += 7)
      check_color(pixel(image, x, y),
                  glm::vec3(equation(material, material.diffuse, lights, point_at(x, y, 64), {0, 0, 1}, {0, 0, 10})));
}

Light directional_light() {
  return {.kind = Light::Kind::directional,
          .color = {1, 0.8f, 0.5f},
          .direction = glm::normalize(glm::vec3(1, -2, -3)),
          .intensity = 0.7f,
          .ambient_intensity = 0.6f};
}

Light point_light() {
  return {.kind = Light::Kind::point,
          .location = {1, -1, 2},
          .attenuation = {0.5f, 0.2f, 0.1f},
          .intensity = 1,
          .ambient_intensity = 0.3f};
}

Light spot_light() {
  Light light;
  light.kind = Light::Kind::spot;
  light.location = {-1, 0.5f, 4};
  light.direction = glm::normalize(glm::vec3(0.2f, 0, -1));
  light.beam_width = 0.2f;
  light.cut_off_angle = 0.6f;
  light.color = {0.9f, 1, 0.7f};
  return light;
}

}  // namespace

TEST_CASE("lights pixels by the lighting equation (VRML97 4.14.4)", "[optimised]") {
  SECTION("headlight alone") { check_against_equation(shiny(), {}, true); }
  SECTION("no light: emissive colour") { check_against_equation(shiny(), {}, false); }
  SECTION("directional") { check_against_equation(shiny(), {directional_light()}, false); }
  SECTION("point, attenuated") { check_against_equation(shiny(), {point_light()}, false); }
  SECTION("spot, ramp from beamWidth to cutOffAngle") { check_against_equation(shiny(), {spot_light()}, false); }
  SECTION("spot with beamWidth above cutOffAngle has a hard edge") {
    Light light = spot_light();
    light.beam_width = 1.570796f;
    light.cut_off_angle = 0.4f;
    check_against_equation(shiny(), {light}, false);
  }
  SECTION("radius ends a light") {
    Light light = point_light();
    light.radius = 3.7f;
    check_against_equation(shiny(), {light}, false);
  }
  SECTION("all together") { check_against_equation(shiny(), {directional_light(), point_light(), spot_light()}, true); }
  SECTION("shininess 0") {
    Material m = shiny();
    m.shininess = 0;
    m.specular = glm::vec3(0.25f);
    check_against_equation(m, {point_light()}, false);
  }
}

TEST_CASE("applies a directional light only to the items that name it (VRML97 6.16)") {
  Drawing drawing;
  drawing.options.headlight = false;
  RenderList list;
  list.lights.push_back({});  // white, straight along -Z
  DrawItem item;
  item.mesh = square(1);
  item.material.diffuse = glm::vec3(0.5f);
  item.world_from_node = translation({-2, 0, 0});
  item.directional_lights = {0};
  add(list, item);
  item.world_from_node = translation({2, 0, 0});
  item.directional_lights = {};
  add(list, item);
  const Image image = drawing.draw(list);
  check_color(pixel(image, 16, 32), glm::vec3(0.5f));
  check_color(pixel(image, 48, 32), glm::vec3(0));
}

TEST_CASE("applies a thousand lights to an item, and of more the strongest", "[optimised]") {
  Drawing drawing;
  drawing.options.headlight = false;
  RenderList list;
  for (int i = 0; i < 100; ++i) {
    Light light;
    light.kind = Light::Kind::point;
    light.location = {0, 0, 5};
    light.radius = i == 33 ? 100.0f : 4.0f;  // the others do not reach the square
    list.lights.push_back(light);
  }
  DrawItem item;
  item.mesh = square(1);
  item.material.diffuse = glm::vec3(0.5f);
  add(list, item);
  check_color(pixel(drawing.draw(list), 32, 32), glm::vec3(0.5f), 1.5f);
  for (Light& light : list.lights) {
    light.radius = 100;
    light.intensity = 0.005f;
  }
  list.lights[99].intensity = 0.6f;
  // The lights are 0.6 and 99 times 0.005. Diffuse 0.5 multiplies each.
  check_color(pixel(drawing.draw(list), 32, 32), glm::vec3(0.5475f), 1.5f);
  list.lights.insert(list.lights.begin(), kMaxLightsOfAnItem, list.lights[0]);
  for (Light& light : list.lights) light.intensity = 1e-4f;
  list.lights.back().intensity = 0.6f;
  check_color(pixel(drawing.draw(list), 32, 32), glm::vec3(0.3f + 0.5e-4f * (kMaxLightsOfAnItem - 1)), 1.5f);
}

TEST_CASE("lights a floor and objects on it by hundreds of lamps (VRML97 4.6.6)", "[optimised]") {
  constexpr int kRows = 17, kLamps = kRows * kRows;
  Drawing drawing;
  drawing.options.headlight = false;
  const auto place = [](int i) { return glm::dvec3(0.3 * (i % kRows - 8), 0.3 * (i / kRows - 8), 0); };
  const auto color = [](int i) { return glm::vec3(i % 2, i % 3 == 0 ? 0.5f : 1.0f, i % 5 == 0); };
  RenderList lamps;
  for (int i = 0; i < kLamps; ++i) {
    Light light;
    light.kind = Light::Kind::point;
    light.location = place(i) + glm::dvec3(0, 0, 0.1);
    light.radius = 0.19f;
    light.color = color(i);
    lamps.lights.push_back(light);
  }
  RenderList floor = lamps, tiles = lamps;
  DrawItem item;
  item.material.diffuse = glm::vec3(1);
  item.mesh = square(3);
  add(floor, item);
  item.mesh = square(0.1f);
  for (int i = 0; i < kLamps; ++i) {
    item.world_from_node = translation(place(i));
    add(tiles, item);
  }
  const int size = drawing.options.width = drawing.options.height = 208;
  for (const RenderList* list : {&floor, &tiles}) {
    const Image image = drawing.draw(*list);
    for (int i = 0; i < kLamps; ++i) {
      const glm::dvec3 at = place(i);
      const auto pixel_of = [&](double x) { return static_cast<std::uint32_t>((x / 10 / kTangent + 1) * size / 2); };
      INFO((list == &floor ? "floor" : "tiles") << ", lamp " << i);
      check_color(pixel(image, pixel_of(at.x), pixel_of(-at.y)), color(i), 12.0f);  // beside the lamp
    }
  }
}

TEST_CASE("limits the search for lights, and still finds the strongest one of each item") {
  Drawing drawing;
  drawing.options.headlight = false;
  RenderList list;
  for (int i = 0; i < 6000; ++i) {
    Light light;
    light.kind = Light::Kind::point;
    light.location = {0, 0, i % 2 == 0 ? 5 : -5};  // half of them behind all squares
    light.intensity = i == 5000 ? 0.8f : 1e-9f;
    list.lights.push_back(light);
  }
  DrawItem item;
  item.mesh = square(0.02f);
  item.material.diffuse = glm::vec3(1);
  for (int i = 0; i < 2000; ++i) {
    item.world_from_node = translation({0.04 * (i % 50) - 1, 0.04 * (i / 50) - 0.8, 0});
    add(list, item);
  }
  const Image image = drawing.draw(list);
  check_color(pixel(image, 32, 32), glm::vec3(0.8f), 4.0f);
  check_color(pixel(image, 27, 36), glm::vec3(0.8f), 6.0f);
  check_color(pixel(image, 36, 27), glm::vec3(0.8f), 6.0f);
}

TEST_CASE("finds in the tree of lights the result of a full search") {
  std::uint32_t state = 7;
  const auto random = [&] { return static_cast<float>((state = state * 1664525u + 1013904223u) >> 8) / (1 << 24); };
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{9}, std::size_t{500}}) {
    std::vector<LightTree::Sphere> spheres;
    for (std::size_t i = 0; i < count; ++i)
      spheres.push_back({glm::vec3(random(), random(), random() * 0.2f) * 20.0f,
                         i % 50 == 49 ? std::numeric_limits<float>::infinity() : random(),
                         static_cast<std::uint16_t>(i)});
    LightTree tree;
    tree.build(spheres);
    CHECK(tree.empty() == (count == 0));
    for (int i = 0; i < 40; ++i) {
      const glm::vec3 center = glm::vec3(random(), random(), random()) * 25.0f - 2.0f;
      const float radius = i % 8 == 7 ? -1 : 3 * random();
      std::vector<std::uint16_t> found, wanted;
      tree.each_near(center, radius, [&](const LightTree::Sphere& sphere) { found.push_back(sphere.number); });
      for (const LightTree::Sphere& sphere : spheres)
        if (radius < 0 || glm::length(sphere.center - center) <= sphere.radius + radius)
          wanted.push_back(sphere.number);
      std::sort(found.begin(), found.end());
      CHECK(found == wanted);
    }
  }
}

TEST_CASE("draws items with any number of lights in one frame, with and without colours", "[optimised]") {
  Drawing drawing;
  drawing.options.headlight = false;
  RenderList list;
  for (int i = 0; i < 200; ++i) {
    Light light;
    light.intensity = 1.0f / 200;
    list.lights.push_back(light);
  }
  constexpr int kCounts[] = {0, 1, 2, 3, 17, 64, 65, 200};
  const auto colored = std::make_shared<vrml::Mesh>(*square(0.4f));
  for (std::size_t i = 0; i < colored->positions.size(); ++i) colored->colors.push_back({0.2f, 0.4f, 0.8f});
  for (int i = 0; i < 8; ++i)
    for (int row = 0; row < 2; ++row) {
      DrawItem item;
      item.mesh = row == 0 ? square(0.4f) : colored;
      item.world_from_node[3] = {i - 3.5f, row == 0 ? -1 : 1, 0, 1};
      item.material.diffuse = {0.9f, 0.6f, 0.3f};
      for (int light = 0; light < kCounts[i]; ++light)
        item.directional_lights.push_back(static_cast<std::uint16_t>(light));
      add(list, item);
    }
  const Image image = drawing.draw(list);
  for (int i = 0; i < 8; ++i) {
    const auto pixel_of = [](double at) { return static_cast<std::uint32_t>((at / 10 / kTangent + 1) * 32); };
    const float light = static_cast<float>(kCounts[i]) / 200;
    check_color(pixel(image, pixel_of(i - 3.5), pixel_of(1)), light * glm::vec3(0.9f, 0.6f, 0.3f));
    check_color(pixel(image, pixel_of(i - 3.5), pixel_of(-1)), light * glm::vec3(0.2f, 0.4f, 0.8f));
  }
}

TEST_CASE("lights the back of a two-sided face with the turned normal") {
  Drawing drawing;
  RenderList list;
  DrawItem item;
  auto mesh = square(20);
  mesh->solid = false;
  item.mesh = mesh;
  item.material.diffuse = {0.2f, 0.4f, 0.6f};
  add(list, item);
  Camera behind = camera_at({0, 0, -10});
  behind.world_from_camera[0] = {-1, 0, 0, 0};
  behind.world_from_camera[2] = {0, 0, -1, 0};
  check_color(pixel(drawing.draw(list), 32, 32), item.material.diffuse);
  check_color(pixel(drawing.draw(list, behind), 32, 32), item.material.diffuse);
}

TEST_CASE("keeps normals perpendicular under uneven, mirroring, flattening and tiny scales") {
  Drawing drawing;
  Light light;
  light.direction = glm::normalize(glm::vec3(0, -1, -1));
  drawing.options.headlight = false;
  // A square that leans back by 45 degrees after scaling: its normal must be (0, 1, 1) / sqrt 2.
  auto mesh = std::make_shared<vrml::Mesh>();
  for (const auto& [x, y] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
    mesh->positions.push_back({x, y, -2 * y});
    mesh->normals.push_back(glm::normalize(glm::vec3(0, 2, 1)));
    mesh->bounds.add({x, y, -2 * y});
  }
  mesh->indices = {0, 1, 2, 0, 2, 3};
  for (const glm::vec3& factors : {glm::vec3(1, 2, 1), glm::vec3(-1, 2, 1), glm::vec3(1, 2, 1) * 1e-12f}) {
    RenderList list;
    list.lights.push_back(light);
    DrawItem item;
    item.mesh = mesh;
    item.world_from_node = scale(factors);
    item.material.diffuse = glm::vec3(0.8f);
    item.directional_lights = {0};
    add(list, item);
    const Camera camera = camera_at(glm::vec3(0, 0, 10) * factors.y);
    check_color(pixel(drawing.draw(list, camera), 32, 32), glm::vec3(0.8f));
  }
  RenderList list;
  list.lights.push_back(light);
  DrawItem item;
  item.mesh = mesh;
  item.world_from_node = scale({1, 1, 0});  // flattened onto z = 0: the normal is +Z
  item.material.diffuse = glm::vec3(0.8f);
  item.directional_lights = {0};
  add(list, item);
  check_color(pixel(drawing.draw(list), 32, 32), glm::vec3(0.8f * std::sqrt(0.5f)));
}

TEST_CASE("lights faces without normals flat") {
  Drawing drawing;
  RenderList list;
  auto mesh = square(20);
  mesh->normals.clear();
  DrawItem item;
  item.mesh = mesh;
  item.material.diffuse = {0.9f, 0.3f, 0.1f};
  add(list, item);
  check_color(pixel(drawing.draw(list), 20, 40), item.material.diffuse);
}

TEST_CASE("lights meshes of very small triangles like others") {
  Drawing drawing;
  RenderList list;
  constexpr std::uint32_t kSide = 301;  // 180,000 triangles on 64 x 64 pixels
  auto mesh = std::make_shared<vrml::Mesh>();
  for (std::uint32_t j = 0; j < kSide; ++j)
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const glm::vec3 p(i / 150.0f - 1, j / 150.0f - 1, 0);
      mesh->positions.push_back(p);
      mesh->normals.push_back(glm::normalize(glm::vec3(p.x, p.y, 1)));
      mesh->bounds.add(p);
    }
  for (std::uint32_t j = 0; j + 1 < kSide; ++j)
    for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
      const std::uint32_t a = j * kSide + i, b = a + 1, c = b + kSide, d = a + kSide;
      for (std::uint32_t index : {a, b, c, a, c, d}) mesh->indices.push_back(index);
    }
  mesh->solid = false;
  DrawItem item;
  item.mesh = mesh;
  item.material = Material{};
  add(list, item);
  const Image image = drawing.draw(list, camera_at({0, 0, 3}));
  for (std::uint32_t y = 4; y < 64; y += 8) {
    const double z = 3 * kTangent;
    const glm::dvec3 p(((20 + 0.5) / 64 * 2 - 1) * z, (1 - (y + 0.5) / 64 * 2) * z, 0);
    if (std::abs(p.y) > 0.98) continue;
    const glm::dvec3 n = glm::normalize(glm::dvec3(p.x, p.y, 1));
    check_color(pixel(image, 20, y),
                glm::vec3(equation(item.material, item.material.diffuse, {Light{}}, p, n, {0, 0, 3})), 2.0f);
  }
}
