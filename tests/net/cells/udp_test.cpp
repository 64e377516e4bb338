#include "net/cells/udp.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::net;
using namespace std::chrono_literals;

TEST_CASE("sends datagrams from socket to socket", "[udp]") {
  auto left = UdpSocket::open(0, true), right = UdpSocket::open(0, true);
  REQUIRE(std::holds_alternative<UdpSocket>(left));
  REQUIRE(std::holds_alternative<UdpSocket>(right));
  auto& from = std::get<UdpSocket>(left);
  auto& to = std::get<UdpSocket>(right);
  REQUIRE(from.port() != 0);
  const auto found = find_host("127.0.0.1", to.port());
  const Endpoint endpoint = std::get<Endpoint>(found);
  Endpoint who;
  REQUIRE_FALSE(to.receive(who));
  const std::vector<std::byte> bytes(1360, std::byte{7});
  REQUIRE(from.send(endpoint, bytes));
  to.wait(5s, false, -1);
  const auto got = to.receive(who);
  REQUIRE(got);
  REQUIRE(std::vector<std::byte>(got->begin(), got->end()) == bytes);
  REQUIRE(who.port == from.port());
  REQUIRE_FALSE(from.send(endpoint, std::vector<std::byte>(70000)));
}

TEST_CASE("reports a port in use and an unknown host", "[udp]") {
  auto first = UdpSocket::open(0, true);
  const auto second = UdpSocket::open(std::get<UdpSocket>(first).port(), true);
  REQUIRE(std::get<UdpError>(second).message.find("cannot use UDP port") == 0);
  const auto nowhere = find_host("256.256.256.256.invalid", 1);
  REQUIRE(std::get<UdpError>(nowhere).message.find("cannot find the host") == 0);
}

}  // namespace
