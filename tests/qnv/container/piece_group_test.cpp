#include "qnv/container/piece_group.h"

#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

namespace gs::qnv::piece_group_test {
namespace {

using Bytes = std::vector<std::byte>;

std::vector<Bytes> some_payloads(std::size_t count, std::size_t most, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Bytes> payloads(count);
  for (Bytes& payload : payloads) {
    payload.resize(1 + random() % most);
    for (std::byte& b : payload) b = static_cast<std::byte>(random());
  }
  return payloads;
}

std::vector<Bytes> all_of(const CutGroup& cut) {
  std::vector<Bytes> all = cut.data;
  all.insert(all.end(), cut.parity.begin(), cut.parity.end());
  return all;
}

/// Returns the payloads that pieces restore, in the order of the pieces.
std::vector<Bytes> came(const std::vector<Bytes>& pieces) {
  PieceGroup group;
  std::vector<Bytes> out;
  for (const Bytes& piece : pieces) {
    const auto header = read_piece_header(piece);
    REQUIRE(header);
    CHECK(group.add(*header, piece));
    for (Bytes& payload : group.take()) out.push_back(std::move(payload));
  }
  return out;
}

}  // namespace

TEST_CASE("restores a group from any pieces, if they are as many as its own") {
  for (const std::size_t payloads : {1u, 3u, 9u}) {
    const std::vector<Bytes> wanted = some_payloads(payloads, 1500, 7);
    const CutGroup cut = cut_group(3, wanted, 0.75, 3);
    for (const Bytes& piece : all_of(cut)) CHECK(piece.size() <= 1200);
    CHECK(cut.parity.size() == (3 * cut.data.size() + 3) / 4 + 3);
    std::mt19937 random(1);
    std::vector<Bytes> pieces = all_of(cut);
    for (int round = 0; round < 40; ++round) {
      std::shuffle(pieces.begin(), pieces.end(), random);
      const auto first = pieces.begin();
      CHECK(came({first, first + static_cast<std::ptrdiff_t>(cut.data.size())}) == wanted);
      // If one piece is missing, only payloads at the front are restored.
      const std::vector<Bytes> less = came({first, first + static_cast<std::ptrdiff_t>(cut.data.size()) - 1});
      REQUIRE(less.size() < wanted.size());
      CHECK(std::equal(less.begin(), less.end(), wanted.begin()));
      // More pieces than needed, all repeated, restore each payload once.
      std::vector<Bytes> twice = pieces;
      twice.insert(twice.end(), pieces.begin(), pieces.end());
      CHECK(came(twice) == wanted);
    }
    CHECK(came(cut.data) == wanted);
    std::vector<Bytes> turned(cut.parity.rbegin(), cut.parity.rend());
    if (turned.size() >= cut.data.size()) CHECK(came(turned) == wanted);
  }
}

TEST_CASE("returns payloads at the front of a group before the others") {
  const std::vector<Bytes> wanted = some_payloads(12, 900, 2);
  const CutGroup cut = cut_group(0, wanted, 0, 0);
  CHECK(cut.parity.empty());
  PieceGroup group;
  std::size_t bytes = 0, taken = 0, whole = 0;
  for (const Bytes& piece : cut.data) {
    (void)group.add(*read_piece_header(piece), piece);
    taken += group.take().size();
    bytes += piece.size() - 7;
    // A length has two bytes here.
    std::size_t at = 0;
    for (whole = 0; whole < wanted.size() && at + 2 + wanted[whole].size() <= bytes; ++whole)
      at += (wanted[whole].size() < 128 ? 1 : 2) + wanted[whole].size();
    REQUIRE_EACH((taken == whole || taken == whole + 1));
  }
  CHECK(taken == wanted.size());
}

TEST_CASE("limits a large group to 256 pieces") {
  const std::vector<Bytes> wanted = some_payloads(40, 20'000, 5);
  const CutGroup cut = cut_group(15, wanted, 0.75, 3);
  CHECK(cut.data.size() == 128);
  CHECK(cut.parity.size() == 99);
  std::vector<Bytes> pieces(cut.data.begin() + 99, cut.data.end());
  pieces.insert(pieces.end(), cut.parity.begin(), cut.parity.end());
  CHECK(came(pieces) == wanted);
}

TEST_CASE("refuses invalid pieces and survives damaged ones") {
  const std::vector<Bytes> wanted = some_payloads(4, 1000, 3);
  const CutGroup cut = cut_group(2, wanted, 1, 0);
  for (std::size_t i = 0; i < cut.data[0].size(); i += 100) CHECK(!read_piece_header(std::span(cut.data[0]).first(i)));
  Bytes longer = cut.data[0];
  longer.push_back({});
  CHECK(!read_piece_header(longer));
  const auto with = [&](std::size_t at, int value) {
    Bytes changed = cut.data[0];
    changed[at] = static_cast<std::byte>(value);
    return read_piece_header(changed);
  };
  CHECK(!with(0, 96));   // an invalid group
  CHECK(!with(1, 0));    // no pieces
  CHECK(!with(1, 129));  // too many
  CHECK(!with(6, 255));  // an impossible length for its pieces
  // A piece of a different division is rejected without effect.
  PieceGroup group;
  CHECK(group.add(*read_piece_header(cut.data[0]), cut.data[0]));
  const CutGroup other = cut_group(2, some_payloads(9, 1000, 4), 1, 0);
  CHECK(!group.add(*read_piece_header(other.data[1]), other.data[1]));
  for (std::size_t i = 1; i < cut.data.size(); ++i) CHECK(group.add(*read_piece_header(cut.data[i]), cut.data[i]));
  // Random bytes of any size: the output is never longer than the input.
  std::mt19937 random(9);
  for (int round = 0; round < 300; ++round) {
    std::vector<PieceGroup> groups(1);
    std::size_t in = 0, out = 0;
    for (int k = 0; k < 12; ++k) {
      Bytes piece(7 + random() % 40);
      for (std::byte& b : piece) b = static_cast<std::byte>(random());
      piece[0] = std::byte{0};
      piece[1] = static_cast<std::byte>(1 + random() % 3);
      piece[3] = static_cast<std::byte>((piece.size() - 7) * std::to_integer<std::size_t>(piece[1]));
      piece[4] = piece[5] = piece[6] = std::byte{0};
      const auto header = read_piece_header(piece);
      if (!header) continue;
      in += piece.size();
      (void)groups[static_cast<std::size_t>(header->group)].add(*header, piece);
      for (const Bytes& payload : groups[static_cast<std::size_t>(header->group)].take()) out += payload.size();
    }
    REQUIRE_EACH(out <= in);
  }
}

}  // namespace gs::qnv::piece_group_test
