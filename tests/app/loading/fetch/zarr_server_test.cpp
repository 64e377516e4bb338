#include "app/loading/world_loader.h"
#include "tests/app/worlds.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace gs::app {
namespace zarr_server_test {
namespace {

net::MemoryResource resource_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  net::MemoryResource resource;
  resource.bytes.assign(bytes.begin(), bytes.end());
  return resource;
}

/// Image of 16 voxels per axis with a bright corner, at memory://a/image.zarr.
std::shared_ptr<net::MemoryNetwork> image_network() {
  auto network = std::make_shared<net::MemoryNetwork>();
  const std::string folder = "memory://a/image.zarr/";
  network->put(folder + ".zgroup", resource_of(R"({"zarr_format": 2})"));
  network->put(folder + ".zattrs", resource_of(R"({"multiscales": [{"version": "0.4",
    "axes": [{"name": "z", "type": "space"}, {"name": "y", "type": "space"}, {"name": "x", "type": "space"}],
    "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 1]}]}]}]})"));
  network->put(folder + "0/.zarray", resource_of(R"({"zarr_format": 2, "shape": [16, 16, 16], "chunks": [16, 16, 16],
    "dtype": "|u1", "compressor": null, "fill_value": 0, "order": "C", "filters": null})"));
  std::string voxels;
  for (std::size_t i = 0; i < std::size_t{16} * 16 * 16; ++i)
    voxels += static_cast<char>(i % 16 > 7 && i / 16 % 16 > 7 && i / 256 > 7 ? 100 : 2);
  network->put(folder + "0/0.0.0", resource_of(voxels));
  return network;
}

LoadedWorld load_image(const std::shared_ptr<net::MemoryNetwork>& network) {
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{network};
  options.timeout_seconds = 60;
  options.by_view = true;
  return load_world("memory://a/image.zarr", options);
}

}  // namespace

TEST_CASE("an image of Zarr on a server needs no file twice, and its metadata at once") {
  const auto network = image_network();
  const LoadedWorld world = load_image(network);
  CHECK(world.diagnostics.entries().empty());
  CHECK(world.geometries.size() == 1);
  std::set<std::string> urls;
  for (const net::TransferRequest& transfer : network->transfers()) {
    INFO(transfer.url);
    CHECK(urls.insert(transfer.url).second);
  }
  CHECK(urls.size() <= 9);
  CHECK(urls.contains("memory://a/image.zarr/0/0.0.0"));
}

TEST_CASE("a missing image of Zarr on a server gives one message") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  const LoadedWorld world = load_image(network);
  CHECK(world.geometries.empty());
  REQUIRE(world.diagnostics.entries().size() == 1);
  CHECK_THAT(world.diagnostics.entries().front().text(), Catch::Contains("404"));
}

}  // namespace zarr_server_test
}  // namespace gs::app
