#include "net/cells/cell_parity.h"
#include "tests/net/cell_scene.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::net;
using namespace std::chrono_literals;

struct ParityTrial {
  CongestionResponse response = CongestionResponse::reserved;
  Link::Options link;
  std::uint8_t cells = kMaxCells;
  bool parity = true;
  std::uint64_t seed = 1;

  std::unique_ptr<Scene> run(const std::shared_ptr<PatternSource>& source) const {
    CellServerOptions options = server_options(response, 3);
    options.session.parity = parity;
    auto scene = std::make_unique<Scene>(options, library(source));
    Link::Options way = link;
    way.latency = 50ms;
    way.bandwidth = 12'000'000;
    scene->add(way, source, 10'000'000, seed);
    CellWish wish;
    wish.path = "a";
    wish.cells = cells;
    scene->clients[0]->client.want(0, wish, scene->now);
    const ReceivedCells& got = scene->clients[0]->got;
    scene->run(scene->now + 300s, [&] { return got.ended && got.base; });
    REQUIRE(got.ok);
    REQUIRE(got.base);
    REQUIRE(got.ended);
    return scene;
  }
};

std::shared_ptr<PatternSource> parity_records(std::uint32_t chunks = 400) {
  return std::make_shared<PatternSource>(15000, Streams{{true, chunks, 8000}});
}
std::shared_ptr<PatternSource> parity_clusters() {
  return std::make_shared<PatternSource>(15000, Streams{{false, 2000, 1200}});
}

struct Measured {
  double chunks = 0, bytes = 0, sent = 0;  // whole chunks and bytes received; bytes sent per byte of data
};
Measured measure(const Scene& scene, const PatternSource& source) {
  const Scene::Client& client = *scene.clients[0];
  double chunks = 0;
  for (std::size_t i = 0; i < source.streams(); ++i) chunks += source.chunks(i);
  return {static_cast<double>(client.got.whole_chunks(source)) / chunks,
          static_cast<double>(client.got.bytes) / static_cast<double>(source.total()),
          static_cast<double>(client.down.sent_bytes()) / static_cast<double>(source.total() + 15000)};
}

TEST_CASE("adds no bytes for parity without loss", "[cell_parity]") {
  for (const bool packed : {false, true}) {
    const auto source = packed ? parity_clusters() : parity_records();
    ParityTrial trial;
    const auto with = trial.run(source);
    REQUIRE(with->server.statistics().parity_datagrams == 0);
    REQUIRE(with->clients[0]->client.statistics().parity == 0);
    trial.parity = false;
    const auto without = trial.run(source);
    // The sent bytes are equal, except for the slightly shorter first datagrams.
    REQUIRE(static_cast<double>(with->clients[0]->down.sent_bytes()) <
            1.02 * static_cast<double>(without->clients[0]->down.sent_bytes()));
  }
}

TEST_CASE("restores lost datagrams without another request", "[cell_parity][optimised]") {
  struct Case {
    double loss, chunks, most_sent;  // relative to the bytes without loss
  };
  // For comparison, the minimum 1 / (1 - loss) is 1.01, 1.11, 1.43, 2.
  const Case cases[] = {{0.01, 0.99, 1.18}, {0.1, 0.995, 1.45}, {0.3, 0.98, 2.2}, {0.5, 0.95, 3.5}};
  for (const bool packed : {false, true}) {
    const auto source = packed ? parity_clusters() : parity_records();
    ParityTrial trial;
    const double plain = measure(*trial.run(source), *source).sent;
    for (const Case& at : cases) {
      Measured sum;
      constexpr int kSeeds = 4;
      for (trial.seed = 1; trial.seed <= kSeeds; ++trial.seed) {
        trial.link.loss = at.loss;
        const auto scene = trial.run(source);
        const Measured measured = measure(*scene, *source);
        sum.chunks += measured.chunks / kSeeds;
        sum.bytes += measured.bytes / kSeeds;
        sum.sent += measured.sent / kSeeds;
        const CellClientStatistics statistics = scene->clients[0]->client.statistics();
        REQUIRE(statistics.rebuilt > 0);
        REQUIRE(statistics.rebuilt <= statistics.lost);  // rebuilt datagrams still count as lost in reports
        trial.link.loss = 0;
      }
      INFO((packed ? "clusters" : "records") << ", loss " << at.loss << ": chunks " << sum.chunks << ", bytes "
                                             << sum.bytes << ", sent " << sum.sent << " to " << plain);
      CHECK(sum.chunks >= at.chunks);
      CHECK(sum.sent <= at.most_sent * plain);
    }
  }
}

