// Tests of primitives that are drawn small, with fewer triangles.
#include "render/collection/shapes/shape_resources.h"
#include "tests/render/drawing.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <string>

namespace gs::coarser_test {
namespace {

using namespace render;
using namespace render::testing;

struct World {
  explicit World(const std::string& geometry) : scene("test.wrl") {
    Diagnostics diagnostics;
    vrml::parse("#VRML V2.0 utf8\nShape { geometry " + geometry + " { } }", scene, diagnostics);
    REQUIRE(diagnostics.errors() == 0);
    list = collect(scene, {}, meshes);
    REQUIRE(list.items.size() == 1);
  }
  vrml::SceneGraph scene;
  MeshCache meshes;
  RenderList list;
};

// Returns the distance of a mesh point from the axis or centre, relative to the curved surface.
float reach(const std::string& geometry, const glm::vec3& p) {
  const float around = std::hypot(p.x, p.z);
  return geometry == "Sphere" ? glm::length(p) : geometry == "Cone" ? around / ((1 - p.y) / 2) : around;
}

std::shared_ptr<const vrml::Mesh> without_coarser(const vrml::Mesh& mesh) {
  auto copy = std::make_shared<vrml::Mesh>(mesh);
  copy->coarser.reset();
  return copy;
}

}  // namespace

TEST_CASE("makes a coarser mesh of a primitive within its stated error, with fewer triangles") {
  for (const std::string geometry : {"Sphere", "Cylinder", "Cone"}) {
    const World world(geometry);
    const vrml::Mesh* mesh = world.list.items[0].mesh.get();
    std::size_t levels = 0;
    for (; mesh->coarser; mesh = mesh->coarser.get(), ++levels) {
      INFO(geometry << " level " << levels);
      const vrml::Mesh& coarser = *mesh->coarser;
      CHECK(coarser.indices.size() * 4 <= mesh->indices.size() * 3);
      CHECK(coarser.bounds.upper.y == mesh->bounds.upper.y);
      const float most = mesh->coarser_error * glm::length(mesh->bounds.size()) / 2;
      float worst = 0;
      for (std::size_t i = 0; i + 2 < coarser.indices.size(); i += 3) {
        const glm::vec3 a = coarser.positions[coarser.indices[i]], b = coarser.positions[coarser.indices[i + 1]];
        const glm::vec3 middle = (a + b) * 0.5f;
        // Caps are inside the surface. The sides of a quad touch the surface or cut it. Near its tip, a cone has no
        // radius.
        if (geometry != "Sphere" &&
            (std::abs(a.y - b.y) > 1e-4f || a.y > 0.9f || std::hypot(a.x, a.z) < 0.5f || std::hypot(b.x, b.z) < 0.5f))
          continue;
        worst = std::max(worst, 1 - reach(geometry, middle));
      }
      CHECK(worst > 0);
      // The diagonal of a sphere's quad is longer than its sides by the root of two.
      CHECK(worst <= most * (geometry == "Sphere" ? 2.01f : 1.01f));
    }
    CHECK(levels == ShapeResources::kSegments.size() - 1);
  }
  CHECK_FALSE(World("Box").list.items[0].mesh->coarser);
}

TEST_CASE("draws small items with fewer triangles and without a visible change") {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 200;
  for (const std::string geometry : {"Sphere", "Cylinder", "Cone"}) {
    World world(geometry);
    std::size_t before = SIZE_MAX;
    for (const float distance : {2.5f, 12.0f, 60.0f, 300.0f}) {
      INFO(geometry << " from " << distance);
      const Camera camera = camera_at({0, 0, distance});
      const Image drawn = drawing.draw(world.list, camera);
      const std::size_t triangles = drawing.statistics.triangles;
      CHECK(triangles <= before);
      before = triangles;
      RenderList finest = world.list;
      finest.items[0].mesh = without_coarser(*world.list.items[0].mesh);
      const Image exact = drawing.draw(finest, camera);
      CHECK(drawing.statistics.triangles == finest.items[0].mesh->indices.size() / 3);
      // Only pixels at the outline, which moves by half a pixel, may differ much.
      std::size_t differ = 0, shown = 0;
      for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
        differ += std::abs(drawn.pixels[i] - exact.pixels[i]) > 24 ? 1 : 0;
        shown += exact.pixels[i] > 0 ? 1 : 0;
      }
      CHECK(shown > 0);
      CHECK(differ <= 3 * 2 * 200 / static_cast<std::size_t>(distance) + 12);
    }
    CHECK(before <= world.list.items[0].mesh->indices.size() / 3 / 8);
  }
}

}  // namespace gs::coarser_test
