#include "net/cells/cell_sender.h"

#include "tests/net/cell_scene.h"

#include <catch2/catch.hpp>

#include <array>
#include <set>

namespace {

using namespace gs::net;
using namespace std::chrono_literals;

/// Scene with one client, which wants the source.
struct StartedScene : Scene {
  explicit StartedScene(const std::shared_ptr<PatternSource>& source, const CellWish& wanted = wish())
      : Scene(server_options(), library(source)) {
    add({}, source);
    clients[0]->client.want(0, wanted, now);
  }
};

TEST_CASE("sends no more than it received before the cookie returns", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{true, 10, 8000}});
  CellServer server(server_options(), library(source));
  std::uint64_t random = 1, received = 0, sent = 0;
  Instant now{1'000'000};
  const auto put = [&](const std::vector<std::byte>& bytes) {
    Endpoint from;
    from.address[0] = static_cast<std::uint8_t>(Link::next_random(random));
    received += bytes.size();
    server.receive(from, bytes, now += 1ms);
    while (const auto out = server.next(now)) sent += out->bytes.size();
    REQUIRE(sent <= received);
  };
  for (std::uint64_t i = 0; i < 200; ++i) {
    put(encode_contract(HelloMessage{i}));
    RequestMessage request;
    request.cookie = {i, 5, Link::next_random(random)};  // a guessed tag
    request.number = 1;
    request.path = "a";
    request.rate = 1'000'000'000;
    put(encode_contract(request));
    ReportMessage report;
    report.session = Link::next_random(random);
    put(encode_contract(report));
    put(encode_contract(ByeMessage{i, ""}));
    auto shorter = encode_contract(HelloMessage{i});
    shorter.resize(40);
    const std::uint64_t before = sent;
    put(shorter);
    REQUIRE(sent == before);
  }
  REQUIRE(server.statistics().clients == 0);
  now += 100s;
  REQUIRE_FALSE(server.next(now));
  REQUIRE(source->read() == 0);
}

TEST_CASE("limits each client to its grant, and all clients to the total", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(5000, Streams{{true, 2000, 8000}});
  CellServerOptions options = server_options();
  options.total_rate = 20'000'000;
  options.client_rate = 8'000'000;
  Scene scene(options, library(source));
  Link::Options link;
  link.latency = 10ms;
  // The first client requests little, the others the maximum.
  const std::uint64_t wanted[] = {2'000'000, 50'000'000, 50'000'000, 50'000'000};
  for (const std::uint64_t rate : wanted) scene.add(link, source, rate);
  for (auto& client : scene.clients) client->client.want(0, wish(), scene.now);
  scene.run(scene.now + 1s);
  std::vector<std::uint64_t> before;
  for (auto& client : scene.clients) before.push_back(client->down.sent_bytes());
  scene.run(scene.now + 4s);
  const double shares[] = {2e6, 6e6, 6e6, 6e6};  // max-min fair
  for (std::size_t i = 0; i < 4; ++i) {
    const double rate = static_cast<double>(scene.clients[i]->down.sent_bytes() - before[i]) * 8 / 4;
    REQUIRE(rate < shares[i] * 1.02);
    REQUIRE(rate > shares[i] * 0.9);
    REQUIRE(scene.clients[i]->got.ok);
  }
}

TEST_CASE("serves two hundred clients evenly", "[cell_sender][optimised]") {
  const auto source = std::make_shared<PatternSource>(3000, Streams{{true, 300, 8000}});
  CellServerOptions options = server_options(CongestionResponse::equation);
  options.total_rate = 40'000'000;
  Scene scene(options, library(source));
  Link::Options link;
  link.latency = 10ms;
  for (int i = 0; i < 200; ++i) scene.add(link, source, 50'000'000);
  for (auto& client : scene.clients) client->client.want(0, wish(), scene.now);
  scene.run(scene.now + 3s);
  std::uint64_t least = ~std::uint64_t{0}, most = 0;
  for (auto& client : scene.clients) {
    REQUIRE(client->got.base);
    REQUIRE(client->got.ok);
    least = std::min(least, client->got.bytes);
    most = std::max(most, client->got.bytes);
  }
  REQUIRE(static_cast<double>(most) < 1.1 * static_cast<double>(least));
  REQUIRE(scene.server.statistics().clients == 200);
}

