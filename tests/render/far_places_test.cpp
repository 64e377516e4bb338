// Pairs of equal pictures: splats and the viewer at the origin, and both 4,500 km away.

#include "render/collection/collector.h"
#include "tests/render/drawing.h"
#include "tests/render/geometry_shapes.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <memory>
#include <string>

namespace gs::render::far_places_test {
using namespace gs::render::testing;
namespace {

// Each coordinate is a float32 value, as the Transform requires.
const glm::dvec3 kFar{4'500'000.5, -4'500'000.5, 3'200'000.25};

/// World of one QNV node below a Transform, with the vectors of `geometry`.
struct GeometryWorld {
  GeometryWorld(const qnv::Geometry& geometry, const glm::dvec3& origin, const glm::dvec3& translation)
      : scene(std::make_unique<vrml::SceneGraph>("far.wrl")) {
    std::string place;
    for (int i = 0; i < 3; ++i) place += std::to_string(translation[i]) + " ";
    Diagnostics diagnostics;
    (void)vrml::parse("#VRML V2.0 utf8\nTransform { translation " + place + "children Shape { geometry QNV { } } }",
                      *scene, diagnostics);
    REQUIRE(diagnostics.errors() == 0);
    auto moved = std::make_shared<qnv::Geometry>(geometry);
    moved->base().description.origin = origin;
    for (std::uint32_t i = 1; i <= scene->nodes().count(); ++i)
      if (const vrml::NodeId id = scene->resolve_as(scene->nodes().id_at(i), vrml::NodeKind::qnv))
        geometries[&scene->node(id)] = moved;
    REQUIRE(geometries.size() == 1);
  }
  Image draw(Drawing& drawing, const glm::dvec3& place) {
    Camera camera = camera_at({0.3f, 0.2f, 3});
    camera.world_from_camera[3] += glm::dvec4(place, 0);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    const RenderList list = collect(*scene, {}, meshes, eye, geometries);
    // The box in world space is equally exact.
    CHECK(glm::length(list.bounds.center() - place) < 0.06);
    return drawing.draw(list, camera);
  }
  std::unique_ptr<vrml::SceneGraph> scene;
  MeshCache meshes;
  Geometries geometries;
};

/// Counts pixels that differ by more than `most` in any colour.
std::size_t others(const Image& a, const Image& b, int most) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) count += std::abs(int{a.pixels[i]} - int{b.pixels[i]}) > most;
  return count;
}

void check_alike_far(const qnv::Geometry& geometry, SplatPath path) {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 120;
  drawing.options.splats = path;
  const Image near = GeometryWorld(geometry, {}, {}).draw(drawing, {});
  CHECK(std::count_if(near.pixels.begin(), near.pixels.end(), [](std::uint8_t c) { return c > 40; }) > 3000);
  // Moved by its origin, by a Transform, and by both.
  CHECK(others(near, GeometryWorld(geometry, kFar, {}).draw(drawing, kFar), 3) <= 6);
  CHECK(others(near, GeometryWorld(geometry, {}, kFar).draw(drawing, kFar), 3) <= 6);
  CHECK(others(near, GeometryWorld(geometry, kFar, kFar).draw(drawing, kFar * 2.0), 3) <= 6);
  // A shift of half a centimetre changes the picture.
  CHECK(others(near, GeometryWorld(geometry, kFar + glm::dvec3(0.005, 0, 0), {}).draw(drawing, kFar), 3) > 60);
}

}  // namespace

TEST_CASE("draws splats far from the origin as near it") {
  const qnv::Splats geometry = test::disc_sphere(4000, 0.5f);
  check_alike_far(geometry, SplatPath::cpu);
  check_alike_far(geometry, SplatPath::gl);
}

TEST_CASE("draws volumes far from the origin as near it") {
  qnv::Volume geometry = test::random_volume(1500, 3, 0.08f);
  for (const glm::vec3& p : geometry.positions) geometry.description.box.add(p);
  check_alike_far(geometry, SplatPath::cpu);
  check_alike_far(geometry, SplatPath::gl);
}

TEST_CASE("draws surfaces with triangles far from the origin as near it") {
  qnv::IndexedMesh geometry;
  constexpr std::uint32_t kRows = 24, kColumns = 48;
  for (std::uint32_t row = 0; row <= kRows; ++row)
    for (std::uint32_t column = 0; column <= kColumns; ++column) {
      const float t = 3.14159265f * static_cast<float>(row) / kRows,
                  f = 2 * 3.14159265f * static_cast<float>(column) / kColumns;
      const glm::vec3 n(std::sin(t) * std::cos(f), std::cos(t), -std::sin(t) * std::sin(f));
      test::add(geometry, n * 0.5f, n, 0.01f);
      geometry.colors.push_back({static_cast<std::uint8_t>(column * 5), static_cast<std::uint8_t>(row * 10), 128});
      geometry.description.box.add(geometry.positions.back());
      if (row == kRows || column == kColumns) continue;
      const std::uint32_t at = row * (kColumns + 1) + column, below = at + kColumns + 1;
      for (const std::uint32_t corner : {at, below, below + 1, at, below + 1, at + 1})
        geometry.triangles.push_back(corner);
    }
  check_alike_far(geometry, SplatPath::automatic);
}

}  // namespace gs::render::far_places_test
