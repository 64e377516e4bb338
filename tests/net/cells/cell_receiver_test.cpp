#include "net/cells/cell_receiver.h"

#include "tests/net/cell_scene.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::net;
using namespace std::chrono_literals;

struct Trial {
  CongestionResponse response = CongestionResponse::reserved;
  Link::Options link;
  CellWish wish;
  bool parity = true;
  std::uint64_t rate = 10'000'000, seed = 1;
  Instant most{60s};
  Trial() {
    link.latency = 50ms;
    link.bandwidth = 10'000'000;
    wish.path = "a";
  }
  std::unique_ptr<Scene> run(const std::shared_ptr<PatternSource>& source) const {
    CellServerOptions options = server_options(response, 3);
    options.session.parity = parity;
    auto scene = std::make_unique<Scene>(options, library(source));
    scene->add(link, source, rate, seed);
    scene->clients[0]->client.want(0, wish, scene->now);
    const ReceivedCells& got = scene->clients[0]->got;
    scene->run(scene->now + most, [&] { return wish.repair ? got.bytes >= source->total() : got.ended && got.base; });
    scene->run(scene->now + 300ms);
    return scene;
  }
};

std::shared_ptr<PatternSource> records() { return std::make_shared<PatternSource>(15000, Streams{{true, 100, 8000}}); }
std::shared_ptr<PatternSource> clusters() {
  return std::make_shared<PatternSource>(15000, Streams{{false, 700, 1200}});
}

double share(const Scene& scene, const PatternSource& source) {
  return static_cast<double>(scene.clients[0]->got.bytes) / static_cast<double>(source.total());
}

TEST_CASE("receives everything in order without loss", "[cell_receiver]") {
  for (const bool packed : {false, true})
    for (const std::uint8_t cells : {std::uint8_t{26}, std::uint8_t{10}, std::uint8_t{4}}) {
      const auto source = packed ? clusters() : records();
      Trial trial;
      trial.wish.cells = cells;
      const auto scene = trial.run(source);
      const ReceivedCells& got = scene->clients[0]->got;
      REQUIRE(got.ok);
      REQUIRE(got.base);
      REQUIRE(got.bytes == source->total());
      REQUIRE(std::is_sorted(got.order.begin(), got.order.end()));
      REQUIRE(scene->clients[0]->client.statistics().lost == 0);
    }
}

TEST_CASE("receives the base soon, and loses only the lost data", "[cell_receiver]") {
  for (const double loss : {0.01, 0.1, 0.3, 0.5}) {
    const auto source = records();
    Trial trial;
    trial.link.loss = loss;
    trial.parity = false;
    for (trial.seed = 1; trial.seed <= 5; trial.seed += gs::watched_step(2)) {
      const auto scene = trial.run(source);
      const ReceivedCells& got = scene->clients[0]->got;
      REQUIRE(got.ok);
      REQUIRE(got.base);
      REQUIRE(share(*scene, *source) == Approx(1 - loss).margin(0.07));
    }
  }
}

TEST_CASE("uses the cells of damaged PDUs with small datagrams", "[cell_receiver]") {
  const auto source = records();
  Trial trial;
  trial.wish.cells = 4;  // two cells of records in each: a PDU needs four datagrams
  trial.link.loss = 0.3;
  trial.parity = false;
  const auto scene = trial.run(source);
  REQUIRE(scene->clients[0]->got.ok);
  // With whole PDUs alone, the share would be 0.7^4 = 24 %.
  REQUIRE(share(*scene, *source) == Approx(0.7).margin(0.03));
}

TEST_CASE("receives clusters of several datagrams completely or not at all, and repairs them", "[cell_receiver]") {
  const auto source = std::make_shared<PatternSource>(15000, Streams{{false, 30, 9000}, {false, 300, 300}});
  Trial trial;
  trial.link.loss = 0.1;
  trial.parity = false;
  auto scene = trial.run(source);
  REQUIRE(scene->clients[0]->got.ok);
  REQUIRE(share(*scene, *source) < 0.9);
  trial.wish.repair = true;
  scene = trial.run(source);
  REQUIRE(scene->clients[0]->got.ok);
  REQUIRE(share(*scene, *source) == 1);
}

TEST_CASE("receives lost chunks after another request", "[cell_receiver]") {
  for (const bool packed : {false, true}) {
    const auto source = packed ? clusters() : records();
    Trial trial;
    trial.link.loss = 0.3;
    trial.wish.repair = true;
    const auto scene = trial.run(source);
    REQUIRE(scene->clients[0]->got.ok);
    REQUIRE(scene->clients[0]->got.bytes == source->total());
  }
}

