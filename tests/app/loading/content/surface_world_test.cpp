// Tests of displaced surfaces as worlds: the parts loaded for drawing, and hits of the pointer.
#include "app/loading/world_loader.h"
#include "app/view/picking.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/displaced/tessellation/patch_surface.h"
#include "qnv/codecs/shared/encode_options.h"
#include "render/collection/collector.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <string>

namespace gs::app::surface_world_test {
namespace {

/// Returns a ball of radius 1.
const std::string& ball_stream() {
  static const std::string bytes = [] {
    const qnv::Triangles ball = qnv::displaced::ball(40);
    auto made = qnv::encode_displaced([&](const qnv::TriangleSink& sink) { return sink(ball); }, {});
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(made));
    return test::string_of(std::get<qnv::EncodedStream>(made).bytes);
  }();
  return bytes;
}

}  // namespace

TEST_CASE("loads a displaced surface as patches for drawing, and as triangles for other callers") {
  const ScratchFolder folder;
  const std::string path = folder.write("ball.qnv", ball_stream());
  LoadedWorld world = load_world(path);
  INFO(said(world));
  REQUIRE(world.geometries.size() == 1);
  const auto* patches = world.geometries.begin()->second->as<qnv::SurfacePatches>();
  REQUIRE(patches);
  LoadOptions whole;
  whole.whole_surfaces = true;
  const LoadedWorld other = load_world(path, whole);
  const auto* mesh = other.geometries.begin()->second->as<qnv::IndexedMesh>();
  REQUIRE(mesh);
  CHECK(mesh->size() == patches->parts[0]->vertex_count());
  LoadOptions cut;
  cut.max_bytes = ball_stream().size() * 9 / 10;
  const LoadedWorld part = load_world(path, cut);
  INFO(said(part));
  REQUIRE(part.geometries.size() == 1);
  CHECK(part.geometries.begin()->second->as<qnv::SurfacePatches>());

  render::MeshCache meshes;
  const render::RenderList list = render::collect(*world.scene, world.images, meshes, {0, 0, 10}, world.geometries);
  REQUIRE(list.items.size() == 1);
  CHECK(list.splats.empty());
  CHECK(list.items[0].patches() == patches);
  CHECK(list.items[0].mesh->indices.size() / 3 <= 16384);
  CHECK(list.bounds.upper.x == Approx(1).margin(0.05));
}

TEST_CASE("hits the drawn triangles of a displaced surface by the pointer") {
  const ScratchFolder folder;
  LoadedWorld world = load_world(folder.write("ball.qnv", ball_stream()));
  render::MeshCache meshes;
  render::RenderList list = render::collect(*world.scene, world.images, meshes, {0, 0, 10}, world.geometries);
  REQUIRE(list.items.size() == 1);
  const glm::dvec3 middle(4, 0, -2);
  list.items[0].world_from_node = glm::scale(glm::translate(glm::dmat4(1), middle), glm::dvec3(2));
  for (const glm::dvec3& to : {glm::dvec3(0), glm::dvec3(0.5, 0.3, 0), glm::dvec3(-1, 0.8, 0.4)}) {
    render::SightLine line;
    line.origin = middle + glm::dvec3(0.3, 0.2, 6);
    line.direction = glm::normalize(middle + to - line.origin);
    const auto hit = Picker().pick(list, line);
    REQUIRE(hit);
    CHECK(hit->item == 0);
    CHECK(!hit->splat);
    CHECK(glm::length(hit->point - middle) == Approx(2).margin(0.02));
    CHECK(glm::dot(hit->normal, glm::normalize(hit->point - middle)) > 0.99);
    CHECK(glm::length(hit->point - line.origin) == Approx(hit->distance));
    // From a distance, the picture and the hit use equally coarse triangles.
    PickOptions far;
    far.pixel = 1;
    const auto coarse = Picker().pick(list, line, far);
    REQUIRE(coarse);
    CHECK(glm::length(coarse->point - middle) < glm::length(hit->point - middle) + 0.01);
  }
  render::SightLine beside;
  beside.origin = {0, 0, 6};
  CHECK(!Picker().pick(list, beside));
}

}  // namespace gs::app::surface_world_test
