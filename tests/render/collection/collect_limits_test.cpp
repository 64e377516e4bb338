#include "render/collection/shapes/shape_resources.h"
#include "render/scene/render_list.h"
#include "tests/watched.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

namespace gs::collect_limits_test {
namespace {

using namespace render;

constexpr std::size_t kVisits = Limits().visits;

/// Parsed world with a small memory limit.
struct SmallWorld {
  SmallWorld(const std::string& body, std::size_t memory)
      : scene(std::make_unique<vrml::SceneGraph>("bomb.wrl",
                                                 Limits{.memory = memory, .visits = kVisits / watched_step(16)})) {
    Diagnostics diagnostics;
    vrml::parse("#VRML V2.0 utf8\n" + body, *scene, diagnostics);
    for (const Diagnostic& d : diagnostics.entries()) UNSCOPED_INFO(d.text());
    REQUIRE(diagnostics.errors() == 0);
  }
  RenderList collect() { return render::collect(*scene, {}, meshes); }
  [[nodiscard]] Budget& budget() const { return *scene->budget(); }

  std::unique_ptr<vrml::SceneGraph> scene;
  MeshCache meshes;
};

constexpr std::size_t kMega = std::size_t{1} << 20;

/// Returns nested USEs of 2^levels times `shape`.
std::string nested_uses(const std::string& shape, int levels) {
  std::string text = "DEF N0 Group { children " + shape + " }\n";
  for (int i = 1; i <= levels; ++i) {
    const std::string use = "USE N" + std::to_string(i - 1) + " ";
    text += "DEF N" + std::to_string(i) + " Group { children [ " + use + use + "] }\n";
  }
  return text;
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

std::size_t triangles_of(const RenderList& list) {
  std::size_t count = 0;
  for (const DrawItem& item : list.items) count += item.mesh->indices.size() / 3;
  return count;
}

}  // namespace

TEST_CASE("limits the shapes of nested USEs, and names the first one that is left out") {
  SmallWorld world("Shape { geometry Box { } }\n" + nested_uses("Shape { geometry Cylinder { } }", 15), 16 * kMega);
  const RenderList list = world.collect();
  const std::size_t most = world.budget().limit(Resource::items);
  CHECK(most == 2048);
  CHECK(list.items.size() == most);
  REQUIRE(list.limit_reports.size() == 1);
  CHECK(list.limit_reports[0].why ==
        "more than the limit for shapes in a picture, 2048 of one world (--memory raises it)");
  CHECK(list.limit_reports[0].count > 1000);
  CHECK(list.limit_reports[0].file == "bomb.wrl");
  CHECK(list.limit_reports[0].location == SourceLocation{3, 42});
  CHECK(world.collect().limit_reports.size() == 1);  // in each picture
}

TEST_CASE("stops a walk over empty groups at the limit for visits") {
  SmallWorld world(nested_uses("Group { }", 40), 2048 * kMega);
  const RenderList list = world.collect();
  CHECK(list.items.empty());
  REQUIRE(list.limit_reports.size() == 1);
  CHECK(list.limit_reports[0].why.find(std::to_string(kVisits / watched_step(16)) + " that one picture may visit") !=
        std::string::npos);
}

TEST_CASE("leaves out Shapes beyond the triangle limit, and shows the others") {
  // A limit of 1 M triangles, with 20,000 per shape.
  const std::string shape =
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ " +
      repeated("0 1 2 -1 ", 20'000) + "] } }";
  SmallWorld world(nested_uses(shape, 7) + "Shape { geometry Box { } }", 32 * kMega);
  CHECK(world.budget().limit(Resource::triangles) == kMega);
  const RenderList list = world.collect();
  CHECK(triangles_of(list) <= kMega);
  CHECK(list.items.size() == 53);
  CHECK(list.items.back().mesh->indices.size() == 36);  // the box after these shapes
  REQUIRE(list.limit_reports.size() == 1);
  CHECK(list.limit_reports[0].why.find("triangles in a picture") != std::string::npos);
}

TEST_CASE("leaves out meshes beyond the memory limit, at all their USEs") {
  const std::string grid = "[ " + repeated("0 ", 10'000) + "]";
  SmallWorld world("PROTO Grid [ ] { Shape { geometry ElevationGrid { xDimension 100 zDimension 100 height " + grid +
                       " } } }\n" + repeated("Grid { }\n", 100) + "Shape { geometry Box { } }",
                   64 * kMega);
  const RenderList list = world.collect();
  CHECK(list.items.size() > 10);
  CHECK(list.items.size() < 90);
  CHECK(list.items.back().mesh->indices.size() == 36);
  REQUIRE(list.limit_reports.size() == 1);
  CHECK(list.limit_reports[0].why.find("more than the limit for meshes") != std::string::npos);
  CHECK(list.limit_reports[0].count + list.items.size() == 101);
  CHECK(world.budget().used(Resource::meshes) <= world.budget().limit(Resource::meshes));
  const std::uint64_t used = world.budget().used(Resource::meshes);
  CHECK(world.collect().items.size() == list.items.size());
  CHECK(world.budget().used(Resource::meshes) == used);
  world.meshes.clear();
  CHECK(world.budget().used(Resource::meshes) == 0);
}

TEST_CASE("uses no more memory for meshes that are made again") {
  SmallWorld world(
      "Shape { geometry DEF G IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] }\n"
      "coordIndex [ " +
          repeated("0 1 2 -1 ", 1000) + "] } }",
      64 * kMega);
  (void)world.collect();
  const std::uint64_t used = world.budget().used(Resource::meshes);
  CHECK(used > 0);
  for (int i = 0; i < 100; ++i) {
    world.meshes.meshes.clear();
    CHECK(world.collect().limit_reports.empty());
  }
  CHECK(world.budget().used(Resource::meshes) == used);
}

TEST_CASE("shares one mesh between thousands of spheres, and makes it coarser as they grow in number") {
  const auto spheres = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += "Transform { translation " + std::to_string(i % 100) + " " + std::to_string(i / 100) +
              " 0 children Shape { geometry Sphere { radius 0." + std::to_string(100 + i % 300) + " } } }\n";
    return text;
  };
  SmallWorld few(spheres(1000), 2048 * kMega), many(spheres(40'000) + "Shape { geometry Box { } }", 2048 * kMega);
  const RenderList fine = few.collect(), coarse = many.collect();
  REQUIRE(fine.items.size() == 1000);
  REQUIRE(coarse.items.size() == 40'001);
  CHECK(fine.items.front().mesh == fine.items.back().mesh);
  CHECK(coarse.items[0].mesh == coarse.items[39'999].mesh);
  CHECK(fine.items[0].mesh->indices.size() > coarse.items[0].mesh->indices.size());
  CHECK(triangles_of(coarse) <= std::size_t{1} << 24);
  CHECK(coarse.items.back().mesh->indices.size() == 36);  // a box cannot become coarser
  CHECK(coarse.limit_reports.empty());
  CHECK(many.meshes.meshes.empty());
  CHECK(many.meshes.primitives.size() <= 2 * ShapeResources::kSegments.size());
  CHECK(many.budget().used(Resource::meshes) == 0);
}

TEST_CASE("charges PixelTextures to the budget for pixels") {
  std::string pixels;
  for (int i = 0; i < 64 * 64; ++i) pixels += "0 ";
  SmallWorld world("PROTO P [ ] { Shape { appearance Appearance { texture PixelTexture { image 64 64 3 " + pixels +
                       "} } geometry Box { } } }\n" + repeated("P { }\n", 200),
                   8 * kMega);
  const RenderList list = world.collect();
  REQUIRE(list.items.size() == 200);
  CHECK(list.items.front().texture.image);
  CHECK_FALSE(list.items.back().texture.image);
  REQUIRE(list.limit_reports.size() == 1);
  CHECK(list.limit_reports[0].why.find("pixels of textures") != std::string::npos);
  CHECK(world.budget().used(Resource::pixels) <= world.budget().limit(Resource::pixels));
}

TEST_CASE("stops collecting when the budget's stop function returns true") {
  SmallWorld world(nested_uses("Shape { geometry Box { } }", 17), 2048 * kMega);
  int looks = 0;
  world.budget().stop_when([&] { return ++looks > 5; });
  const RenderList list = world.collect();
  CHECK(list.items.size() > 0);
  CHECK(list.items.size() < 10'000);
  CHECK(list.limit_reports.empty());
}

TEST_CASE("calls the budget's stop function between any two meshes") {
  std::string grids;
  for (int i = 0; i < 100; ++i)
    grids +=
        "Shape { geometry ElevationGrid { xDimension 2 zDimension 2 height [ 0 0 0 " + std::to_string(i) + " ] } }\n";
  SmallWorld world(grids, 2048 * kMega);
  int looks = 0;
  world.budget().stop_when([&] { return ++looks > 20; });
  const RenderList list = world.collect();
  CHECK(list.items.size() > 2);
  CHECK(list.items.size() <= 20);
  world.budget().stop_when({});
  CHECK(world.collect().items.size() == 100);
}

}  // namespace gs::collect_limits_test