TEST_CASE("accepts reordered and duplicate datagrams", "[cell_receiver]") {
  for (const std::uint8_t cells : {std::uint8_t{26}, std::uint8_t{4}}) {
    const auto source = records();
    Trial trial;
    trial.wish.cells = cells;
    trial.link.reordered = 0.2;
    trial.link.reordered_by = 3ms;
    trial.link.duplicated = 0.2;
    const auto scene = trial.run(source);
    REQUIRE(scene->clients[0]->got.ok);
    REQUIRE(scene->clients[0]->got.bytes == source->total());
  }
}

TEST_CASE("repeats a run bit for bit", "[cell_receiver]") {
  const auto run = [] {
    const auto source = records();
    Trial trial;
    trial.response = CongestionResponse::equation;
    trial.link.loss = 0.05;
    trial.link.reordered = 0.05;
    trial.most = 10s;
    const auto scene = trial.run(source);
    return std::tuple(scene->clients[0]->got.bytes, scene->clients[0]->got.base_at, scene->clients[0]->got.order,
                      scene->clients[0]->down.sent(), scene->clients[0]->up.sent());
  };
  REQUIRE(run() == run());
}

TEST_CASE("avoids flooding a narrow link", "[cell_receiver]") {
  const auto source = std::make_shared<PatternSource>(15000, Streams{{true, 3000, 8000}});
  Trial trial;
  trial.response = CongestionResponse::equation;
  trial.link.bandwidth = 3'000'000;
  trial.link.queue = 40'000;
  trial.rate = 50'000'000;
  trial.most = 30s;
  const auto scene = trial.run(source);
  const Link& down = scene->clients[0]->down;
  REQUIRE(scene->clients[0]->got.ok);
  REQUIRE(static_cast<double>(down.dropped()) / static_cast<double>(down.sent()) < 0.05);
  const double rate = static_cast<double>(scene->clients[0]->got.bytes) * 8 / 30;
  REQUIRE(rate > 0.4 * 3e6);
}

TEST_CASE("shares a narrow link between the clients behind it", "[cell_receiver][optimised]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{true, 20000, 8000}});
  Scene scene(server_options(CongestionResponse::equation, 3), library(source));
  Link::Options narrow, link;
  narrow.bandwidth = 6'000'000;
  narrow.queue = 60'000;
  link.latency = 25ms;
  scene.share_link(narrow);
  CellWish wish;
  wish.path = "a";
  for (int i = 0; i < 3; ++i) scene.add(link, source, 50'000'000);
  for (auto& client : scene.clients) {
    client->client.want(0, wish, scene.now);
    scene.run(scene.now + 3s);  // one after the other
  }
  std::vector<std::uint64_t> before;
  for (auto& client : scene.clients) before.push_back(client->client.statistics().bytes);
  scene.run(scene.now + 60s);
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto bytes = static_cast<double>(scene.clients[i]->client.statistics().bytes - before[i]);
    sum += bytes;
    squares += bytes * bytes;
  }
  INFO(sum * 8 / 60 << " bit/s, evenness " << sum * sum / (3 * squares));
  CHECK(sum * 8 / 60 > 0.7 * 6e6);
  REQUIRE(sum * sum / (3 * squares) > 0.9);  // Jain's index: 1 is even
}

TEST_CASE("keeps the rate of a sender that reacts to delay when the link itself loses datagrams", "[cell_receiver]") {
  const auto source = std::make_shared<PatternSource>(15000, Streams{{true, 500, 8000}});
  Trial trial;
  trial.link.loss = 0.1;
  trial.response = CongestionResponse::delay_aware;
  const auto aware = trial.run(source);
  trial.response = CongestionResponse::equation;
  const auto careful = trial.run(source);
  REQUIRE(aware->clients[0]->got.ended_at < Instant(10s));
  REQUIRE(careful->clients[0]->got.bytes < aware->clients[0]->got.bytes);
  // A queue slows the sender.
  trial.response = CongestionResponse::delay_aware;
  trial.link.loss = 0;
  trial.link.bandwidth = 2'000'000;
  trial.link.queue = 60'000;
  const auto narrow = trial.run(source);
  const Link& down = narrow->clients[0]->down;
  REQUIRE(static_cast<double>(down.dropped()) / static_cast<double>(down.sent()) < 0.1);
}