TEST_CASE("sends more parity after losses in runs", "[cell_parity][optimised]") {
  const auto source = parity_records(600);
  for (const double loss : {0.1, 0.3}) {
    ParityTrial trial;
    trial.link.loss = loss;
    double bytes = 0;
    for (trial.seed = 1; trial.seed <= 3; ++trial.seed) {
      trial.link.burst = 4;
      bytes += measure(*trial.run(source), *source).bytes / 3;
    }
    INFO("loss " << loss << ": bytes " << bytes);
    CHECK(bytes >= 0.985);
  }
}

TEST_CASE("restores small datagrams", "[cell_parity]") {
  const auto source = parity_records(100);
  for (const std::uint8_t cells : {std::uint8_t{4}, std::uint8_t{5}, std::uint8_t{9}}) {
    ParityTrial trial;
    trial.cells = cells;
    trial.link.loss = 0.2;
    const auto scene = trial.run(source);
    INFO(static_cast<int>(cells) << " cells: " << measure(*scene, *source).bytes);
    CHECK(measure(*scene, *source).bytes > 0.985);
  }
}

TEST_CASE("restores datagrams despite reordering and duplicates", "[cell_parity]") {
  for (const bool packed : {false, true}) {
    const auto source = packed ? parity_clusters() : parity_records(150);
    ParityTrial trial;
    trial.link.loss = 0.1;
    trial.link.reordered = 0.1;
    trial.link.reordered_by = 8ms;
    trial.link.duplicated = 0.1;
    const auto scene = trial.run(source);
    CHECK(measure(*scene, *source).bytes > 0.99);
    CHECK(scene->clients[0]->got.bytes <= source->total());  // no byte is received twice
  }
}

TEST_CASE("protects a scene of a few datagrams", "[cell_parity]") {
  // All data are sent before the first report; `ended` waits for the parity.
  std::uint64_t lacking = 0, total = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto source = std::make_shared<PatternSource>(2000, Streams{{true, 5, 4000}});
    ParityTrial trial;
    trial.seed = seed;
    trial.link.loss = 0.1;
    const auto scene = trial.run(source);
    total += source->total();
    lacking += source->total() - scene->clients[0]->got.bytes;
  }
  INFO(lacking << " of " << total);
  CHECK(static_cast<double>(lacking) < 0.02 * static_cast<double>(total));
}

TEST_CASE("adapts to losses that begin later, and forgets losses that end", "[cell_parity][optimised]") {
  const auto source = std::make_shared<PatternSource>(2000, Streams{{true, 2000, 8000}});
  Scene scene(server_options(CongestionResponse::reserved, 3), library(source));
  Link::Options clean, lossy;
  clean.latency = lossy.latency = 30ms;
  lossy.loss = 0.15;
  scene.add(clean, source, 8'000'000);
  Scene::Client& client = *scene.clients[0];
  client.client.want(0, wish(), scene.now);
  scene.run(scene.now + 3s);
  REQUIRE(scene.server.statistics().parity_datagrams == 0);
  client.down.set(lossy);
  scene.run(scene.now + 1s);
  const std::uint64_t lost = client.client.statistics().lost, rebuilt = client.client.statistics().rebuilt;
  scene.run(scene.now + 3s);
  const auto now_lost = static_cast<double>(client.client.statistics().lost - lost);
  const auto now_rebuilt = static_cast<double>(client.client.statistics().rebuilt - rebuilt);
  REQUIRE(now_lost > 300);
  // Parity is lost as well, and unneeded parity is not rebuilt: three of four datagrams are data.
  CHECK(now_rebuilt > 0.6 * now_lost);
  client.down.set(clean);
  scene.run(scene.now + 15s);
  const std::uint64_t before = scene.server.statistics().parity_datagrams;
  scene.run(scene.now + 2s);
  CHECK(scene.server.statistics().parity_datagrams == before);
  CHECK(client.got.ok);
}

TEST_CASE("shares parity groups between slots", "[cell_parity]") {
  const auto source = parity_records(60);
  Scene scene(server_options(CongestionResponse::reserved, 3), library(source));
  Link::Options link;
  link.latency = 30ms;
  link.loss = 0.1;
  scene.add(link, source, 8'000'000);
  CellWish wish;
  wish.path = "a";
  Scene::Client& client = *scene.clients[0];
  client.client.want(0, wish, scene.now);
  wish.cells = 9;
  client.client.want(6, wish, scene.now);
  scene.run(scene.now + 20s);
  REQUIRE(client.got.ok);
  REQUIRE(client.got.ended);
  CHECK(static_cast<double>(client.got.slot_bytes[0]) > 0.99 * static_cast<double>(source->total()));
  CHECK(static_cast<double>(client.got.slot_bytes[6]) > 0.99 * static_cast<double>(source->total()));
}

}  // namespace
