// Streams that come as cells over UDP, on this machine.
#include "app/serve/archive.h"
#include "app/streams/cell_regions.h"
#include "app/streams/stream_feed.h"
#include "app/world/world_loading.h"
#include "qnv/encode/encode_surface.h"
#include "qnv/lod/lod.h"
#include "tests/app/clouds.h"
#include "tests/app/large_stream.h"
#include "tests/app/program.h"
#include "tests/app/scratch_folder.h"
#include "tests/qnv/surface_shapes.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using test::string_of;

namespace {

constexpr std::chrono::milliseconds kCellWait{20};

/// A stream of records of a coloured ball.
const std::string& records_stream() {
  static const std::string bytes = [] {
    qnv::EncodeOptions options;
    options.payload = qnv::Payload::records;
    const auto encoded = qnv::encode_cloud(test::sphere(30'000), options);
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
    return string_of(std::get<qnv::EncodedStream>(encoded).bytes);
  }();
  return bytes;
}

/// A ball far from 0, with the mesh itself at its end: version 2.
const std::string& exact_stream() {
  static const std::string bytes = [] {
    qnv::EncodeOptions options;
    options.exact_bits = 12;
    options.origin = {6e6, 2e6, -3e6};
    const auto encoded = qnv::encode_displaced(qnv::source_of(qnv::sphere(40)), options);
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
    return string_of(std::get<qnv::EncodedStream>(encoded).bytes);
  }();
  return bytes;
}

/// An archive of cells in a folder of its own.
struct CellSite {
  ScratchFolder folder;
  std::unique_ptr<Archive> archive;
  ArchiveOptions options;

  CellSite() {
    folder.write("packed.qnv", large_stream());
    folder.write("records.qnv", records_stream());
    folder.write("exact.qnv", exact_stream());
    folder.write("world.wrl", "#VRML V2.0 utf8\nShape { geometry Box {} }\n");
    options.folder = folder.path("");
    options.cells_port = 0;
    options.log = "";
  }
  void start() {
    auto started = Archive::start(options);
    if (const auto* problem = std::get_if<std::string>(&started)) FAIL(*problem);
    archive = std::move(std::get<std::unique_ptr<Archive>>(started));
    options.cells_port = archive->cells_port();
  }
  [[nodiscard]] std::string url(const std::string& name) const {
    return "cells://127.0.0.1:" + std::to_string(*options.cells_port) + "/" + name;
  }
};

qnv::Cloud cloud_of_world(const OpenedWorld& world) {
  REQUIRE(world.clouds.size() == 1);
  const auto& cloud = *world.clouds.begin()->second;
  return cloud.levels ? cloud.levels->whole() : cloud;
}

/// Place and weight of each disc, in an order of their own.
std::vector<std::array<float, 4>> discs_of(const qnv::Cloud& cloud) {
  std::vector<std::array<float, 4>> all;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    all.push_back({cloud.positions[i].x, cloud.positions[i].y, cloud.positions[i].z, cloud.weights[i]});
  std::sort(all.begin(), all.end());
  return all;
}

double total_of(const qnv::Cloud& cloud) {
  double total = 0;
  for (const float weight : cloud.weights) total += weight;
  return total;
}

bool tells(const vrml::Diagnostics& diagnostics, const std::string& text) {
  return std::any_of(diagnostics.entries().begin(), diagnostics.entries().end(),
                     [&](const vrml::Diagnostic& one) { return one.message.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("A stream that comes as cells is the one in the file", "[optimised]") {
  CellSite site;
  site.start();
  for (const char* name : {"packed.qnv", "records.qnv"}) {
    INFO(name);
    LoadOptions options;
    options.timeout_seconds = 120;
    const OpenedWorld world = load_world(site.url(name), options);
    REQUIRE(world.scene);
    CHECK(world.diagnostics.entries().empty());
    CHECK_FALSE(world.truncated);
    CHECK(discs_of(cloud_of_world(world)) == discs_of(cloud_of_world(load_world(site.folder.path(name)))));
  }
}

TEST_CASE("A mesh far from 0 comes as it is over HTTP and as cells") {
  CellSite site;
  site.options.http_port = 0;
  site.start();
  REQUIRE(exact_stream()[8] == 2);  // version
  const qnv::Cloud wanted = cloud_of_world(load_world(site.folder.path("exact.qnv")));
  REQUIRE(wanted.triangles.size() == 3 * (4 * 40 * 40 - 4 * 40));
  CHECK(wanted.description.origin == glm::dvec3(6e6, 2e6, -3e6));
  const std::string http = "http://127.0.0.1:" + std::to_string(*site.archive->http_port()) + "/exact.qnv";
  for (const std::string& url : {http, site.url("exact.qnv")}) {
    INFO(url);
    LoadOptions options;
    options.timeout_seconds = 120;
    const OpenedWorld world = load_world(url, options);
    REQUIRE(world.scene);
    CHECK(world.diagnostics.entries().empty());
    const qnv::Cloud cloud = cloud_of_world(world);
    CHECK(cloud.description.origin == wanted.description.origin);
    CHECK(cloud.positions == wanted.positions);
    CHECK(cloud.normals == wanted.normals);
    CHECK(cloud.triangles == wanted.triangles);
  }
}

TEST_CASE("Cells that are lost cost detail, and the rest shows whole", "[optimised]") {
  CellSite site;
  site.start();
  for (const char* name : {"packed.qnv", "records.qnv"}) {
    INFO(name);
    const qnv::Cloud whole = cloud_of_world(load_world(site.folder.path(name)));
    LoadOptions options;
    options.timeout_seconds = 120;
    options.loss = 0.3;
    const OpenedWorld world = load_world(site.url(name), options);
    REQUIRE(world.scene);
    CHECK(world.diagnostics.errors() == 0);
    const qnv::Cloud cloud = cloud_of_world(world);
    CHECK(cloud.size() > whole.size() / 20);
    // The area is that of the whole, however much is missing.
    CHECK(total_of(cloud) == Approx(total_of(whole)).epsilon(0.05));
  }
}

TEST_CASE("A QNV node takes the first of its urls that has a stream") {
  CellSite site;
  site.start();
  const std::string world_text = "#VRML V2.0 utf8\nShape { geometry QNV { url [ \"" + site.url("none.qnv") + "\" \"" +
                                 site.url("world.wrl") + "\" \"" + site.url("records.qnv") + "\" ] } }\n";
  site.folder.write("two.wrl", world_text);
  LoadOptions options;
  options.timeout_seconds = 120;
  const OpenedWorld world = load_world(site.folder.path("two.wrl"), options);
  REQUIRE(world.scene);
  CHECK(world.diagnostics.entries().empty());
  CHECK(cloud_of_world(world).size() == 30'000);
  options.offline = true;
  const OpenedWorld offline = load_world(site.folder.path("two.wrl"), options);
  CHECK(offline.clouds.empty());
  CHECK(tells(offline.diagnostics, "--offline"));
}

TEST_CASE("What cannot be had as cells is said") {
  CellSite site;
  site.start();
  const OpenedWorld none = load_world(site.url("none.qnv"));
  CHECK_FALSE(none.scene);
  CHECK(tells(none.diagnostics, "not found"));
  const OpenedWorld other = load_world(site.url("world.wrl"));
  CHECK_FALSE(other.scene);
  CHECK(tells(other.diagnostics, "no QNV stream"));
  const OpenedWorld bad = load_world("cells://127.0.0.1:99999/a.qnv");
  CHECK_FALSE(bad.scene);
  CHECK(tells(bad.diagnostics, "expected cells://HOST:PORT/PATH"));
  const std::string url = site.url("packed.qnv");
  site.archive.reset();
  LoadOptions impatient;
  impatient.timeout_seconds = 0.5;
  const OpenedWorld silent = load_world(url, impatient);
  CHECK_FALSE(silent.scene);
  CHECK(tells(silent.diagnostics, "time for loading is over"));
}

TEST_CASE("A part of a stream is asked for, and no more than that is taken") {
  CellSite site;
  site.start();
  LoadOptions options;
  options.max_bytes = 200'000;
  WorldLoading loading(site.url("packed.qnv"), options);
  while (!loading.done()) (void)loading.step(kCellWait);
  CHECK(loading.state().received <= 200'000);
  CHECK(loading.state().received > 100'000);
  const OpenedWorld world = loading.take();
  for (const auto& feed : world.feeds) (void)feed->apply();
  const std::size_t part = cloud_of_world(world).size();
  CHECK(part > 10'000);
  CHECK(part < cloud_of_world(load_world(site.folder.path("packed.qnv"))).size());
}

namespace {

/// The world that is left when the server goes in the middle, and what `then` does about it.
template <class Then>
OpenedWorld interrupted(CellSite& site, const LoadOptions& options, const Then& then) {
  WorldLoading loading(site.url("packed.qnv"), options);
  while (!loading.done() && loading.state().received < 100'000) (void)loading.step(kCellWait);
  REQUIRE_FALSE(loading.done());
  then();
  while (!loading.done()) (void)loading.step(kCellWait);
  OpenedWorld world = loading.take();
  for (const auto& feed : world.feeds) (void)feed->apply();
  return world;
}

/// A server as a program of its own, that can be killed: one whose streams take a while, and one that follows it.
class ServerProgram {
 public:
  explicit ServerProgram(const CellSite& site, const char* rate = "2000000") {
    const std::string port = std::to_string(*site.options.cells_port), folder = site.folder.path("");
    process_ = ::fork();
    if (process_ != 0) return;
    ::execl(program().c_str(), "ghostspace", "serve", "--cells", port.c_str(), "--rate", rate, folder.c_str(),
            static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ServerProgram(const ServerProgram&) = delete;
  ServerProgram& operator=(const ServerProgram&) = delete;
  ~ServerProgram() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

 private:
  pid_t process_ = -1;
};

}  // namespace

TEST_CASE("A server of cells that stops leaves what has come") {
  CellSite site;
  site.options.rate = 2'000'000;
  site.start();
  LoadOptions options;
  options.timeout_seconds = 60;
  const OpenedWorld world = interrupted(site, options, [&] { site.archive.reset(); });
  CHECK(tells(world.diagnostics, "the server stops"));
  REQUIRE(world.scene);
  CHECK(world.truncated);
  CHECK(cloud_of_world(world).size() > 1000);
}

TEST_CASE("A server of cells that is killed is asked again, and one with another file is told apart") {
  CellSite site;
  site.start();
  site.archive.reset();  // the port is free
  auto server = std::make_unique<ServerProgram>(site);
  LoadOptions options;
  options.timeout_seconds = 120;
  SECTION("the same file: what is there stays") {
    const OpenedWorld world = interrupted(site, options, [&] {
      server.reset();
      server = std::make_unique<ServerProgram>(site, "20000000");
    });
    CHECK(world.diagnostics.errors() == 0);
    CHECK(cloud_of_world(world).size() > 500'000);
  }
  SECTION("another one") {
    const OpenedWorld world = interrupted(site, options, [&] {
      server.reset();
      site.folder.write("packed.qnv", large_stream().substr(0, large_stream().size() / 2));
      server = std::make_unique<ServerProgram>(site);
    });
    CHECK(tells(world.diagnostics, "changed on the server"));
    REQUIRE(world.scene);
    CHECK(world.truncated);
    CHECK(cloud_of_world(world).size() > 1000);
  }
}

TEST_CASE("In a window the base shows at once, and views say what comes next") {
  CellSite site;
  site.options.rate = 4'000'000;
  site.start();
  LoadOptions options;
  options.by_view = true;
  options.timeout_seconds = 120;
  WorldLoading loading(site.url("packed.qnv"), options);
  while (!loading.done()) (void)loading.step(kCellWait);
  CHECK(loading.streaming());
  CHECK(loading.state().received < 200'000);
  const OpenedWorld world = loading.take();
  REQUIRE(world.feeds.size() == 1);
  StreamFeed& feed = *world.feeds.front();
  (void)feed.apply();
  auto& levels = *world.clouds.begin()->second->levels;
  REQUIRE(levels.clusters() > 0);
  // What lies to the right, closely.
  qnv::LodView view;
  view.eye = {3, 0, 0};
  view.pixels = 1e5f;
  view.planes[0] = {1, 0, 0, -0.8f};
  (void)levels.cut(view);
  feed.ask();
  const auto discs = [&levels](const qnv::LodView& from) {
    std::size_t sum = 0;
    for (const qnv::Piece& piece : levels.cut(from)) sum += piece.count;
    return sum;
  };
  qnv::LodView opposite = view;
  opposite.eye = {-3, 0, 0};
  opposite.planes[0] = {-1, 0, 0, -0.8f};
  opposite.viewport = 1;
  const std::size_t before = discs(view);
  bool preferred = false;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(100);
  while (!preferred && std::chrono::steady_clock::now() < deadline) {
    (void)loading.step(kCellWait);
    if (feed.apply()) preferred = discs(view) > 4 * before && discs(view) > 2 * discs(opposite);
  }
  CHECK(preferred);
  // Beside a stream of more weight it wants less of the rate.
  feed.set_weight(0.25);
  while (loading.cells().granted > 1'100'000 && std::chrono::steady_clock::now() < deadline)
    (void)loading.step(kCellWait);
  CHECK(loading.cells().granted <= 1'100'000);
  feed.set_weight(1);
  // When all of it is there nobody goes on asking.
  while (loading.streaming() && std::chrono::steady_clock::now() < deadline) {
    (void)loading.step(kCellWait);
    (void)feed.apply();
  }
  CHECK_FALSE(loading.streaming());
  CHECK(levels.count() == cloud_of_world(load_world(site.folder.path("packed.qnv"))).size());
}

TEST_CASE("Regions are what views see of a stream") {
  const qnv::Box all{{-1, -1, -1}, {1, 1, 1}};
  std::array<qnv::LodView, 3> views;
  CHECK(regions_of({}, all).empty());
  CHECK(regions_of(views, all).empty());  // all of it
  // The upper quarter of x, from both sides of a thin slice of y.
  views[1].planes = {{{1, 0, 0, -0.5f}, {0, 1, 0, 0.1f}, {0, -1, 0, 0.1f}}};
  views[2].planes[0] = {0, 0, 1, -5};  // nothing
  const auto regions = regions_of(views, all);
  REQUIRE(regions.size() == 1);
  const auto part = [](std::uint16_t value) { return 2.0 * value / 65535 - 1; };
  const net::CellBox& box = regions[0].box;
  CHECK(part(box[0]) <= 0.5);
  CHECK(part(box[0]) > 0.5 - 0.5 / 7);  // of seven parts at least six are seen
  CHECK(part(box[3]) == Approx(1).margin(0.001));
  CHECK(part(box[1]) <= -0.1);
  CHECK(part(box[1]) > -0.1 - 0.2 / 6);
  CHECK(part(box[4]) >= 0.1);
  CHECK(part(box[4]) < 0.1 + 0.2 / 6);
  CHECK(box[2] == 0);
  CHECK(box[5] == 65535);
  // Views that see the same are one region, and there are never too many.
  std::vector<qnv::LodView> many(20, views[1]);
  CHECK(regions_of(many, all).size() == 1);
  for (std::size_t i = 0; i < many.size(); ++i) many[i].planes[0].w = -0.5f - 0.02f * static_cast<float>(i);
  CHECK(regions_of(many, all).size() == net::kMostRegions);
  // A flat thing, and numbers that make no sense.
  const qnv::Box flat{{0, 0, 0}, {1, 0, 1}};
  CHECK(regions_of(std::span(views).subspan(1, 1), flat).size() == 1);
  views[1].planes[0] = glm::vec4(std::numeric_limits<float>::quiet_NaN());
  CHECK(regions_of(views, all).size() <= 1);
}
