#include "net/cells/cell_driver.h"

#include "tests/net/cell_scene.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <thread>

namespace {

using namespace gs::net;
using namespace std::chrono_literals;

std::unique_ptr<CellServerDriver> start_server(const std::shared_ptr<CellLibrary>& library) {
  CellServerOptions options;
  options.total_rate = options.client_rate = 200'000'000;
  options.most_of_address = 64;
  auto started = CellServerDriver::start(options, library, 0, true);
  REQUIRE(std::holds_alternative<std::unique_ptr<CellServerDriver>>(started));
  return std::move(std::get<std::unique_ptr<CellServerDriver>>(started));
}

std::unique_ptr<CellClientDriver> start_client(std::uint16_t port, std::function<void()> wake = {}) {
  CellClientOptions options;
  options.rate = 100'000'000;
  auto started = CellClientDriver::start(options, "127.0.0.1", port, std::move(wake));
  REQUIRE(std::holds_alternative<std::unique_ptr<CellClientDriver>>(started));
  return std::move(std::get<std::unique_ptr<CellClientDriver>>(started));
}

/// Polls until `done` returns true, or for half a minute.
template <class Done>
void poll_until(CellClientDriver& client, ReceivedCells& got, const CellSource& source, Done done) {
  const auto end = std::chrono::steady_clock::now() + 30s;
  while (!done() && std::chrono::steady_clock::now() < end) {
    got.take(client.poll(100'000), source, Instant(0));
    std::this_thread::sleep_for(1ms);
  }
}

TEST_CASE("sends cells over sockets", "[cell_driver]") {
  const auto source = std::make_shared<PatternSource>(15000, Streams{{true, 60, 8000}, {false, 60, 1200}});
  auto library = std::make_shared<PatternLibrary>();
  library->sources["a"] = source;
  const auto server = start_server(library);
  std::atomic<int> woken = 0;
  const auto client = start_client(server->port(), [&] { ++woken; });
  CellWish wish;
  wish.path = "a";
  wish.repair = true;
  client->want(0, wish);
  client->prefer(0, {}, {{1, 3}});
  ReceivedCells got;
  poll_until(*client, got, *source, [&] { return got.base && got.bytes >= source->total(); });
  REQUIRE(got.ok);
  REQUIRE(got.base);
  REQUIRE(got.bytes == source->total());
  REQUIRE(woken > 0);
  REQUIRE(server->statistics().accepted == 1);
}

TEST_CASE("notifies its clients when the server ends", "[cell_driver]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{true, 100'000, 8000}});
  auto library = std::make_shared<PatternLibrary>();
  library->sources["a"] = source;
  auto server = start_server(library);
  const auto client = start_client(server->port());
  CellWish wish;
  wish.path = "a";
  client->want(0, wish);
  ReceivedCells got;
  poll_until(*client, got, *source, [&] { return got.base; });
  server.reset();
  poll_until(*client, got, *source, [&] { return got.failed; });
  REQUIRE(got.failed);
  REQUIRE(got.text.find("the server is stopping") != std::string::npos);
}

TEST_CASE("ends a client at once that has no answer or no host", "[cell_driver]") {
  {
    const auto client = start_client(9);
    CellWish wish;
    wish.path = "a";
    client->want(0, wish);
  }
  auto started = CellClientDriver::start({}, "no.such.host.invalid", 1, {});
  const auto& client = std::get<std::unique_ptr<CellClientDriver>>(started);
  const PatternSource source(1, Streams{{true, 1, 8}});
  ReceivedCells got;
  poll_until(*client, got, source, [&] { return got.failed; });
  REQUIRE(got.text.find("cannot find the host") == 0);
}

}  // namespace
