#include <catch2/catch.hpp>

#include <map>
#include <set>

#include "net/transfer/transport.h"
#include "tests/net/bad_server.h"
#include "tests/net/load_helpers.h"

/// Tests of the client's rate limit, shared by all its HTTP transfers. The test controls the clock.
namespace gs::net::rate_test {

using namespace gs::net;
using namespace gs::net::test;

struct Counter final : TransferSink {
  HeadVerdict on_head(TransferId, const ResponseHead&) override { return HeadVerdict::take; }
  DataVerdict on_data(TransferId id, std::span<const std::byte> bytes) override {
    received[id] += bytes.size();
    all += bytes.size();
    return DataVerdict::more;
  }
  void on_end(TransferId id, const TransferEnd& end) override {
    CHECK_FALSE(end.error);
    ended.insert(id);
  }
  std::map<TransferId, std::size_t> received;
  std::set<TransferId> ended;
  std::size_t all = 0;
};

TEST_CASE("limits the rate of a client over HTTP across all its transfers, from the first byte on") {
  constexpr std::size_t kSize = 150'000;
  constexpr std::uint64_t kRate = 25'000;  // bytes per second: 200 kbit/s
  const auto serve = [&](BadServer::Exchange& exchange) {
    exchange.send(http("200 OK", "Content-Type: model/vrml\r\n", std::string(kSize, 'x')));
  };
  const BadServer first(serve), second(serve, "127.0.0.2");
  LoaderOptions options;
  options.proxy_from_environment = false;
  options.bytes_per_second = kRate;
  options.unix_seconds = [] { return std::int64_t{1'700'000'000}; };
  const auto transport = make_http_transport(options);
  Counter counter;
  TimePoint now{std::chrono::hours(1)};
  const TimePoint begin = now;
  for (const TransferId id : {TransferId{1}, TransferId{2}}) {
    TransferRequest request;
    request.url = (id == 1 ? first : second).url();
    transport->start(id, request, now);
  }
  const auto seconds = [&] { return std::chrono::duration<double>(now - begin).count(); };
  const double block = kRate / 10.0;
  double shared = 0;  // bytes of both clients when the first one was complete
  for (int step = 0; step < 100'000 && counter.ended.size() < 2; ++step) {
    transport->step(counter, now);
    INFO(seconds() << " s, " << counter.all << " bytes");
    REQUIRE(static_cast<double>(counter.all) <= kRate * seconds() + 2 * block);
    if (counter.ended.empty()) shared = static_cast<double>(std::min(counter.received[1], counter.received[2]));
    transport->wait(Milliseconds(1), {});
    // Advances while the transport waits for its rate, not for the server.
    const auto next = transport->deadline(now);
    if (next && *next > now && *next < now + Milliseconds(1000)) now = *next;
    if (counter.all == 0) continue;
    now += Milliseconds(1);
  }
  CHECK(counter.ended.size() == 2);
  CHECK(counter.all == 2 * kSize);
  CHECK(seconds() >= (2.0 * kSize - 2 * block) / kRate);
  CHECK(shared > 0.8 * kSize);  // both clients received data concurrently
}

TEST_CASE("changes or lifts the rate during HTTP transfers") {
  constexpr std::size_t kSize = 400'000;
  const BadServer server([&](BadServer::Exchange& exchange) {
    exchange.send(http("200 OK", "Content-Type: model/vrml\r\n", std::string(kSize, 'x')));
  });
  LoaderOptions options;
  options.proxy_from_environment = false;
  options.bytes_per_second = 25'000;
  options.unix_seconds = [] { return std::int64_t{1'700'000'000}; };
  const auto transport = make_http_transport(options);
  Counter counter;
  TimePoint now{std::chrono::hours(1)};
  TransferRequest request;
  request.url = server.url();
  transport->start(1, request, now);
  // Receives this many bytes, and returns the seconds in which the transport waited for its rate.
  const auto receive = [&](std::size_t bytes, bool clock_goes) {
    const TimePoint begin = now;
    for (int step = 0; step < 100'000 && counter.all < bytes; ++step) {
      transport->step(counter, now);
      transport->wait(Milliseconds(1), {});
      const auto next = transport->deadline(now);
      if (clock_goes && next && *next > now && *next < now + Milliseconds(1000)) now = *next;
    }
    REQUIRE(counter.all >= bytes);
    return std::chrono::duration<double>(now - begin).count();
  };
  CHECK(receive(50'000, true) >= 1.7);
  transport->set_rate(100'000);
  const double faster = receive(150'000, true);
  CHECK(faster >= 0.8);
  CHECK(faster <= 1.3);
  transport->set_rate(0);
  CHECK(receive(kSize, false) == 0);
  CHECK(counter.all == kSize);
}

}  // namespace gs::net::rate_test
