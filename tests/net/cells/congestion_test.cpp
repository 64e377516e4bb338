#include "net/cells/congestion.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace {

using namespace gs::net;
using namespace std::chrono_literals;

TEST_CASE("computes the rate of TCP", "[congestion]") {
  // RFC 5348 3.1, computed by hand for p = 0.01 and R = 0.1 s: R sqrt(2p/3) = 0.0081650; 4R 3 sqrt(3p/8) p (1 + 32 p^2)
  // = 0.00073716.
  REQUIRE(tcp_rate(1000, 0.1, 0.01) == Approx(1000 / (0.0081650 + 0.00073716)).epsilon(1e-4));
  REQUIRE(std::isinf(tcp_rate(1000, 0.1, 0)));
  for (const double rate : {1e3, 1e5, 1e6})
    REQUIRE(tcp_rate(1388, 0.1, tcp_loss(1388, 0.1, rate)) == Approx(rate).epsilon(1e-3));
}

TEST_CASE("names every congestion response", "[congestion]") {
  REQUIRE(congestion_names().size() == 3);
  REQUIRE(congestion_names()[0].name == "equation");
  REQUIRE(congestion_names()[1].name == "delay-aware");
  REQUIRE(congestion_names()[2].name == "reserved");
  for (std::size_t i = 0; i < 3; ++i) {
    REQUIRE(congestion_names()[i].response == static_cast<CongestionResponse>(i));
    REQUIRE_FALSE(congestion_names()[i].help.empty());
  }
}

TEST_CASE("measures a steady loss of one percent", "[congestion]") {
  LossHistory history;
  Instant now{0};
  for (std::uint64_t i = 0; i < 20000; ++i) {
    now += 10ms;
    if (i % 100 != 50) history.arrived(i, 1388, now, 1ms, true);
  }
  REQUIRE(history.lost() == 200);
  REQUIRE(history.received() == 19800);
  REQUIRE(history.event_rate() == Approx(0.01).epsilon(0.02));
}

TEST_CASE("counts losses within one round trip as one event", "[congestion]") {
  LossHistory history;
  Instant now{0};
  for (std::uint64_t i = 0; i < 20000; ++i) {
    now += 1ms;
    if (i % 1000 < 10) continue;
    history.arrived(i, 1388, now, 100ms, true);
  }
  REQUIRE(history.event_rate() == Approx(0.001).epsilon(0.1));
}

TEST_CASE("counts late datagrams as received", "[congestion]") {
  LossHistory history;
  for (const std::uint64_t i : {0, 2, 1, 3, 5, 6, 4, 7, 8, 9, 10}) history.arrived(i, 100, Instant(0), 10ms, true);
  REQUIRE(history.lost() == 0);
  REQUIRE(history.event_rate() == 0);
  history.arrived(1'000'000'000'000, 100, Instant(0), 10ms, true);
  REQUIRE(history.lost() > 999'999'990'000);
  REQUIRE(history.event_rate() > 0);
  REQUIRE(history.clear_new_event());
  REQUIRE_FALSE(history.clear_new_event());
}

TEST_CASE("detects queues by their delay, whatever the clocks are", "[congestion]") {
  QueueDelay delay;
  std::uint32_t sent = 4'294'900'000;  // wraps around soon
  const std::uint32_t skew = 3'000'000'000;
  const auto put = [&](std::uint32_t taken) {
    sent += 10'000;
    delay.add(sent, sent + skew + taken);
  };
  for (int i = 0; i < 100; ++i) put(50'000 + static_cast<std::uint32_t>(i % 3) * 1000);
  REQUIRE_FALSE(delay.queued());
  for (std::uint32_t i = 0; i < 50; ++i) put(50'000 + i * 2000);
  REQUIRE(delay.queued());
  for (int i = 0; i < 3; ++i) put(50'000);
  REQUIRE_FALSE(delay.queued());
}

TEST_CASE("starts slowly, doubles, and then obeys the equation", "[congestion]") {
  Instant now{0};
  RateController controller(CongestionResponse::equation, 1e6, 100ms, now);
  REQUIRE(controller.rate() == Approx(138'800));
  for (int i = 0; i < 10; ++i) {
    now += 100ms;
    const double before = controller.rate();
    controller.feedback({100ms, 0, before, false}, now);
    REQUIRE(controller.rate() <= 2 * before + 1);
  }
  REQUIRE(controller.rate() == 1e6);
  now += 100ms;
  controller.feedback({100ms, 0.01, 1e6, false}, now);
  REQUIRE(controller.rate() == Approx(tcp_rate(1388, 0.1, 0.01)));
  // Without loss, but with less than a third received, the rate is twice the received rate.
  RateController other(CongestionResponse::equation, 1e6, 100ms, now);
  for (int i = 1; i < 8; ++i) other.feedback({100ms, 0, 70'000, false}, now + i * 100ms);
  REQUIRE(other.rate() <= 140'001);
}

TEST_CASE("halves the rate repeatedly without reports", "[congestion]") {
  RateController controller(CongestionResponse::equation, 1e7, 100ms, Instant(0));
  for (int i = 1; i < 12; ++i) controller.feedback({100ms, 0, controller.rate(), false}, i * 100ms);
  const double before = controller.rate();
  controller.tick(controller.deadline());
  REQUIRE(controller.rate() == Approx(before / 2));
  for (int i = 0; i < 40; ++i) controller.tick(controller.deadline());
  REQUIRE(controller.rate() == Approx(13'880));  // a datagram per round trip
}

}  // namespace
