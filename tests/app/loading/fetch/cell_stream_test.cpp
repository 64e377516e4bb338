// Tests of streams that are received as cells over UDP on this machine.
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/app/loading/fetch/cell_site.h"
#include "tests/geometries.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

using namespace gs;
using namespace gs::app;

TEST_CASE("restores the stream of the file from cells", "[optimised]") {
  CellSite site;
  site.start();
  for (const char* name : {"packed.qnv", "records.qnv"}) {
    INFO(name);
    LoadOptions options;
    options.timeout_seconds = 120;
    const LoadedWorld world = load_world(site.url(name), options);
    REQUIRE(world.scene);
    CHECK(world.diagnostics.entries().empty());
    CHECK_FALSE(world.truncated);
    CHECK(discs_of(geometry_of_world(world)) == discs_of(geometry_of_world(load_world(site.folder.path(name)))));
  }
}

TEST_CASE("restores a distant mesh over HTTP and from cells") {
  CellSite site;
  site.options.http_port = 0;
  site.start();
  REQUIRE(exact_stream()[8] == 2);  // version
  const auto wanted = content_of<qnv::IndexedMesh>(geometry_of_world(load_world(site.folder.path("exact.qnv"))));
  REQUIRE(wanted.triangles.size() == 3 * (4 * 40 * 40 - 4 * 40));
  CHECK(wanted.description.origin == glm::dvec3(6e6, 2e6, -3e6));
  const std::string http = "http://127.0.0.1:" + std::to_string(*site.archive->http_port()) + "/exact.qnv";
  for (const std::string& url : {http, site.url("exact.qnv")}) {
    INFO(url);
    LoadOptions options;
    options.timeout_seconds = 120;
    const LoadedWorld world = load_world(url, options);
    REQUIRE(world.scene);
    CHECK(world.diagnostics.entries().empty());
    const auto geometry = content_of<qnv::IndexedMesh>(geometry_of_world(world));
    CHECK(geometry.description.origin == wanted.description.origin);
    CHECK(geometry.positions == wanted.positions);
    CHECK(geometry.normals == wanted.normals);
    CHECK(geometry.triangles == wanted.triangles);
  }
}

TEST_CASE("loses only detail with lost cells", "[optimised]") {
  CellSite site;
  site.start();
  for (const char* name : {"packed.qnv", "records.qnv"}) {
    INFO(name);
    const qnv::Geometry whole = geometry_of_world(load_world(site.folder.path(name)));
    LoadOptions options;
    options.timeout_seconds = 120;
    options.loss = 0.3;
    const LoadedWorld world = load_world(site.url(name), options);
    REQUIRE(world.scene);
    CHECK(world.diagnostics.errors() == 0);
    const qnv::Geometry geometry = geometry_of_world(world);
    CHECK(geometry.size() > whole.size() / 20);
    // The total area equals that of the whole stream, whichever vectors are missing.
    CHECK(total_of(geometry) == Approx(total_of(whole)).epsilon(0.05));
  }
}

