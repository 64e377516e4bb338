#include "net/cells/cell_contract.h"

#include "tests/net/link.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::net;

Endpoint endpoint(std::uint8_t last, std::uint16_t port = 4000) {
  Endpoint result;
  result.address[15] = last;
  result.port = port;
  return result;
}

std::vector<ContractMessage> samples() {
  RequestMessage request;
  request.cookie = {1, 2, 3};
  request.number = 9;
  request.slot = 3;
  request.rate = 5'000'000;
  request.path = "worlds/head.qnv";
  GrantMessage grant;
  grant.session = 77;
  grant.number = 9;
  grant.base = {15000, 1216, 13};
  grant.base_crc = 0xdeadbeef;
  grant.streams = {{true, 1000}, {false, 20}};
  ReportMessage report;
  report.session = 77;
  report.number = 4;
  report.loss_rate = 12345;
  report.slots.resize(2);
  report.slots[1].slot = 7;
  report.slots[1].base_done = true;
  report.slots[1].regions = {{{1, 2, 3, 4, 5, 6}, 9}};
  report.slots[1].wishes = {{{2, 1000}, 16}, {{0, 5}, 1}};
  SyncMessage sync;
  sync.session = 77;
  sync.next = std::uint64_t{1} << 40;
  sync.slots = {{3, 9, true, 123456}};
  return {HelloMessage{42},
          CookieMessage{1, 2, 3},
          request,
          grant,
          RefuseMessage{1, 9, 3, Refusal::full, "no room"},
          report,
          sync,
          ByeMessage{77, "done"}};
}

TEST_CASE("restores messages from their bytes", "[cell_contract]") {
  for (const ContractMessage& message : samples()) {
    const auto bytes = encode_contract(message);
    const auto decoded = decode_contract(bytes);
    REQUIRE(decoded);
    REQUIRE(decoded->index() == message.index());
    REQUIRE(encode_contract(*decoded) == bytes);
  }
  const auto request = std::get<RequestMessage>(*decode_contract(encode_contract(samples()[2])));
  REQUIRE(request.cookie == CookieMessage{1, 2, 3});
  REQUIRE(request.path == "worlds/head.qnv");
  REQUIRE(request.slot == 3);
  const auto report = std::get<ReportMessage>(*decode_contract(encode_contract(samples()[5])));
  REQUIRE(report.slots[1].wishes == std::vector<ChunkRun>{{{2, 1000}, 16}, {{0, 5}, 1}});
  REQUIRE(report.slots[1].regions[0].box == CellBox{1, 2, 3, 4, 5, 6});
  REQUIRE(report.slots[1].base_done);
}

TEST_CASE("limits messages to one datagram", "[cell_contract]") {
  RequestMessage request;
  request.slot = 1;
  request.path = std::string(5000, 'x');
  REQUIRE(encode_contract(request).size() < 1200);
  RefuseMessage refusal;
  refusal.text = std::string(5000, 'x');
  REQUIRE(std::get<RefuseMessage>(*decode_contract(encode_contract(refusal))).text.size() == kMaxText);
}

TEST_CASE("rejects every prefix of a message, and invalid values", "[cell_contract]") {
  for (const ContractMessage& message : samples()) {
    const auto bytes = encode_contract(message);
    // Hellos and reports are padded at the end.
    const bool filled = message.index() == 0 || message.index() == 5;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const auto decoded = decode_contract(std::span(bytes).first(size));
      if (!filled) REQUIRE_FALSE(decoded);
    }
  }
  auto grant = std::get<GrantMessage>(samples()[3]);
  grant.base.source = 0;
  REQUIRE_FALSE(decode_contract(encode_contract(grant)));
  grant.base = {0xffffffff, 8, 1};
  REQUIRE_FALSE(decode_contract(encode_contract(grant)));
  grant.base = {15000, 1216, 13};
  grant.streams[0].chunks = 0xffffffff;
  REQUIRE_FALSE(decode_contract(encode_contract(grant)));
  auto request = std::get<RequestMessage>(samples()[2]);
  request.slot = 8;
  REQUIRE_FALSE(decode_contract(encode_contract(request)));
  request.slot = 1;
  request.cells = 27;
  REQUIRE_FALSE(decode_contract(encode_contract(request)));
}

TEST_CASE("survives random bytes after the header", "[cell_contract]") {
  std::uint64_t random = 3;
  for (int i = 0; i < 20000; ++i) {
    auto bytes = encode_contract(samples()[Link::next_random(random) % 8]);
    for (int k = 0; k < 4; ++k)
      bytes[9 + Link::next_random(random) % (bytes.size() - 9)] = static_cast<std::byte>(Link::next_random(random));
    if (const auto message = decode_contract(bytes)) {
      // A decoded message can be encoded again.
      REQUIRE(decode_contract(encode_contract(*message)));
    }
  }
}

TEST_CASE("accepts a cookie for its own address and nonce only", "[cell_contract]") {
  const CookieMaker maker({11, 22}), other({11, 23});
  const Instant now{5'000'000};
  const CookieMessage cookie = maker.make(endpoint(1), 99, now);
  REQUIRE(maker.age(cookie, endpoint(1), now + Instant(70'000)) == Instant(70'000));
  REQUIRE_FALSE(maker.age(cookie, endpoint(2), now));
  REQUIRE_FALSE(maker.age(cookie, endpoint(1, 4001), now));
  REQUIRE_FALSE(other.age(cookie, endpoint(1), now));
  CookieMessage changed = cookie;
  changed.time += 1;
  REQUIRE_FALSE(maker.age(changed, endpoint(1), now));
  changed = cookie;
  changed.nonce += 1;
  REQUIRE_FALSE(maker.age(changed, endpoint(1), now));
  REQUIRE(maker.session(endpoint(1), 99) != maker.session(endpoint(1), 98));
}

}  // namespace
