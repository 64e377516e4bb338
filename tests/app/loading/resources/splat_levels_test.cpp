#include "app/loading/resources/splat_levels.h"

#include "app/commands/common/streamed_parts.h"
#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "tests/app/streamed_sog.h"
#include "tests/net/memory_network.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace gs::app::splat_levels_test {
namespace {

/// A cloud of splats around (x, 0, 0).
qnv::Gaussians cloud_at(float x, std::size_t count) {
  qnv::Gaussians splats = test::splat_cloud(count);
  for (glm::vec3& position : splats.positions) position.x += x;
  for (float& opacity : splats.opacities) opacity = std::max(opacity, 0.1f);
  splats.description.box = {};
  for (const glm::vec3& position : splats.positions) splats.description.box.add(position);
  return splats;
}

/// Two parts at x = 0 and x = 100, with levels of 4000, 1000 and 100 splats.
test::SogFiles two_parts() {
  std::vector<test::SogPart> parts;
  for (const float x : {0.0f, 100.0f})
    parts.push_back({Box({x - 2, -1, -1}, {x + 2, 1, 1}), {cloud_at(x, 4000), cloud_at(x, 1000), cloud_at(x, 100)}});
  return test::streamed_sog(parts);
}

std::shared_ptr<net::MemoryNetwork> network_of(const test::SogFiles& files) {
  const auto network = std::make_shared<net::MemoryNetwork>();
  for (const auto& [path, bytes] : files) {
    net::MemoryResource resource;
    resource.bytes = bytes;
    network->put("memory://a/s/" + path, std::move(resource));
  }
  return network;
}

LoadOptions options_for(const std::shared_ptr<net::MemoryNetwork>& network) {
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{network};
  options.timeout_seconds = 60;
  options.large_by_view = true;
  return options;
}

/// A view along -z of the part at x.
qnv::LodView view_at(float x) {
  qnv::LodView view;
  view.eye = {x, 0, 5};
  view.pixels = 1000;
  view.planes = {{{1, 0, -1, 5 - x}, {-1, 0, -1, 5 + x}, {0, 1, -1, 5}, {0, -1, -1, 5}, {0, 0, -1, 4.9f}}};
  return view;
}

const qnv::Gaussians& splats_of(const LoadedWorld& world) {
  return *world.geometries.begin()->second->as<qnv::Gaussians>();
}

std::size_t near_x(const qnv::Gaussians& splats, double x) {
  return static_cast<std::size_t>(std::ranges::count_if(splats.positions, [&](const glm::vec3& position) {
    return std::abs(splats.description.origin.x + static_cast<double>(position.x) - x) < 3;
  }));
}

bool has_asked(const net::MemoryNetwork& network, const std::string& part) {
  return std::ranges::any_of(network.transfers(), [&](const net::TransferRequest& transfer) {
    return transfer.url.find("/" + part + "/") != std::string::npos;
  });
}

void receive(WorldLoading& loading, LoadedWorld& world, const qnv::LodView& view) {
  receive_for_picture(
      loading, world, 60,
      [&] {
        qnv::LodView here = view;
        here.eye -= glm::vec3(splats_of(world).description.origin);
        splats_of(world).requests->note(here);
      },
      [&](ResourceUpdates updates) { (void)take_in(world, std::move(updates)); });
}

}  // namespace

TEST_CASE("receives coarse levels of streamed SOG first, then finer ones of the parts in view") {
  const auto network = network_of(two_parts());
  WorldLoading loading("memory://a/s/lod-meta.json", options_for(network));
  LoadedWorld world = load_world(loading, "memory://a/s/lod-meta.json");
  REQUIRE(world.geometries.size() == 1);
  CHECK(world.diagnostics.entries().empty());
  CHECK(splats_of(world).size() == 100);  // one part, in its coarsest level
  CHECK(loading.streaming());
  CHECK_FALSE(has_asked(*network, "0_0"));
  receive(loading, world, view_at(0));
  CHECK(near_x(splats_of(world), 0) == 4000);
  CHECK(near_x(splats_of(world), 100) == 100);
  CHECK(has_asked(*network, "0_0"));
  CHECK_FALSE(has_asked(*network, "0_1"));
  CHECK_FALSE(has_asked(*network, "1_0"));  // a picture needs no level between
  // Another view gets the other part. The first part stays, because memory suffices.
  receive(loading, world, view_at(100));
  CHECK(near_x(splats_of(world), 100) == 4000);
  CHECK(near_x(splats_of(world), 0) == 4000);
  CHECK_FALSE(has_asked(*network, "1_1"));
}

