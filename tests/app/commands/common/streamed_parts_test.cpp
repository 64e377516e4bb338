#include "app/commands/common/streamed_parts.h"

#include "app/loading/world_loader.h"
#include "app/streams/stream_feed.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/large_stream.h"
#include "tests/app/worlds.h"
#include "tests/geometries.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace gs::app {
namespace streamed_parts_test {

LoadOptions options_for(const std::shared_ptr<net::MemoryNetwork>& network) {
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{network};
  options.timeout_seconds = 60;
  options.large_by_view = true;
  return options;
}

TEST_CASE("pictures of long streams receive only the parts that they show") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  net::MemoryResource resource;
  const auto bytes = std::as_bytes(std::span(large_stream()));
  resource.bytes.assign(bytes.begin(), bytes.end());
  resource.validator.etag = "\"1\"";
  network->put("memory://a/ball.qnv", std::move(resource));
  WorldLoading loading("memory://a/ball.qnv", options_for(network));
  const LoadedWorld world = load_world(loading, "memory://a/ball.qnv");
  REQUIRE(world.feeds.size() == 1);
  CHECK(loading.streaming());
  qnv::LodStream& stream = *content_of<qnv::OctreeSplats>(*world.geometries.begin()->second).stream;
  qnv::LodView view;
  view.eye = {0, 0, 4};
  view.pixels = 500;
  view.error_pixels = 4;
  int draws = 0;
  receive_for_picture(loading, world, 60, [&] {
    (void)stream.cut(view);
    ++draws;
  });
  CHECK(stream.complete());
  CHECK(draws > 1);
  CHECK(draws < 20);
  std::uint64_t asked = 0;
  for (const net::TransferRequest& transfer : network->transfers()) {
    REQUIRE(transfer.range);
    asked += std::min<std::uint64_t>(transfer.range->end, large_stream().size()) - transfer.range->begin;
  }
  CHECK(asked < large_stream().size() * 3 / 4);
  // There is nothing more to receive.
  const int before = draws;
  receive_for_picture(loading, world, 60, [&] {
    (void)stream.cut(view);
    ++draws;
  });
  CHECK(draws == before + 1);
}

}  // namespace streamed_parts_test
}  // namespace gs::app
