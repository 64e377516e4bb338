#include "net/atm/cells.h"

#include <catch2/catch.hpp>

#include <algorithm>

namespace {

using namespace gs::net;

Cell sample() {
  Cell cell;
  cell.vc = {0x123, 0xabcd};
  cell.type = 1;
  cell.low_priority = true;
  for (std::size_t i = 0; i < kCellPayload; ++i) cell.payload[i] = static_cast<std::byte>(i * 5);
  return cell;
}

TEST_CASE("writes a datagram of cells, byte by byte", "[cells]") {
  const std::vector<Cell> cells{sample()};
  const auto bytes = encode_datagram(1000, 0x1234, cells);
  REQUIRE(bytes.size() == 60);
  const std::uint8_t head[] = {0x00, 0x3e, 0x81, 0x40, 0x00, 56, 0x12, 0x34, 0x12, 0x3a, 0xbc, 0xd3};
  // The length of a short packet counts the control word: 4 + 52.
  for (std::size_t i = 0; i < sizeof head; ++i)
    REQUIRE(std::to_integer<int>(bytes[i]) == (i == 4 ? 0 : i == 5 ? 56 : head[i]));
  const auto decoded = decode_datagram(bytes);
  const auto& datagram = std::get<CellDatagram>(decoded);
  REQUIRE(datagram.label == 1000);
  REQUIRE(datagram.sequence == 0x1234);
  REQUIRE(datagram.cells == cells);
  const auto full = encode_datagram(1000, 1, std::vector<Cell>(kMaxCells, sample()));
  REQUIRE(full.size() == kMaxDatagram);
  REQUIRE(kMaxDatagram <= 1400);
  REQUIRE(std::get<CellDatagram>(decode_datagram(full)).cells.size() == kMaxCells);
}

TEST_CASE("rejects truncated and invalid datagrams", "[cells]") {
  const auto good = encode_datagram(1000, 7, std::vector<Cell>(2, sample()));
  for (std::size_t size = 0; size < good.size(); ++size) {
    const bool whole = size == 60;
    REQUIRE(std::holds_alternative<CellDatagram>(decode_datagram(std::span(good).first(size))) == whole);
  }
  auto labels = good;
  labels[2] &= std::byte{0xfe};
  REQUIRE(std::get<CellError>(decode_datagram(labels)).message.find("several labels") != std::string::npos);
  auto channel = good;
  channel[4] |= std::byte{0x10};
  REQUIRE(std::holds_alternative<CellError>(decode_datagram(channel)));
}

TEST_CASE("widens 16-bit sequence numbers that skip 0", "[cells]") {
  REQUIRE(narrow_sequence(0) == 1);
  REQUIRE(narrow_sequence(65534) == 65535);
  REQUIRE(narrow_sequence(65535) == 1);
  for (const std::uint64_t running : {0ULL, 1ULL, 40000ULL, 65534ULL, 65535ULL, 65536ULL, 200000ULL, 1ULL << 40})
    for (const std::int64_t off : {-32000LL, -100LL, -1LL, 0LL, 1LL, 3LL, 20000LL, 32000LL}) {
      const std::int64_t expected = static_cast<std::int64_t>(running) + off;
      if (expected < 0) continue;
      REQUIRE(widen_sequence(narrow_sequence(running), static_cast<std::uint64_t>(expected)) == running);
    }
}

}  // namespace