TEST_CASE("restores the values of a volume from lossy cells", "[optimised]") {
  CellSite site;
  qnv::VolumeLayout layout;
  layout.dimensions = {70, 60, 50};
  layout.type = qnv::VoxelType::u8;
  std::vector<std::uint8_t> voxels;
  for (std::uint32_t i = 0; i < 70 * 60 * 50; ++i)
    voxels.push_back(static_cast<std::uint8_t>(i % 70 + i / 70 % 60 + i / 4200 + i * 2654435761u % 7));
  const auto encoded = qnv::encode_values(test::volume_of(layout, voxels), {});
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  const auto& stream = std::get<qnv::EncodedStream>(encoded);
  CHECK(stream.header.parity);
  site.folder.write("values.qnv", string_of(stream.bytes));
  site.start();
  for (const double loss : {0.1, 0.3}) {
    int exact = 0;
    double near = 0;  // share of the voxels within 2 of their values
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      LoadOptions options;
      options.timeout_seconds = 120;
      options.loss = loss;
      options.loss_seed = seed;
      const LoadedWorld world = load_world(site.url("values.qnv"), options);
      REQUIRE(world.scene);
      CHECK(world.diagnostics.errors() == 0);
      const qnv::Geometry geometry = geometry_of_world(world);
      const auto* volume = geometry.as<qnv::Volume>();
      REQUIRE(volume);
      REQUIRE(volume->values);
      exact += volume->values->exact ? 1 : 0;
      std::vector<std::byte> scratch;
      std::vector<float> slice(70 * 60);
      for (std::uint32_t z = 0; z < 50; ++z) {
        REQUIRE(qnv::read_slice(volume->values->source, z, scratch, slice));
        for (std::size_t i = 0; i < slice.size(); ++i)
          near += std::abs(slice[i] - static_cast<float>(voxels[z * slice.size() + i])) <= 2 ? 1.0 / (3 * 210'000) : 0;
      }
    }
    INFO("loss " << loss << ", exact " << exact << ", near " << near);
    CHECK((loss > 0.2 || exact >= 2));
    CHECK(near > (loss > 0.2 ? 0.9 : 0.99));
  }
}

TEST_CASE("loads the first url of a QNV node that has a stream") {
  CellSite site;
  site.start();
  const std::string world_text = "#VRML V2.0 utf8\nShape { geometry QNV { url [ \"" + site.url("none.qnv") + "\" \"" +
                                 site.url("world.wrl") + "\" \"" + site.url("records.qnv") + "\" ] } }\n";
  site.folder.write("two.wrl", world_text);
  LoadOptions options;
  options.timeout_seconds = 120;
  const LoadedWorld world = load_world(site.folder.path("two.wrl"), options);
  REQUIRE(world.scene);
  CHECK(world.diagnostics.entries().empty());
  CHECK(geometry_of_world(world).size() == 30'000);
  options.offline = true;
  const LoadedWorld offline = load_world(site.folder.path("two.wrl"), options);
  CHECK(offline.geometries.empty());
  CHECK(tells(offline.diagnostics, "--offline"));
}

TEST_CASE("reports sources that cannot be read as cells") {
  CellSite site;
  site.start();
  const LoadedWorld none = load_world(site.url("none.qnv"));
  CHECK_FALSE(none.scene);
  CHECK(tells(none.diagnostics, "not found"));
  const LoadedWorld other = load_world(site.url("world.wrl"));
  CHECK_FALSE(other.scene);
  CHECK(tells(other.diagnostics, "not a QNV stream"));
  const LoadedWorld bad = load_world("cells://127.0.0.1:99999/a.qnv");
  CHECK_FALSE(bad.scene);
  CHECK(tells(bad.diagnostics, "expected cells://HOST:PORT/PATH"));
  const std::string url = site.url("packed.qnv");
  site.archive.reset();
  LoadOptions impatient;
  impatient.timeout_seconds = 0.5;
  const LoadedWorld silent = load_world(url, impatient);
  CHECK_FALSE(silent.scene);
  CHECK(tells(silent.diagnostics, "time limit for loading was reached"));
}

TEST_CASE("requests and receives only a part of a stream") {
  CellSite site;
  site.start();
  LoadOptions options;
  options.max_bytes = 200'000;
  WorldLoading loading(site.url("packed.qnv"), options);
  while (!loading.done()) (void)loading.step(kCellWait);
  CHECK(loading.state().received <= 200'000);
  CHECK(loading.state().received > 100'000);
  const LoadedWorld world = loading.take();
  for (const auto& feed : world.feeds) (void)feed->apply();
  const std::size_t part = geometry_of_world(world).size();
  CHECK(part > 10'000);
  CHECK(part < geometry_of_world(load_world(site.folder.path("packed.qnv"))).size());
}
