#include "net/tunnel/tunnel_session.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <random>
#include <string>

namespace gs::net::tunnel_session_test {
namespace {

using namespace std::chrono_literals;
using Time = Multiplexer::Time;

TunnelTerms terms_of(TunnelRole role) {
  TunnelTerms terms;
  terms.role = role;
  terms.version = "1.0";
  return terms;
}

std::string text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

/// Moves bytes from one session to the other, in pieces of `piece` bytes.
void carry(TunnelSession& from, TunnelSession& to, Time now, std::size_t piece = 100'000) {
  while (!from.outgoing().empty()) {
    const auto bytes = from.outgoing().first(std::min(piece, from.outgoing().size()));
    const auto problem = to.receive(bytes, now);
    if (problem) FAIL(*problem);
    from.sent(bytes.size());
  }
}

struct Pair {
  Time now{};
  TunnelSession client{terms_of(TunnelRole::client), now}, server{terms_of(TunnelRole::server), now};
  void exchange(std::size_t piece = 100'000) {
    for (int i = 0; i < 3; ++i) {
      carry(client, server, now, piece);
      carry(server, client, now, piece);
    }
  }
};

/// Returns the bytes of a client that sends its hello and then `frames`.
std::vector<std::byte> hello_and(const std::function<void(std::vector<std::byte>&)>& frames) {
  const auto mark = std::as_bytes(std::span(kTunnelMark));
  std::vector<std::byte> bytes(mark.begin(), mark.end());
  append_frame(bytes, TunnelFrameKind::hello, 0, std::string_view("protocols 1\n"));
  frames(bytes);
  return bytes;
}

std::string problem_of(TunnelRole role, const std::function<void(std::vector<std::byte>&)>& frames) {
  TunnelSession session(terms_of(role), Time{});
  return session.receive(hello_and(frames), Time{}).value_or("");
}

}  // namespace

TEST_CASE("a tunnel carries connections in both directions") {
  for (const std::size_t piece : {1u, 7u, 100'000u}) {
    Pair pair;
    pair.exchange(piece);
    REQUIRE(pair.client.ready());
    REQUIRE(pair.server.ready());
    CHECK(pair.client.hello().version == "1.0");
    const auto first = pair.client.open(), second = pair.client.open();
    pair.client.send(first, bytes_of("one"));
    pair.client.send(second, bytes_of("two"));
    pair.exchange(piece);
    CHECK(pair.server.take_opened() == std::vector<std::uint32_t>{first, second});
    CHECK(text(pair.server.received(first)) == "one");
    CHECK(text(pair.server.received(second)) == "two");
    pair.server.took(first, 3);
    pair.server.send(first, bytes_of("answer"));
    pair.server.close(first);
    pair.exchange(piece);
    CHECK(text(pair.client.received(first)) == "answer");
    CHECK(pair.client.ended(first));
    CHECK_FALSE(pair.client.ended(second));
    pair.client.took(first, 6);
    pair.client.close(first);
    pair.client.close(second);
    pair.exchange(piece);
    CHECK(pair.server.ended(second));
    CHECK(pair.client.connections() == 0);
  }
}

TEST_CASE("a window bounds what a connection holds, and grows with the rate of the line") {
  Pair pair;
  pair.exchange();
  const auto id = pair.client.open();
  pair.exchange();
  (void)pair.server.take_opened();
  // A receiver that takes nothing gets one window.
  std::size_t sent = 0;
  const std::string block(16384, 'x');
  for (int i = 0; i < 1000 && pair.server.room(id) > 0; ++i) {
    const std::size_t room = std::min(pair.server.room(id), block.size());
    pair.server.send(id, bytes_of(block).first(room));
    sent += room;
    carry(pair.server, pair.client, pair.now);
  }
  CHECK(sent == 65536);
  // One that takes everything gets more: 50 ms there and back, a fast line.
  for (int round = 0; round < 40; ++round) {
    pair.client.took(id, pair.client.received(id).size());
    pair.now += 25ms;
    carry(pair.client, pair.server, pair.now);
    while (pair.server.room(id) > 0) {
      pair.server.send(id, bytes_of(block).first(std::min(pair.server.room(id), block.size())));
      pair.now += 10us;
      if (pair.server.outgoing().size() > 30'000) carry(pair.server, pair.client, pair.now + 25ms);
    }
    pair.now += 25ms;
    carry(pair.server, pair.client, pair.now);
  }
  CHECK(pair.client.window() >= std::size_t{1} << 20);
  CHECK(pair.client.window() <= std::size_t{8} << 20);
}

TEST_CASE("a slow line keeps the window small") {
  Pair pair;
  pair.exchange();
  const auto id = pair.client.open();
  pair.exchange();
  (void)pair.server.take_opened();
  // 125 kB/s: all waiting bytes are in the queue of the line, so that larger windows do not increase the rate.
  const std::string block(16384, 'x');
  for (int round = 0; round < 200; ++round) {
    carry(pair.client, pair.server, pair.now);
    while (pair.server.room(id) > 0)
      pair.server.send(id, bytes_of(block).first(std::min(pair.server.room(id), block.size())));
    const std::size_t bytes = pair.server.outgoing().size();
    pair.now += std::chrono::microseconds(bytes * 8);
    carry(pair.server, pair.client, pair.now);
    pair.client.took(id, pair.client.received(id).size());
  }
  CHECK(pair.client.window() <= 300'000);
}

TEST_CASE("a session refuses what the protocol forbids") {
  using Kind = TunnelFrameKind;
  const auto open = [](std::vector<std::byte>& out) { append_frame(out, Kind::open, 1); };
  CHECK(problem_of(TunnelRole::server, open).empty());
  CHECK_FALSE(problem_of(TunnelRole::client, open).empty());
  const auto then = [&](auto more) {
    return problem_of(TunnelRole::server, [&](std::vector<std::byte>& out) {
      open(out);
      more(out);
    });
  };
  const std::string block(kMaxTunnelPayload, 'x');
  CHECK_FALSE(then(open).empty());
  CHECK_FALSE(then([](auto& out) { append_frame(out, Kind::open, 0); }).empty());
  CHECK_FALSE(then([](auto& out) { append_frame(out, Kind::data, 2, std::string_view("x")); }).empty());
  CHECK_FALSE(then([](auto& out) { append_frame(out, Kind::data, 0, std::string_view("x")); }).empty());
  CHECK(then([&](auto& out) { append_frame(out, Kind::data, 1, std::string_view(block)); }).empty());
  CHECK_FALSE(then([&](auto& out) {
                for (int i = 0; i < 2; ++i) append_frame(out, Kind::data, 1, std::string_view(block));
              }).empty());
  CHECK_FALSE(then([](auto& out) { append_frame(out, Kind::window, 1, std::uint32_t{0xffffffff}); }).empty());
  CHECK_FALSE(then([](auto& out) { append_frame(out, Kind::window, 1, std::string_view("abc")); }).empty());
  CHECK_FALSE(then([](auto& out) {
                append_frame(out, Kind::close, 1);
                append_frame(out, Kind::data, 1, std::string_view("x"));
              }).empty());
  CHECK_FALSE(then([&](auto& out) { append_frame(out, Kind::ping, 0, std::string_view(block)); }).empty());
  CHECK_FALSE(then([](auto& out) { append_frame(out, Kind::hello, 0, std::string_view("protocols 1\n")); }).empty());
  CHECK(then([](auto& out) { append_frame(out, Kind::error, 0, std::string_view("no\x1b[2J")); }) ==
        "it reports: no?[2J");
  CHECK(then([](auto& out) { append_frame(out, static_cast<Kind>(99), 5, std::string_view("later")); }).empty());
}

TEST_CASE("versions without a common protocol say so") {
  TunnelSession session(terms_of(TunnelRole::client), Time{});
  const auto mark = std::as_bytes(std::span(kTunnelMark));
  std::vector<std::byte> bytes(mark.begin(), mark.end());
  append_frame(bytes, TunnelFrameKind::hello, 0, std::string_view("protocols 7 8\nversion 9.0\n"));
  CHECK(session.receive(bytes, Time{}) == "its version 9.0 does not speak the protocol of this version (1)");
}

TEST_CASE("a server limits its connections, and a flood of pings") {
  TunnelSession server(terms_of(TunnelRole::server), Time{});
  CHECK_FALSE(server.receive(hello_and([](auto& out) {
                               for (std::uint32_t id = 1; id <= 100; ++id) append_frame(out, TunnelFrameKind::open, id);
                             }),
                             Time{}));
  CHECK(server.connections() == 64);
  std::vector<std::byte> pings;
  for (int i = 0; i < 1000; ++i)
    append_frame(pings, TunnelFrameKind::ping, 0, std::string_view("12345678901234567890"));
  std::optional<std::string> problem;
  for (int i = 0; i < 1000 && !problem; ++i) problem = server.receive(pings, Time{});
  CHECK(problem);
  CHECK(server.outgoing().size() < std::size_t{8} << 20);
}

TEST_CASE("a silent end is asked, and then given up") {
  Pair pair;
  pair.exchange();
  CHECK(pair.client.deadline() == pair.now + 20s);
  CHECK_FALSE(pair.client.step(pair.now + 19s));
  CHECK(pair.client.outgoing().empty());
  pair.now += 20s;
  CHECK_FALSE(pair.client.step(pair.now));
  CHECK_FALSE(pair.client.outgoing().empty());
  SECTION("with an answer") {
    pair.exchange();
    CHECK_FALSE(pair.client.step(pair.now + 19s));
  }
  SECTION("without an answer") {
    CHECK_FALSE(pair.client.step(pair.now + 19s));
    CHECK(pair.client.step(pair.now + 20s) == "no answer for 40 s");
  }
}

TEST_CASE("flipped bits end a tunnel or change bytes, but hold no more than a window") {
  Pair pair;
  const auto id = pair.client.open();
  pair.client.send(id, bytes_of(std::string(3000, 'a')));
  pair.client.close(id);
  const std::vector<std::byte> good(pair.client.outgoing().begin(), pair.client.outgoing().end());
  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::byte> bad = good;
    const std::size_t at = i < static_cast<int>(good.size()) ? static_cast<std::size_t>(i) : random() % good.size();
    bad[at] ^= std::byte(1u << (random() % 8));
    TunnelSession server(terms_of(TunnelRole::server), Time{});
    (void)server.receive(bad, Time{});
    (void)server.step(Time{} + 10s);
    for (const auto opened : server.take_opened()) CHECK(server.received(opened).size() <= 65536);
  }
}

}  // namespace gs::net::tunnel_session_test