TEST_CASE("reports that the server is full", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(100, Streams{{true, 1, 80}});
  CellServerOptions options = server_options();
  options.most_clients = 1;
  Scene scene(options, library(source));
  for (int i = 0; i < 2; ++i) scene.add({}, source);
  scene.clients[0]->client.want(0, wish(), scene.now);
  scene.run(scene.now + 1s);
  scene.clients[1]->client.want(0, wish(), scene.now);
  scene.run(scene.now + 1s);
  REQUIRE(scene.clients[0]->got.base);
  REQUIRE(scene.clients[1]->got.refused);
  REQUIRE(scene.clients[1]->got.text.find("maximum number of clients") != std::string::npos);
  scene.clients[0]->client.bye(scene.now);
  scene.run(scene.now + 1s);
  REQUIRE(scene.server.statistics().clients == 0);
}

TEST_CASE("stops sending two seconds after the last report", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{true, 100'000, 8000}});
  StartedScene scene(source);
  scene.run(scene.now + 2s);
  Link::Options cut;
  cut.cut = true;
  scene.clients[0]->up.set(cut);
  scene.run(scene.now + 2100ms);
  const std::uint64_t sent = scene.clients[0]->down.sent();
  REQUIRE(sent > 100);
  scene.run(scene.now + 5s);
  REQUIRE(scene.clients[0]->down.sent() == sent);
  // After 30 s the server forgets the client.
  scene.run(scene.now + 40s);
  REQUIRE(scene.server.deadline(scene.now) == Instant::max());
  REQUIRE(scene.server.statistics().clients == 0);
}

TEST_CASE("sends regions and wishes first", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{true, 1000, 4000}, {false, 1000, 900}});
  Scene scene(server_options(), library(source));
  Link::Options link;
  link.latency = 20ms;
  scene.add(link, source, 4'000'000);
  CellClient& client = scene.clients[0]->client;
  client.want(0, wish(), scene.now);
  // Chunks 500 to 519 of each stream are in this region, followed by those of the second region.
  const auto at = [](std::uint32_t chunk) { return static_cast<std::uint16_t>(chunk * 65); };
  client.prefer(0,
                {{{at(700), 0, 0, static_cast<std::uint16_t>(at(710) - 1), 9, 9}, 1},
                 {{at(500), 0, 0, static_cast<std::uint16_t>(at(520) - 1), 9, 9}, 5}},
                {{1, 999}});
  scene.run(scene.now + 3s);
  const auto& order = scene.clients[0]->got.order;
  REQUIRE(order.size() > 80);
  const auto place = [&](ChunkName name) { return std::find(order.begin(), order.end(), name) - order.begin(); };
  // A few chunks were in flight before the first report.
  REQUIRE(place({1, 999}) < 15);
  for (std::uint32_t i = 0; i < 20; ++i) {
    REQUIRE(place({0, 500 + i}) < 40);
    REQUIRE(place({1, 500 + i}) < 70);
    REQUIRE(place({0, 500 + i}) < place({0, 700}));
  }
  REQUIRE(place({0, 705}) < place({0, 100}));
  REQUIRE(scene.clients[0]->got.ok);
}

