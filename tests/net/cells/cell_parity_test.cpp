#include "net/cells/cell_parity.h"

#include "net/cells/cell_framing.h"
#include "net/cells/cell_rebuild.h"
#include "tests/net/cells/failure_odds.h"
#include "tests/net/link.h"

#include <catch2/catch.hpp>

#include <map>
#include <numeric>
#include <set>
#include <variant>

namespace {

using namespace gs::net;
using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

/// Returns the cells of a data datagram: one PDU of `count` cells.
std::vector<Cell> data_cells(std::size_t count, std::uint64_t seed) {
  Bytes user(count * kCellPayload - kAal5Trailer);
  for (std::byte& byte : user) byte = static_cast<std::byte>(Link::next_random(seed));
  std::vector<Cell> cells;
  REQUIRE(segment(user, {1, 64}, 0, true, cells));
  return cells;
}

Bytes wire(const std::vector<Cell>& cells) {
  const Bytes bytes = encode_datagram(kCellLabel, 1, cells);
  return {bytes.begin() + kDatagramHeader, bytes.end()};
}

/// Returns a sender that has a report with a loss of 20 %.
ParitySender lossy_sender() {
  ParitySender sender(true);
  sender.report(800, 200, false, 1s);
  REQUIRE(sender.on());
  return sender;
}

/// A group with its parity.
struct Sent {
  std::map<std::uint64_t, std::vector<Cell>> data, parity;
};
Sent send_group(ParitySender& sender, std::size_t members, std::uint64_t first, std::size_t step = 1) {
  Sent sent;
  std::uint64_t number = first;
  for (std::size_t i = 0; i < members; ++i, number += step) {
    sent.data[number] = data_cells(4 + i % 20, number);
    sender.add(number, wire(sent.data[number]), 2s);
  }
  (void)sender.flush(2s);
  while (sender.pending()) {
    sent.parity[number] = sender.next(number, 77);
    ++number;
  }
  return sent;
}

TEST_CASE("computes how many cells are protected", "[cell_parity]") {
  // A symbol of c cells has 48 c - 50 bytes, and a cell 52. So these results were computed by hand.
  STATIC_REQUIRE(protected_cells(26) == 23);
  STATIC_REQUIRE(protected_cells(10) == 8);
  STATIC_REQUIRE(protected_cells(7) == 5);
  STATIC_REQUIRE(protected_cells(6) == 4);
  STATIC_REQUIRE(protected_cells(4) == 4);
  for (std::size_t cells = 6; cells <= kMaxCells; ++cells)
    REQUIRE(cells_of_pdu(kParityHead + kSymbolHead + protected_cells(cells) * kPackedCell) <= cells);
}

TEST_CASE("writes a parity PDU, byte by byte", "[cell_parity]") {
  Parity parity;
  parity.symbol = 3;
  parity.time = 0x01020304;
  parity.back = 191;
  parity.members.set(0).set(9).set(190);
  const Bytes symbol(kSymbolHead + kPackedCell, std::byte{0xaa});
  const Bytes bytes = encode_parity(parity, symbol);
  REQUIRE(bytes.size() == 36 + 58);
  const int expected[] = {4, 3, 3, 0, 1, 2, 3, 4, 0, 0, 0, 191, 0x80, 0x40};
  for (std::size_t i = 0; i < 14; ++i) REQUIRE(std::to_integer<int>(bytes[i]) == expected[i]);
  for (std::size_t i = 14; i < 35; ++i) REQUIRE(bytes[i] == std::byte{0});
  REQUIRE(bytes[35] == std::byte{2});  // number 190: byte 23, bit 6
  REQUIRE(bytes[36] == std::byte{0xaa});
  std::span<const std::byte> rest;
  const auto read = decode_parity(bytes, rest);
  REQUIRE(read);
  REQUIRE(read->symbol == 3);
  REQUIRE(read->time == 0x01020304);
  REQUIRE(read->back == 191);
  REQUIRE(read->members == parity.members);
  REQUIRE(std::equal(rest.begin(), rest.end(), symbol.begin(), symbol.end()));
}

TEST_CASE("rejects parity PDUs that no sender sends", "[cell_parity]") {
  Parity good;
  good.symbol = 2;
  good.back = 5;
  good.members.set(0).set(4);
  const Bytes symbol(kSymbolHead + kPackedCell);
  std::span<const std::byte> rest;
  const Bytes bytes = encode_parity(good, symbol);
  REQUIRE(decode_parity(bytes, rest));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    REQUIRE_FALSE(decode_parity(std::span(bytes).first(size), rest));
  const auto refused = [&](auto change) {
    Parity parity = good;
    change(parity);
    return !decode_parity(encode_parity(parity, symbol), rest);
  };
  REQUIRE(refused([](Parity& parity) { parity.symbol = 1; }));    // a symbol that is a member itself
  REQUIRE(refused([](Parity& parity) { parity.symbol = 255; }));  // the symbol index is too large
  REQUIRE(refused([](Parity& parity) { parity.members.reset(); }));
  REQUIRE(refused([](Parity& parity) { parity.members.reset(0); }));
  REQUIRE(refused([](Parity& parity) { parity.back = 4; }));  // a member that is not sent yet
  REQUIRE(refused([](Parity& parity) { parity.back = 4097; }));
  REQUIRE(refused([](Parity& parity) { parity.back = 0xffffffff; }));
  REQUIRE(refused([](Parity& parity) {  // too many
    for (std::size_t i = 0; i < 65; ++i) parity.members.set(i);
    parity.symbol = 70;
    parity.back = 192;
  }));
  Bytes wrong = bytes;
  wrong[0] = std::byte{3};  // another kind
  REQUIRE_FALSE(decode_parity(wrong, rest));
  wrong = bytes;
  wrong[1] = std::byte{1};  // k differs from the number of members
  REQUIRE_FALSE(decode_parity(wrong, rest));
  REQUIRE_FALSE(decode_parity(encode_parity(good, Bytes(kSymbolHead + 27 * kPackedCell)), rest));
  REQUIRE_FALSE(decode_parity(encode_parity(good, Bytes(kSymbolHead + kPackedCell + 1)), rest));
}

TEST_CASE("restores the cells of a symbol exactly", "[cell_parity]") {
  const Bytes cells = wire(data_cells(3, 5));
  Bytes symbol = symbol_of_cells(cells);
  REQUIRE(symbol.size() == 6 + 156);
  REQUIRE(std::to_integer<int>(symbol[1]) == 156);
  symbol.resize(500);
  const auto read = cells_of_symbol(symbol);
  REQUIRE(read);
  REQUIRE(std::equal(read->begin(), read->end(), cells.begin(), cells.end()));
  for (std::size_t bit = 0; bit < (6 + 156) * 8; ++bit) {
    Bytes damaged = symbol;
    damaged[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    REQUIRE_FALSE(cells_of_symbol(damaged));
  }
  for (std::size_t size = 0; size < 6 + 156; ++size) REQUIRE_FALSE(cells_of_symbol(std::span(symbol).first(size)));
  REQUIRE_FALSE(cells_of_symbol(Bytes(100)));  // an empty datagram
}

TEST_CASE("estimates the loss rate and its pattern", "[cell_parity]") {
  LossMeter meter;
  REQUIRE(meter.share() == 0);
  REQUIRE(meter.likely() == 0);
  meter.add(90, 10, 1s);
  REQUIRE(meter.share() == Approx(0.1));
  // 1.1 * 0.1 + 0.002 + sqrt(0.1 * 0.9 / 100)
  REQUIRE(meter.likely() == Approx(0.142));
  // Much later, at most 128 earlier datagrams still count. Here these are all 100.
  meter.add(190, 10, 100s);
  REQUIRE(meter.share() == Approx(0.05));
  // 128 of the 200 datagrams still count; 6.4 of them are lost.
  meter.add(290, 110, 200s);
  REQUIRE(meter.share() == Approx(106.4 / 328));
  // A client's totals cannot decrease, so this report is invalid.
  meter.add(0, 0, 200s);
  REQUIRE(meter.share() == Approx(106.4 / 328));
  meter.add(~std::uint64_t{0}, ~std::uint64_t{0}, 100s);
  REQUIRE(meter.share() <= 1);
  REQUIRE(meter.likely() <= 0.9);

  // Losses are independent, then in runs of four. For long spans, runs of four have an index of dispersion of (1 +
  // 0.722) / (1 - 0.722) = 6.2.
  std::uint64_t random = 3;
  const auto runs = [&](double burst) {
    LossMeter measured;
    std::uint64_t received = 0, lost = 0;
    bool bad = false;
    double sum = 0;
    const auto chance = [&](double p) { return static_cast<double>(Link::next_random(random) >> 11) * 0x1p-53 < p; };
    for (int i = 1; i <= 400; ++i) {
      for (int k = 0; k < 100; ++k) {
        bad = burst > 1 ? (bad ? !chance(1 / burst) : chance(0.1 / 0.9 / burst)) : chance(0.1);
        ++(bad ? lost : received);
      }
      measured.add(received, lost, i * 100ms);
      if (i > 200) sum += measured.runs() / 200;
    }
    REQUIRE(measured.share() == Approx(0.1).margin(0.03));
    return sum;
  };
  REQUIRE(runs(1) < 1.4);
  const double bursts = runs(4);
  REQUIRE(bursts > 4);
  REQUIRE(bursts < 8);
}

TEST_CASE("restores a group from any k of its datagrams", "[cell_parity]") {
  std::uint64_t random = 4;
  for (const std::size_t members : {1U, 2U, 7U, 33U, 64U})
    for (const std::size_t step : {1U, 3U}) {
      ParitySender sender = lossy_sender();
      const Sent sent = send_group(sender, members, 1000, step);
      REQUIRE(sent.parity.size() >= 1);
      // With 20 % lost, 99 of 100 groups must survive 22.2 % + 1.3 %.
      REQUIRE(failure_of(members, members + sent.parity.size(), 0.222) < 0.0101);
      REQUIRE(sent.parity.size() <= std::max<std::size_t>(2 * members, 8));
      std::vector<std::uint64_t> numbers;
      for (const auto& [number, cells] : sent.data) numbers.push_back(number);
      const std::size_t data_count = numbers.size();
      for (const auto& [number, cells] : sent.parity) numbers.push_back(number);
      for (int round = 0; round < 4; ++round) {
        // The symbols are received in any order, each twice. The maximum number of symbols is lost.
        for (std::size_t i = numbers.size(); i-- > 1;)
          std::swap(numbers[i], numbers[Link::next_random(random) % (i + 1)]);
        CellRebuilder rebuilder;
        std::vector<CellRebuilder::Rebuilt> rebuilt;
        std::set<std::uint64_t> came;
        for (std::size_t i = 0; i < data_count; ++i)
          for (int twice = 0; twice < 2; ++twice) {
            const std::uint64_t number = numbers[i];
            if (const auto parity = sent.parity.find(number); parity != sent.parity.end()) {
              REQUIRE(CellRebuilder::is_parity(parity->second));
              const auto head = rebuilder.add_parity(number, parity->second, rebuilt);
              REQUIRE(head);
              REQUIRE(head->time == 77);
            } else {
              came.insert(number);
              rebuilder.add(number, wire(sent.data.at(number)), rebuilt);
            }
            if (i + 1 < data_count) REQUIRE(rebuilt.empty());
          }
        REQUIRE(rebuilt.size() + came.size() == members);
        for (const auto& [number, cells] : rebuilt) {
          REQUIRE(came.insert(number).second);
          REQUIRE(cells == sent.data.at(number));
        }
      }
    }
}

TEST_CASE("sends no parity without loss", "[cell_parity]") {
  ParitySender sender(true);
  REQUIRE(sender.on());  // the loss is not known yet
  for (std::uint64_t i = 0; i < 100; ++i) sender.add(i, wire(data_cells(20, i)), Instant(i));
  REQUIRE_FALSE(sender.pending());
  const std::uint64_t group = sender.flush(1ms);
  REQUIRE(group == 2);  // two groups, of 64 and of 36 members
  REQUIRE_FALSE(sender.settled(group));
  sender.report(30, 0, false, 1s);
  REQUIRE(sender.on());
  sender.report(100, 0, false, 2s);
  REQUIRE_FALSE(sender.on());
  REQUIRE_FALSE(sender.pending());
  REQUIRE(sender.settled(group));
  // A loss of 1 of 1,100 is below 0.2 %, a loss of 11 is not.
  sender.report(1100, 1, false, 3s);
  REQUIRE_FALSE(sender.on());
  sender.report(1200, 11, false, 3s);
  REQUIRE(sender.on());
  ParitySender off(false);
  REQUIRE_FALSE(off.on());
  off.report(50, 50, false, 1s);
  off.add(0, wire(data_cells(20, 0)), 1s);
  REQUIRE(off.flush(1s) == 0);
  REQUIRE(off.settled(0));
}

TEST_CASE("sends parity for earlier data after the first reported loss", "[cell_parity]") {
  ParitySender sender(true);
  for (std::uint64_t i = 0; i < 128; ++i) sender.add(i, wire(data_cells(20, i)), Instant(i));
  REQUIRE_FALSE(sender.pending());
  sender.report(90, 10, false, 1s);
  std::map<std::uint32_t, std::size_t> parity;  // by the group's first running number
  for (std::uint64_t number = 128; sender.pending(); ++number) {
    const auto cells = sender.next(number, 0);
    CellRebuilder rebuilder;
    std::vector<CellRebuilder::Rebuilt> rebuilt;
    const auto head = rebuilder.add_parity(number, cells, rebuilt);
    REQUIRE(head);
    ++parity[static_cast<std::uint32_t>(number) - head->back];
  }
  REQUIRE(parity.size() == 2);
  REQUIRE(parity[0] == parity[64]);
  REQUIRE(parity[0] >= 12);
  // A higher loss adds parity to the same groups.
  sender.report(150, 90, false, 1100ms);
  REQUIRE(sender.pending());
}

TEST_CASE("ends a group in time, and after 192 numbers at the latest", "[cell_parity]") {
  ParitySender sender = lossy_sender();
  for (std::uint64_t i = 0; i < 8; ++i) {
    REQUIRE_FALSE(sender.pending());
    sender.add(i, wire(data_cells(20, i)), 1s + Instant(100'000 * i));
  }
  REQUIRE(sender.pending());  // eight members after 0.7 s
  ParitySender spread = lossy_sender();
  for (std::uint64_t i = 0; i < 3; ++i) spread.add(i * 96, wire(data_cells(20, i)), 1s);
  REQUIRE(spread.pending());  // the group has 0 and 96; 192 starts a new group
  const auto cells = spread.next(193, 0);
  CellRebuilder rebuilder;
  std::vector<CellRebuilder::Rebuilt> rebuilt;
  const auto head = rebuilder.add_parity(193, cells, rebuilt);
  REQUIRE(head);
  REQUIRE(head->back == 193);
  REQUIRE(head->members.count() == 2);
  REQUIRE(head->members[96]);
}

TEST_CASE("limits the memory of a sender, and sends parity between the data", "[cell_parity]") {
  ParitySender sender = lossy_sender();
  std::size_t parity = 0, data = 0, in_a_row = 0;
  for (std::uint64_t number = 0; number < 20'000; ++number) {
    if (sender.due()) {
      REQUIRE_FALSE(sender.next(number, 0).empty());
      ++parity;
      REQUIRE(++in_a_row < 3);
    } else {
      sender.add(number, wire(data_cells(23, 1)), 2s);
      ++data;
      in_a_row = 0;
    }
  }
  const double each = static_cast<double>(parity) / static_cast<double>(data);
  REQUIRE(each > 0.25);
  REQUIRE(each < 0.6);
}

TEST_CASE("limits many small groups", "[cell_parity]") {
  ParitySender sender = lossy_sender();
  for (std::uint64_t number = 0; number < 500; ++number) {
    sender.add(number, wire(data_cells(4, 1)), 2s);
    (void)sender.flush(2s);
  }
  std::size_t parity = 0;
  for (std::uint64_t number = 500; sender.pending(); ++number, ++parity) REQUIRE_FALSE(sender.next(number, 0).empty());
  REQUIRE(parity > 0);
  REQUIRE(parity <= ParitySender::kMaxGroups * 8);
}

TEST_CASE("rejects damaged and hostile parity", "[cell_parity]") {
  ParitySender sender = lossy_sender();
  const Sent sent = send_group(sender, 20, 1000);
  const auto lost = sent.data.begin()->first;
  std::vector<CellRebuilder::Rebuilt> rebuilt;
  const auto with_data = [&] {
    CellRebuilder rebuilder;
    for (const auto& [number, cells] : sent.data)
      if (number != lost) rebuilder.add(number, wire(cells), rebuilt);
    return rebuilder;
  };
  const auto& [number, cells] = *sent.parity.begin();
  // A flipped bit fails the PDU's CRC, or the PDU is no parity.
  for (std::size_t bit = 0; bit < cells.size() * kCellPayload * 8; bit += 37) {
    auto damaged = cells;
    damaged[bit / 8 / kCellPayload].payload[bit / 8 % kCellPayload] ^= static_cast<std::byte>(1 << bit % 8);
    CellRebuilder rebuilder = with_data();
    REQUIRE_FALSE(rebuilder.add_parity(number, damaged, rebuilt));
    REQUIRE(rebuilt.empty());
  }
  // A part of the PDU restores nothing.
  for (std::size_t count = 0; count < cells.size(); ++count) {
    CellRebuilder rebuilder = with_data();
    REQUIRE_FALSE(rebuilder.add_parity(number, std::span(cells).first(count), rebuilt));
  }
  // A valid PDU with a foreign symbol, other members, or another size. After that, correct parity may restore nothing,
  // but never wrong data.
  std::vector<Pdu> pdus;
  Reassembler reassembler;
  for (const Cell& cell : cells) reassembler.push(cell, pdus);
  std::span<const std::byte> symbol;
  const auto head = decode_parity(pdus.at(0).bytes, symbol);
  REQUIRE(head);
  const auto put = [&](CellRebuilder& rebuilder, const Parity& parity, const Bytes& bytes) {
    std::vector<Cell> made;
    REQUIRE(segment(encode_parity(parity, bytes), kParityVc, 0, true, made));
    return rebuilder.add_parity(number, made, rebuilt).has_value();
  };
  const Bytes right(symbol.begin(), symbol.end());
  Bytes wrong = right;
  wrong[0] ^= std::byte{1};
  wrong[300] ^= std::byte{64};
  {
    CellRebuilder rebuilder = with_data();
    REQUIRE(put(rebuilder, *head, wrong));
    REQUIRE(rebuilt.empty());
  }
  {
    Parity other = *head;
    other.members.reset(5).set(25);
    other.back = static_cast<std::uint32_t>(number - lost) + 0;
    CellRebuilder rebuilder = with_data();
    if (other.back > 25) REQUIRE(put(rebuilder, other, right));
    REQUIRE(rebuilt.empty());
  }
  {
    CellRebuilder rebuilder = with_data();
    REQUIRE(put(rebuilder, *head, Bytes(kSymbolHead + kPackedCell)));  // the symbol is shorter than the members
    REQUIRE(rebuilt.empty());
  }
  {
    CellRebuilder rebuilder;  // the rebuilder has no other data of the group
    for (std::uint8_t i = 20; i < 39; ++i) {
      Parity parity = *head;
      parity.symbol = i;
      REQUIRE(put(rebuilder, parity, i == 30 ? Bytes(kSymbolHead + kPackedCell) : wrong));
    }
    REQUIRE(rebuilt.empty());
  }
  {
    CellRebuilder rebuilder;
    Parity parity = *head;
    std::vector<Cell> made;
    REQUIRE(segment(encode_parity(parity, right), kParityVc, 0, true, made));
    REQUIRE_FALSE(rebuilder.add_parity(3, made, rebuilt));  // the group would start before the first datagram
  }
  // Now the rebuilder has all data of the group again.
  CellRebuilder rebuilder = with_data();
  REQUIRE(put(rebuilder, *head, right));
  REQUIRE(rebuilt.size() == 1);
  REQUIRE(rebuilt[0].number == lost);
  REQUIRE(rebuilt[0].cells == sent.data.at(lost));
}

TEST_CASE("bounds the datagrams that a client keeps for parity", "[cell_parity]") {
  CellRebuilder rebuilder;
  std::vector<CellRebuilder::Rebuilt> rebuilt;
  std::uint64_t random = 8;
  const Bytes symbol(kSymbolHead + 23 * kPackedCell);
  for (std::uint64_t number = 5000; number < 25'000; ++number) {
    if (number % 2 == 0) {
      rebuilder.add(number + Link::next_random(random) % 1000, wire(data_cells(number % 7 == 0 ? 26 : 4, 1)), rebuilt);
    } else {
      Parity parity;
      for (std::size_t i = 0; i < 64; ++i) parity.members.set(i);
      parity.symbol = static_cast<std::uint8_t>(64 + Link::next_random(random) % 191);
      parity.back = static_cast<std::uint32_t>(64 + Link::next_random(random) % 4000);
      std::vector<Cell> cells;
      REQUIRE(segment(encode_parity(parity, symbol), kParityVc, 0, true, cells));
      REQUIRE(rebuilder.add_parity(number, cells, rebuilt));
    }
    REQUIRE(rebuilder.bytes() <= CellRebuilder::kMaxKept + CellRebuilder::kMaxParity);
  }
  REQUIRE(rebuilt.empty());
}

}  // namespace