TEST_CASE("resumes after the link was cut", "[cell_receiver]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{false, 3000, 1000}});
  Scene scene(server_options(CongestionResponse::equation, 3), library(source));
  Link::Options link, cut;
  link.latency = 10ms;
  cut.cut = true;
  scene.add(link, source, 4'000'000);
  CellWish wish;
  wish.path = "a";
  wish.repair = true;
  Scene::Client& client = *scene.clients[0];
  client.client.want(0, wish, scene.now);
  scene.run(scene.now + 2s);
  const std::uint64_t before = client.got.bytes;
  REQUIRE(before > 0);
  client.up.set(cut);
  client.down.set(cut);
  scene.run(scene.now + 5s);
  client.up.set(link);
  client.down.set(link);
  scene.run(scene.now + 20s);
  REQUIRE(client.got.ok);
  REQUIRE(client.got.bytes == source->total());  // no byte is delivered twice
}

TEST_CASE("continues after a minute without contact", "[cell_receiver]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{true, 100, 8000}});
  Scene scene(server_options(), library(source));
  Link::Options link;
  link.latency = 20ms;
  link.bandwidth = 1'000'000;
  Link::Options cut = link;
  cut.cut = true;
  Scene::Client& client = *scene.clients[scene.add(link, source, 1'000'000)];
  client.client.want(0, wish(), scene.now);
  scene.run(scene.now + 2s);
  REQUIRE(client.got.bytes > 0);
  REQUIRE(client.got.bytes < source->total());
  client.up.set(cut);
  client.down.set(cut);
  scene.run(scene.now + 60s);
  REQUIRE_FALSE(client.got.failed);
  client.up.set(link);
  client.down.set(link);
  scene.run(scene.now + 60s, [&] { return client.got.ended; });
  CHECK(client.got.ok);
  CHECK(client.got.ended);
}

TEST_CASE("reports a missing server", "[cell_receiver]") {
  CellClientOptions options;
  options.nonce = 5;
  CellClient client(options);
  CellWish wish;
  wish.path = "a";
  Instant now{0};
  client.want(0, wish, now);
  std::size_t hellos = 0;
  for (int i = 0; i < 100 && client.deadline(now) != Instant::max(); ++i) {
    now = client.deadline(now);
    while (client.next(now)) ++hellos;
  }
  REQUIRE(hellos == options.most_tries);
  const auto events = client.take_events();
  REQUIRE(events.size() == 1);
  REQUIRE(events[0].kind == CellEvent::Kind::failed);
  REQUIRE(events[0].text.find("no cell server answers") != std::string::npos);
}

TEST_CASE("limits queued data for a slow owner", "[cell_receiver]") {
  const auto source = std::make_shared<PatternSource>(1000, Streams{{true, 1000, 8000}});
  CellServer server(server_options(CongestionResponse::equation, 3), library(source));
  CellClientOptions options;
  options.nonce = 5;
  options.most_waiting = 50'000;
  CellClient client(options);
  CellWish wish;
  wish.path = "a";
  Instant now{1000};
  client.want(0, wish, now);
  for (int i = 0; i < 20000; ++i) {
    now += 1ms;
    while (const auto bytes = client.next(now)) server.receive({}, *bytes, now);
    while (const auto out = server.next(now)) client.receive(out->bytes, now);
  }
  REQUIRE(client.statistics().refused_for_space > 0);
  std::size_t bytes = 0;
  for (const CellEvent& event : client.take_events()) bytes += event.bytes.size();
  REQUIRE(bytes < 60'000);
}

TEST_CASE("survives any message of a server", "[cell_receiver]") {
  std::uint64_t random = 9;
  const auto source = std::make_shared<PatternSource>(3000, Streams{{true, 20, 2000}, {false, 20, 2000}});
  for (int round = 0; round < 20; ++round) {
    CellServer server(server_options(CongestionResponse::equation, 3), library(source));
    CellClientOptions options;
    options.nonce = static_cast<std::uint64_t>(round) + 1;
    CellClient client(options);
    CellWish wish;
    wish.path = "a";
    wish.repair = true;
    wish.cells = static_cast<std::uint8_t>(round % 2 == 0 ? 26 : 5);
    Instant now{1000};
    client.want(0, wish, now);
    const auto damage = [&](std::vector<std::byte> bytes) {
      if (Link::next_random(random) % 2 == 0)
        for (std::uint64_t k = Link::next_random(random) % 3; k-- > 0;)
          bytes[Link::next_random(random) % bytes.size()] ^= static_cast<std::byte>(1 << Link::next_random(random) % 8);
      if (Link::next_random(random) % 16 == 0) bytes.resize(Link::next_random(random) % bytes.size());
      return bytes;
    };
    for (int i = 0; i < 1500; ++i) {
      now += 2ms;
      while (const auto bytes = client.next(now)) server.receive({}, damage(*bytes), now);
      while (const auto out = server.next(now)) client.receive(damage(out->bytes), now);
      (void)client.take_events();
    }
  }
}

}  // namespace
