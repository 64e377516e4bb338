#include "net/cells/cell_driver.h"
#include "tests/net/cell_scene.h"
#include "tests/net/resident_memory.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <thread>

namespace {

using namespace gs::net;
using gs::net::test::resident;
using namespace std::chrono_literals;

Instant clock_now() { return std::chrono::duration_cast<Instant>(std::chrono::steady_clock::now().time_since_epoch()); }

struct Client {
  CellClient client;
  UdpSocket socket;
  std::uint64_t bytes = 0;
  bool base = false, ended = false, failed = false;
};

/// Runs one turn of a client. Reports whether it received something.
bool turn(Client& at, const Endpoint& server) {
  bool any = false;
  Endpoint from;
  while (const auto bytes = at.socket.receive(from)) {
    at.client.receive(*bytes, clock_now());
    any = true;
  }
  while (const auto bytes = at.client.next(clock_now())) (void)at.socket.send(server, *bytes);
  for (const CellEvent& event : at.client.take_events()) {
    at.bytes += event.kind == CellEvent::Kind::piece ? event.bytes.size() : 0;
    at.base = at.base || event.kind == CellEvent::Kind::base;
    at.ended = at.ended || event.kind == CellEvent::Kind::ended;
    at.failed = at.failed || event.kind == CellEvent::Kind::failed || event.kind == CellEvent::Kind::refused;
  }
  return any;
}

std::vector<std::unique_ptr<Client>> make_clients(std::size_t count) {
  std::vector<std::unique_ptr<Client>> clients;
  for (std::size_t i = 0; i < count; ++i) {
    CellClientOptions options;
    options.nonce = 5000 + i;
    options.rate = 50'000'000;
    options.most_tries = 100;
    auto socket = UdpSocket::open(0, true);
    REQUIRE(std::holds_alternative<UdpSocket>(socket));
    clients.push_back(std::make_unique<Client>(
        Client{CellClient(options), std::move(std::get<UdpSocket>(socket)), 0, false, false, false}));
    CellWish wish;
    wish.path = "a";
    clients.back()->client.want(0, wish, clock_now());
  }
  return clients;
}

// Limits per client. The server holds the symbols of the client's groups (ParitySender::kMaxHeld and one group), the
// current chunk, and a bit per chunk. It holds no data before they are due. The client holds its data for rebuilding
// (CellRebuilder::kMaxKept and kMaxParity) and its events, which the test takes immediately.
TEST_CASE("serves two hundred clients on loopback evenly, in bounded memory", "[cell_driver][optimised]") {
  constexpr std::size_t kClients = 200, kEach = 60'000;
  const auto source = std::make_shared<PatternSource>(3000, std::vector<PatternSource::Stream>{{true, 100, 8000}});
  auto library = std::make_shared<PatternLibrary>();
  library->sources["a"] = source;
  CellServerOptions options;
  options.total_rate = 40'000'000;
  options.most_of_address = kClients + 1;
  auto started = CellServerDriver::start(options, library, 0, true);
  REQUIRE(std::holds_alternative<std::unique_ptr<CellServerDriver>>(started));
  const auto& server = std::get<std::unique_ptr<CellServerDriver>>(started);
  const auto found = find_host("127.0.0.1", server->port());
  REQUIRE(std::holds_alternative<Endpoint>(found));
  const std::size_t before = resident();
  const auto clients = make_clients(kClients);
  std::size_t most_memory = before;
  std::uint64_t total = 0;
  bool failed = false;
  const auto end = std::chrono::steady_clock::now() + 120s;
  while (total < kClients * kEach && !failed && std::chrono::steady_clock::now() < end) {
    bool any = false;
    total = 0;
    for (const auto& client : clients) {
      any = turn(*client, std::get<Endpoint>(found)) || any;
      total += client->bytes;
      failed = failed || client->failed;
    }
    most_memory = std::max(most_memory, resident());
    if (!any) std::this_thread::sleep_for(1ms);
  }
  REQUIRE_FALSE(failed);
  REQUIRE(total >= kClients * kEach);
  double squares = 0;
  std::uint64_t least = ~std::uint64_t{0}, most = 0, lost = 0;
  for (const auto& client : clients) {
    CHECK(client->base);
    CHECK_FALSE(client->ended);
    squares += static_cast<double>(client->bytes) * static_cast<double>(client->bytes);
    least = std::min(least, client->bytes);
    most = std::max(most, client->bytes);
    lost += client->client.statistics().lost;
  }
  const double evenness = static_cast<double>(total) * static_cast<double>(total) / (kClients * squares);
  const CellServerStatistics statistics = server->statistics();
  INFO("least " << least << ", most " << most << ", evenness " << evenness << ", lost " << lost << " of "
                << statistics.datagrams << ", memory " << (most_memory - before));
  CHECK(evenness > 0.9);  // Jain's index: 1 is even
  CHECK(most <= 3 * least);
  CHECK(statistics.clients == kClients);
  CHECK(statistics.accepted == kClients);
  CHECK(statistics.refused == 0);
  // Memory of server and clients together.
  if (!gs::watched()) CHECK(most_memory - before < kClients * std::size_t{400'000});
}

}  // namespace
