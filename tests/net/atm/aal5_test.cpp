#include "net/atm/aal5.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <span>
#include <string_view>

namespace {

using namespace gs::net;

std::vector<std::byte> pdu_bytes(std::size_t size, unsigned seed = 1) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>((i * 31 + seed * 77 + (i >> 8)) & 255);
  return bytes;
}

std::vector<Cell> cells_of(std::span<const std::byte> bytes, Vc vc = {1, 64}, std::uint8_t user_to_user = 0) {
  std::vector<Cell> cells;
  REQUIRE(segment(bytes, vc, user_to_user, false, cells));
  return cells;
}

/// Computes the CRC as I.363.5 defines it, bit by bit.
std::uint32_t slow_crc(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const std::byte byte : bytes)
    for (int bit = 7; bit >= 0; --bit) {
      const bool top = (crc >> 31) != (std::to_integer<unsigned>(byte) >> bit & 1);
      crc = crc << 1 ^ (top ? 0x04c11db7U : 0U);
    }
  return ~crc;
}

std::vector<Pdu> push_all(Reassembler& reassembler, std::span<const Cell> cells) {
  std::vector<Pdu> out;
  for (const Cell& cell : cells) reassembler.push(cell, out);
  return out;
}

TEST_CASE("computes the CRC of AAL5", "[aal5]") {
  const std::string_view check = "123456789";
  // Check value in Ross Williams' catalogue, where the CRC is called CRC-32/BZIP2 or AAL5.
  REQUIRE(aal5_crc(std::as_bytes(std::span(check.data(), check.size()))) == 0xfc891918);
  for (const std::size_t size : {0U, 1U, 4U, 40U, 47U, 376U, 1210U, 5000U}) {
    const auto bytes = pdu_bytes(size);
    REQUIRE(aal5_crc(bytes) == slow_crc(bytes));
  }
}

TEST_CASE("packs 47 records into eight cells as in figure 6", "[aal5]") {
  const auto records = pdu_bytes(kRecordPdu);
  const auto cells = cells_of(records);
  REQUIRE(cells.size() == kRecordPduCells);
  for (std::size_t i = 0; i < 8; ++i) {
    REQUIRE(cells[i].type == (i == 7 ? 1 : 0));
    // A cell has six whole records, the last cell has five.
    REQUIRE(std::equal(records.begin() + static_cast<std::ptrdiff_t>(48 * i),
                       records.begin() + static_cast<std::ptrdiff_t>(48 * i + (i == 7 ? 40 : 48)),
                       cells[i].payload.begin()));
  }
  const auto& last = cells[7].payload;
  REQUIRE(last[40] == std::byte{0});
  REQUIRE(last[41] == std::byte{0});
  REQUIRE((std::to_integer<int>(last[42]) << 8 | std::to_integer<int>(last[43])) == 376);
}

TEST_CASE("restores PDUs of every length", "[aal5]") {
  Reassembler reassembler;
  std::size_t length = 1;
  for (; length <= kMaxPdu; length = length < 100 ? length + 1 : length * 2 - 37) {
    const auto bytes = pdu_bytes(length);
    const auto cells = cells_of(bytes, {3, 99}, 0xa5);
    REQUIRE(cells.size() == cells_of_pdu(length));
    const auto pdus = push_all(reassembler, cells);
    REQUIRE(pdus.size() == 1);
    REQUIRE(pdus[0].whole);
    REQUIRE(pdus[0].bytes == bytes);
    REQUIRE(pdus[0].user_to_user == 0xa5);
    REQUIRE(pdus[0].vc == Vc{3, 99});
  }
  const auto most = pdu_bytes(kMaxPdu);
  REQUIRE(push_all(reassembler, cells_of(most)).at(0).bytes == most);
  std::vector<Cell> none;
  REQUIRE_FALSE(segment(pdu_bytes(kMaxPdu + 1), {1, 1}, 0, false, none));
  REQUIRE_FALSE(segment({}, {1, 1}, 0, false, none));
  REQUIRE(none.empty());
}

TEST_CASE("rejects a PDU with any single wrong bit", "[aal5]") {
  const auto cells = cells_of(pdu_bytes(100));
  for (std::size_t bit = 0; bit < cells.size() * 48 * 8; bit += 1) {
    auto damaged = cells;
    damaged[bit / 384].payload[bit % 384 / 8] ^= static_cast<std::byte>(1 << bit % 8);
    Reassembler reassembler;
    REQUIRE(push_all(reassembler, damaged).empty());
    REQUIRE(reassembler.damaged() == 1);
    // The next PDU is intact.
    REQUIRE(push_all(reassembler, cells).size() == 1);
  }
}