TEST_CASE("sends only wishes after a request for no streams, and lost or forgotten ones again", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{false, 1000, 900}, {false, 3000, 900}});
  Scene scene(server_options(), library(source));
  Link::Options link;
  link.latency = 20ms;
  link.loss = 0.2;
  scene.add(link, source, 20'000'000);
  CellClient& client = scene.clients[0]->client;
  CellWish none = wish();
  none.streams = 0;
  client.want(0, none, scene.now);
  scene.run(scene.now + 1s);
  const ReceivedCells& got = scene.clients[0]->got;
  REQUIRE(got.base);
  REQUIRE(got.pieces == 0);
  // Two runs longer than one wish, far more than a report can name, and names of no chunk.
  std::vector<ChunkName> names{{1, 3000}, {7, 0}};
  for (std::uint32_t i = 0; i < 2500; ++i) names.push_back({1, 100 + i});
  for (std::uint32_t i = 0; i < 50; ++i) names.push_back({0, 10 * i});
  client.prefer(0, {}, names);
  scene.run(scene.now + 8s);
  REQUIRE(got.ok);
  REQUIRE(got.pieces == 2550);
  REQUIRE(got.chunk_bytes.size() == 2550);
  // Nothing more is sent, except for forgotten chunks that are wanted again.
  const std::array<ChunkName, 2> forgotten{ChunkName{1, 100}, ChunkName{0, 10}};
  client.forget(0, forgotten);
  scene.run(scene.now + 2s);
  REQUIRE(got.pieces == 2550);
  client.prefer(0, {}, {forgotten[1]});
  scene.run(scene.now + 2s);
  REQUIRE(got.pieces == 2551);
}

TEST_CASE("shares the rate between slots by weight", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(100, Streams{{true, 5000, 8000}});
  Scene scene(server_options(), library(source));
  scene.add({}, source, 8'000'000);
  CellWish heavy = wish(), light = wish();
  heavy.weight = 3;
  scene.clients[0]->client.want(0, heavy, scene.now);
  scene.clients[0]->client.want(5, light, scene.now);
  scene.run(scene.now + 4s);
  auto& bytes = scene.clients[0]->got.slot_bytes;
  const double ratio = static_cast<double>(bytes[0]) / static_cast<double>(bytes[5]);
  REQUIRE(ratio > 2.8);
  REQUIRE(ratio < 3.2);
  // After one slot is cleared, the other gets the whole rate.
  scene.clients[0]->client.want(0, {}, scene.now);
  scene.run(scene.now + 500ms);
  const auto first = bytes[0], second = bytes[5];
  scene.run(scene.now + 2s);
  REQUIRE(bytes[0] == first);
  REQUIRE(static_cast<double>(bytes[5] - second) * 8 / 2 > 5e6);
}

TEST_CASE("ends a stream at its budget, and continues with a larger one", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(100, Streams{{true, 100, 8000}, {false, 50, 1000}});
  Scene scene(server_options(), library(source));
  scene.add({}, source);
  CellWish asked = wish();
  asked.budget = 100'000;
  scene.clients[0]->client.want(0, asked, scene.now);
  scene.run(scene.now + 3s);
  ReceivedCells& got = scene.clients[0]->got;
  REQUIRE(got.ended);
  REQUIRE(got.bytes >= 100'000);
  REQUIRE(got.bytes <= 108'000);
  asked.budget = 0;
  asked.streams = 2;
  scene.clients[0]->client.want(0, asked, scene.now);
  scene.run(scene.now + 3s);
  REQUIRE(got.slot_bytes[0] >= 150'000);
  REQUIRE(got.slot_bytes[0] <= 158'000);  // no chunk is sent twice
  REQUIRE(got.ok);
}

TEST_CASE("refuses an unknown path with a message", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(100, Streams{{true, 1, 80}});
  StartedScene scene(source, wish("b"));
  scene.run(scene.now + 1s);
  REQUIRE(scene.clients[0]->got.refused);
  REQUIRE(scene.clients[0]->got.text == "there is no b");
}

TEST_CASE("says goodbye when the server stops", "[cell_sender]") {
  const auto source = std::make_shared<PatternSource>(100, Streams{{true, 100'000, 8000}});
  StartedScene scene(source);
  scene.run(scene.now + 1s);
  scene.server.stop();
  scene.run(scene.now + 1s);
  REQUIRE(scene.clients[0]->got.failed);
  REQUIRE(scene.clients[0]->got.text.find("the server is stopping") != std::string::npos);
}

}  // namespace
