#include "app/encode/outline_model.h"
#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/decode_stream.h"

#include "tests/app/geometry_shapes.h"
#include "tests/app/late_worlds.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

namespace gs::app::set_streams_test {
namespace {

using late_worlds::Bytes;
using late_worlds::kHeader;
using late_worlds::Site;

/// Returns a ball of this number of vectors.
Bytes ball(std::size_t vectors) {
  qnv::EncodeOptions options;
  auto encoded = qnv::encode_vectors(gs::test::sphere(vectors), options);
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  return std::get<qnv::EncodedStream>(std::move(encoded)).bytes;
}

std::size_t size_of(const Bytes& stream) {
  constexpr std::size_t kMax = 1 << 20;
  const auto decoded = qnv::decode_stream(stream, kMax);
  return std::get<qnv::Geometry>(decoded.content).size();
}

/// Returns outlines of shapes.
Bytes outlines(const std::string& shapes) {
  Diagnostics diagnostics;
  vrml::SceneGraph scene("model.wrl");
  (void)vrml::parse(kHeader + shapes, scene, diagnostics);
  render::MeshCache meshes;
  const OutlineModel model = outline_model(render::collect(scene, {}, meshes), {});
  const auto groups = qnv::group_outlines(model.model, {});
  REQUIRE(std::holds_alternative<qnv::OutlineGroups>(groups));
  auto encoded = qnv::encode_outlines(std::get<qnv::OutlineGroups>(groups), model.appearances, {});
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  return std::get<qnv::EncodedStream>(std::move(encoded)).bytes;
}

struct World : late_worlds::World {
  explicit World(const Site& site) : late_worlds::World(site) {}
  vrml::NodeId geometry() { return scene().get<vrml::SFNode>(root(0), "geometry"); }
  void set_url(const std::string& url) { late_worlds::World::set_url(geometry(), url); }
  ResourceUpdates come() { return fetch(); }
  void arrive() { late_worlds::World::arrive(come()); }
  std::size_t vectors() {
    const auto& splats = list().splats;
    return splats.empty() || !splats[0].geometry ? 0 : splats[0].geometry->size();
  }
  std::size_t triangles() {
    const auto& items = list().items;
    return items.empty() ? 0 : items[0].mesh->indices.size() / 3;
  }
};

}  // namespace

TEST_CASE("replaces the vectors of a QNV node on set_url") {
  Site site;
  site.put("world.wrl", kHeader + "Shape { geometry QNV { url \"small.qnv\" } }");
  site.put("small.qnv", ball(300));
  site.put("large.qnv", ball(2000));
  const std::size_t small = size_of(ball(300)), large = size_of(ball(2000));
  REQUIRE(0 < small);
  REQUIRE(small < large);
  World world(site);
  world.arrive();
  CHECK(world.vectors() == small);
  world.set_url("large.qnv");
  CHECK(world.vectors() == small);  // until another stream is loaded
  world.arrive();
  CHECK(world.vectors() == large);
  world.set_url("small.qnv");
  ResourceUpdates former = world.come();
  REQUIRE(former.geometries.size() == 1);
  world.set_url("large.qnv");
  ResourceUpdates present = world.come();
  world.runtime->arrive(std::move(former));
  CHECK(world.vectors() == large);
  world.runtime->arrive(std::move(present));
  CHECK(world.vectors() == large);
  world.set_url("");
  world.arrive();
  CHECK(world.vectors() == 0);
}

TEST_CASE("replaces the polygons of an OutlineGroup on set_url") {
  Site site;
  site.put("world.wrl", kHeader + "Shape { geometry OutlineGroup { url \"box.qnv\" } }");
  site.put("box.qnv", outlines("Shape { geometry Box { } }"));
  site.put("tetrahedron.qnv",
           outlines("Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0, 0 0 1 ] } "
                    "coordIndex [ 0 2 1 -1 0 1 3 -1 1 2 3 -1 2 0 3 -1 ] } }"));
  World world(site);
  CHECK(world.triangles() == 0);
  world.arrive();
  CHECK(world.triangles() == 12);
  const auto complete = [&] { return world.opened.scene->get<vrml::SFBool>(world.geometry(), "complete"); };
  CHECK(complete());
  for (int round = 0; round < 3; ++round) {
    world.set_url("tetrahedron.qnv");
    CHECK(world.triangles() == 12);
    world.arrive();
    CHECK(world.triangles() == 4);
    CHECK(world.opened.outlines.size() == 1);
    world.set_url("box.qnv");
    world.arrive();
    CHECK(world.triangles() == 12);
  }
  world.set_url("tetrahedron.qnv");
  ResourceUpdates former = world.come();
  REQUIRE(former.outlines.size() == 1);
  world.set_url("box.qnv");
  ResourceUpdates present = world.come();
  world.runtime->arrive(std::move(former));
  CHECK(world.triangles() == 12);
  world.runtime->arrive(std::move(present));
  CHECK(world.triangles() == 12);
  // The url names a missing file, then none.
  world.set_url("none.qnv");
  world.arrive();
  CHECK(world.triangles() == 0);
  CHECK_FALSE(complete());
  CHECK(world.opened.diagnostics.warnings() == 1);
  world.set_url("box.qnv");
  world.arrive();
  CHECK(world.triangles() == 12);
  world.set_url("");
  world.arrive();
  CHECK(world.triangles() == 0);
}

TEST_CASE("adds late polygons of a file to its OutlineGroup, without delay of the rest") {
  Site site;
  site.put(
      "world.wrl",
      kHeader +
          "Shape { geometry OutlineGroup { url \"box.qnv\" point [ 5 0 0, 6 0 0, 5 1 0 ] coordIndex [ 0 1 2 -1 ] } } "
          "DEF T TimeSensor { loop TRUE }");
  site.put("box.qnv", outlines("Shape { geometry Box { } }"), 4000);
  World world(site);
  CHECK(world.triangles() == 1);
  CHECK(world.runtime->next_time().has_value());
  world.arrive();
  CHECK(world.triangles() == 13);
}

}  // namespace gs::app::set_streams_test