TEST_CASE("makes the same picture of streamed SOG each time") {
  std::vector<glm::vec3> first;
  for (int run = 0; run < 2; ++run) {
    const auto network = network_of(two_parts());
    WorldLoading loading("memory://a/s/lod-meta.json", options_for(network));
    LoadedWorld world = load_world(loading, "memory://a/s/lod-meta.json");
    receive(loading, world, view_at(0));
    if (run == 0) first = splats_of(world).positions;
    CHECK(splats_of(world).positions == first);
  }
}

TEST_CASE("cancels files of streamed SOG that no view wants any more") {
  const test::SogFiles files = two_parts();
  const auto network = network_of(files);
  for (const auto& [path, bytes] : files) {
    if (!path.starts_with("0_0/")) continue;
    network->put("memory://a/s/" + path, [bytes](const net::TransferRequest& request, unsigned) {
      net::MemoryResource resource;
      resource.bytes = bytes;
      net::MemoryAnswer answer = net::answer_well(resource, request);
      answer.latency = net::Milliseconds(600'000);  // never within this test
      return answer;
    });
  }
  LoadOptions options = options_for(network);
  WorldLoading loading("memory://a/s/lod-meta.json", options);
  LoadedWorld world = load_world(loading, "memory://a/s/lod-meta.json");
  REQUIRE(world.feeds.size() == 1);
  const auto note = [&](float x) {
    splats_of(world).requests->note(view_at(x));
    world.feeds[0]->ask();
  };
  note(0);
  for (int i = 0; i < 1000 && !has_asked(*network, "0_0"); ++i) (void)loading.step(std::chrono::milliseconds(10));
  REQUIRE(has_asked(*network, "0_0"));
  CHECK_FALSE(loading.streams_rest());
  receive(loading, world, view_at(100));
  CHECK(loading.streams_rest());
  CHECK(near_x(splats_of(world), 100) == 4000);
  CHECK(near_x(splats_of(world), 0) == 100);
}

TEST_CASE("shows another level of streamed SOG if a server lacks a file") {
  test::SogFiles files = two_parts();
  files.erase("0_0/quats.webp");
  files.erase("2_1/meta.json");
  const auto network = network_of(files);
  WorldLoading loading("memory://a/s/lod-meta.json", options_for(network));
  LoadedWorld world = load_world(loading, "memory://a/s/lod-meta.json");
  REQUIRE(world.geometries.size() == 1);
  receive(loading, world, view_at(0));
  CHECK(near_x(splats_of(world), 0) == 1000);
  CHECK(near_x(splats_of(world), 100) == 1000);  // its coarsest level is missing
  CHECK(world.diagnostics.warnings() == 2);
  CHECK(world.diagnostics.errors() == 0);
}

TEST_CASE("refuses streamed SOG without any readable file") {
  test::SogFiles files = two_parts();
  std::erase_if(files, [](const auto& file) { return file.first != "lod-meta.json"; });
  const auto network = network_of(files);
  WorldLoading loading("memory://a/s/lod-meta.json", options_for(network));
  const LoadedWorld world = load_world(loading, "memory://a/s/lod-meta.json");
  CHECK(world.geometries.empty());
  CHECK(world.diagnostics.errors() > 0);
  CHECK_FALSE(loading.streaming());
}

TEST_CASE("reads levels of streamed SOG by view in a window, through levels between") {
  const auto network = network_of(two_parts());
  LoadOptions options = options_for(network);
  options.large_by_view = false;
  options.by_view = true;
  WorldLoading loading("memory://a/s/lod-meta.json", options);
  LoadedWorld world = load_world(loading, "memory://a/s/lod-meta.json");
  receive(loading, world, view_at(0));
  CHECK(near_x(splats_of(world), 0) == 4000);
  CHECK(has_asked(*network, "1_0"));
  CHECK_FALSE(has_asked(*network, "1_1"));
}

}  // namespace gs::app::splat_levels_test