TEST_CASE("reassembles PDUs of two channels with alternating cells", "[aal5]") {
  const auto a = cells_of(pdu_bytes(400, 1), {1, 64}), b = cells_of(pdu_bytes(400, 2), {1, 65});
  Reassembler reassembler;
  std::vector<Pdu> out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    reassembler.push(a[i], out);
    Cell oam = a[i];  // no user data, so the cell is not part of the PDU
    oam.type = 5;
    reassembler.push(oam, out);
    reassembler.push(b[i], out);
  }
  REQUIRE(out.size() == 2);
  REQUIRE(out[0].bytes == pdu_bytes(400, 1));
  REQUIRE(out[1].bytes == pdu_bytes(400, 2));
}

std::vector<Pdu> received_with_gap(std::span<const Cell> before, std::span<const Cell> after) {
  Reassembler reassembler;
  std::vector<Pdu> out;
  for (const Cell& cell : before) reassembler.push(cell, out);
  reassembler.lost_anywhere(out);
  for (const Cell& cell : after) reassembler.push(cell, out);
  return out;
}

TEST_CASE("separates two PDUs when cells around the end of the first are lost", "[aal5]") {
  const auto a = cells_of(pdu_bytes(kRecordPdu, 1)), b = cells_of(pdu_bytes(kRecordPdu, 2));
  // Three of the first and two of the second are missing.
  const std::vector<Pdu> out = received_with_gap(std::span(a).first(5), std::span(b).subspan(2, 6));
  REQUIRE(out.size() == 2);
  REQUIRE(out[0].parts.size() == 5);
  REQUIRE(out[1].parts.size() == 6);
  for (const Pdu::Part& part : out[0].parts) REQUIRE(part.payload == a[part.place].payload);
  for (const Pdu::Part& part : out[1].parts) REQUIRE(part.payload == b[part.place].payload);
}

TEST_CASE("restores the next PDU after a lost end", "[aal5]") {
  const auto a = cells_of(pdu_bytes(kRecordPdu, 1)), b = cells_of(pdu_bytes(kRecordPdu, 2));
  const std::vector<Pdu> out = received_with_gap(std::span(a).first(7), b);
  REQUIRE(out.size() == 2);
  REQUIRE(out[0].parts.size() == 7);
  REQUIRE(out[1].whole);
  REQUIRE(out[1].bytes == pdu_bytes(kRecordPdu, 2));
}

TEST_CASE("reassembles cells at the indexes that the caller gives", "[aal5]") {
  const auto a = cells_of(pdu_bytes(kRecordPdu, 1)), b = cells_of(pdu_bytes(kRecordPdu, 2));
  const Vc vc = a[0].vc;
  Reassembler reassembler;
  std::vector<Pdu> out;
  const auto put = [&](const std::vector<Cell>& cells, std::uint64_t key, std::uint32_t place) {
    reassembler.seek(vc, key, place, out);
    reassembler.push(cells[place], out);
  };
  for (std::uint32_t i = 0; i < 8; ++i) put(a, 1, i);
  REQUIRE(out.size() == 1);
  REQUIRE(out[0].whole);
  REQUIRE(out[0].key == 1);
  out.clear();
  for (const std::uint32_t i : {0U, 3U, 4U, 7U}) put(a, 2, i);
  REQUIRE(out.size() == 1);
  REQUIRE(out[0].parts.size() == 4);
  REQUIRE(out[0].key == 2);
  REQUIRE(out[0].parts[1].place == 3);
  out.clear();
  for (const std::uint32_t i : {1U, 2U}) put(a, 3, i);
  for (std::uint32_t i = 0; i < 8; ++i) put(b, 4, i);
  REQUIRE(out.size() == 2);
  REQUIRE(out[0].key == 3);
  REQUIRE(out[0].parts.size() == 2);
  REQUIRE(out[1].whole);
  REQUIRE(out[1].bytes == pdu_bytes(kRecordPdu, 2));
}

TEST_CASE("limits the memory of the reassembler", "[aal5]") {
  Reassembler reassembler(4, 1000);
  std::vector<Pdu> out;
  Cell cell;
  for (std::uint32_t i = 0; i < 200'000; ++i) {
    cell.vc = {static_cast<std::uint16_t>(i & 0xfff), static_cast<std::uint16_t>(i * 7)};
    reassembler.push(cell, out);
    REQUIRE(out.size() <= 1);
    out.clear();
  }
  // A PDU without an end cell, then a single end cell.
  cell.vc = {9, 9};
  for (int i = 0; i < 100'000; ++i) reassembler.push(cell, out);
  cell.type = 1;
  reassembler.push(cell, out);
  REQUIRE(out.size() <= 1);
  out.clear();
  REQUIRE(push_all(reassembler, cells_of(pdu_bytes(900), {9, 9})).at(0).whole);
  REQUIRE(push_all(reassembler, cells_of(pdu_bytes(2000), {9, 9})).empty());
}

}  // namespace
