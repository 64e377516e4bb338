#include "qnv/container/lost_chunks.h"

#include "qnv/container/cauchy_code.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace gs::qnv::lost_chunks_test {
namespace {

using Bytes = std::vector<std::byte>;
using Chunk = std::pair<ChunkType, Bytes>;

std::vector<Chunk> some_chunks(std::size_t count, std::size_t most, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Chunk> chunks;
  for (std::size_t i = 0; i < count; ++i) {
    Bytes payload(i == 6 ? 0 : 8 + random() % most);
    for (std::byte& b : payload) b = static_cast<std::byte>(random());
    chunks.emplace_back(i % 3 == 0 ? ChunkType::gaps : ChunkType::values, std::move(payload));
  }
  return chunks;
}

std::vector<Bytes> parity_of(const std::vector<Chunk>& chunks, std::size_t count) {
  std::vector<ParityMember> members;
  for (const auto& [type, payload] : chunks) members.push_back(parity_member(type, payload));
  std::vector<Bytes> parity;
  for (std::size_t i = 0; i < count; ++i) parity.push_back(encode_parity(members, members.size() + i));
  return parity;
}

// Chunks that a reader passes on beside the received ones.
struct Restored {
  LostChunks lost;
  std::vector<Chunk> chunks;
  LostChunks::Take take = [this](ChunkType type, std::span<const std::byte> payload) {
    chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
  };
  void keep(const Chunk& chunk) { lost.keep(chunk.first, chunk.second, take); }
  [[nodiscard]] std::vector<Chunk> sorted() const {
    std::vector<Chunk> all = chunks;
    std::ranges::sort(all);
    return all;
  }
};

std::vector<Chunk> sorted(std::vector<Chunk> chunks) {
  std::ranges::sort(chunks);
  return chunks;
}

}  // namespace

TEST_CASE("parity: Any chunks restore the lost ones if as many parity chunks are received") {
  for (const std::size_t members : {1u, 2u, 5u, 32u, 128u}) {
    const std::vector<Chunk> chunks = some_chunks(members, 400, 3);
    const std::size_t most = std::min<std::size_t>(members, 40);
    const std::vector<Bytes> parity = parity_of(chunks, std::min(most + 2, kMaxCodedPieces - members));
    std::mt19937 random(static_cast<unsigned>(members));
    for (std::size_t lost = 0; lost <= most; lost += members > 40 ? 13 : 1) {
      INFO(members << " chunks, " << lost << " lost");
      // Elements: numbers of chunks, then of parity.
      std::vector<std::size_t> order(members);
      for (std::size_t i = 0; i < members; ++i) order[i] = i;
      std::shuffle(order.begin(), order.end(), random);
      const std::vector<std::size_t> gone(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(lost));
      std::vector<std::size_t> come(order.begin() + static_cast<std::ptrdiff_t>(lost), order.end());
      std::vector<std::size_t> of_parity(parity.size());
      for (std::size_t i = 0; i < parity.size(); ++i) of_parity[i] = members + i;
      std::shuffle(of_parity.begin(), of_parity.end(), random);
      for (const bool enough : {true, false}) {
        if (!enough && lost == 0) continue;
        std::vector<std::size_t> arriving = come;
        arriving.insert(arriving.end(), of_parity.begin(),
                        of_parity.begin() + static_cast<std::ptrdiff_t>(enough ? lost : lost - 1));
        std::shuffle(arriving.begin(), arriving.end(), random);
        Restored reader;
        for (const std::size_t i : arriving)
          if (i < members)
            reader.keep(chunks[i]);
          else
            CHECK(reader.lost.add(parity[i - members], reader.take));
        // Too little parity restores nothing of the group.
        std::vector<Chunk> wanted;
        for (const std::size_t i : gone)
          if (enough) wanted.push_back(chunks[i]);
        CHECK(reader.sorted() == sorted(wanted));
      }
    }
  }
}

TEST_CASE("parity: Further parity of a group comes later, and restored chunks help other groups") {
  const std::vector<Chunk> chunks = some_chunks(12, 200, 5);
  // Groups 0..7 and 4..11 overlap.
  const std::vector<Chunk> front(chunks.begin(), chunks.begin() + 8), back(chunks.begin() + 4, chunks.end());
  const auto of_front = parity_of(front, 3), of_back = parity_of(back, 3);
  Restored reader;
  for (const std::size_t i : {0u, 1u, 3u, 4u, 7u, 8u, 9u, 11u}) reader.keep(chunks[i]);  // lost: 2, 5, 6, 10
  CHECK(reader.lost.add(of_front[0], reader.take));
  CHECK(reader.lost.add(of_front[0], reader.take));  // a repetition
  CHECK(reader.lost.add(of_front[2], reader.take));
  CHECK(reader.chunks.empty());
  CHECK(reader.lost.add(of_back[1], reader.take));
  CHECK(reader.lost.add(of_back[2], reader.take));
  CHECK(reader.chunks.empty());
  CHECK(reader.lost.add(of_back[0], reader.take));  // restores 5, 6 and 10, which leaves 2 to the other group
  CHECK(reader.sorted() == sorted({chunks[2], chunks[5], chunks[6], chunks[10]}));
  CHECK(reader.lost.restored() == 4);
  CHECK(reader.lost.add(of_front[1], reader.take));
  CHECK(reader.chunks.size() == 4);
}

TEST_CASE("parity: Damaged parity gives no wrong chunk") {
  const std::vector<Chunk> chunks = some_chunks(6, 60, 8);
  const std::vector<Bytes> parity = parity_of(chunks, 2);
  for (std::size_t bit = 0; bit < 8 * parity[0].size(); bit += watched_step(7)) {
    Bytes damaged = parity[0];
    damaged[bit / 8] ^= std::byte(1u << bit % 8);
    Restored reader;
    for (const std::size_t i : {0u, 2u, 3u, 5u}) reader.keep(chunks[i]);
    (void)reader.lost.add(damaged, reader.take);
    (void)reader.lost.add(parity[1], reader.take);
    for (const Chunk& chunk : reader.chunks) CHECK(std::ranges::count(chunks, chunk) == 1);
  }
  // A wrong piece with the right checksum is as good as none.
  Restored reader;
  std::vector<ParityMember> lies;
  for (const auto& [type, payload] : chunks) lies.push_back(parity_member(type, payload));
  lies[1].piece[4] ^= std::byte{1};
  for (const std::size_t i : {0u, 2u, 3u, 4u, 5u}) reader.keep(chunks[i]);
  CHECK(reader.lost.add(encode_parity(lies, 6), reader.take));
  CHECK(reader.chunks.empty());
}

TEST_CASE("parity: Hostile headers are refused") {
  Restored reader;
  const Bytes parity = parity_of(some_chunks(3, 20, 1), 1)[0];
  CHECK(read_parity(parity));
  for (std::size_t size = 0; size < 2 + 3 * 4 + 3; ++size) CHECK_FALSE(read_parity(std::span(parity).first(size)));
  const auto with = [&](std::size_t at, unsigned value) {
    Bytes bytes = parity;
    bytes[at] = static_cast<std::byte>(value);
    return bytes;
  };
  CHECK_FALSE(reader.lost.add(with(0, 0), reader.take));
  CHECK_FALSE(reader.lost.add(with(0, 129), reader.take));
  CHECK_FALSE(reader.lost.add(with(0, 255), reader.take));
  CHECK_FALSE(reader.lost.add(with(1, 2), reader.take));  // a number of a member
  CHECK(reader.lost.add(parity, reader.take));
  Bytes longer = with(1, 9);
  longer.push_back({});
  CHECK_FALSE(reader.lost.add(longer, reader.take));  // does not match its group
  CHECK(reader.lost.add(with(1, 255), reader.take));
  // Parity of parity or of a directory is not passed on.
  for (const ChunkType type : {ChunkType::parity, ChunkType::directory, static_cast<ChunkType>(200)}) {
    const ParityMember member = parity_member(type, Bytes(9));
    CHECK(reader.lost.add(encode_parity(std::span(&member, 1), 1), reader.take));
  }
  CHECK(reader.chunks.empty());
}

TEST_CASE("parity: Memory is bounded by floods of chunks and of groups") {
  std::mt19937 random(4);
  Restored reader;
  Bytes payload(60'000);
  for (std::uint32_t i = 0; i < 600; ++i) {
    for (std::size_t k = 0; k < 4; ++k) payload[k] = static_cast<std::byte>(random());
    reader.keep({ChunkType::values, payload});
    REQUIRE(reader.lost.bytes() <= LostChunks::kMostRecent);
  }
  CHECK(reader.lost.bytes() > LostChunks::kMostRecent / 2);
  Bytes parity(2 + 4 * 128 + 3);
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    for (std::byte& b : parity) b = static_cast<std::byte>(random());
    parity[0] = std::byte{128};
    parity[1] = std::byte{200};
    REQUIRE(reader.lost.add(parity, reader.take));
    REQUIRE(reader.lost.bytes() <= LostChunks::kMostRecent + LostChunks::kMostOfGroups);
  }
  CHECK(reader.chunks.empty());
  // Many groups that wait for one chunk.
  const std::vector<Chunk> chunks = some_chunks(2, 30, 6);
  const ParityMember known = parity_member(chunks[0].first, chunks[0].second);
  for (std::uint32_t i = 0; i < 3000; ++i) {
    ParityMember other = parity_member(ChunkType::values, Bytes(4));
    other.checksum = i;
    const ParityMember members[] = {known, other};
    REQUIRE(reader.lost.add(encode_parity(members, 2), reader.take));
  }
  reader.keep(chunks[0]);
  CHECK(reader.chunks.empty());
}

}  // namespace gs::qnv::lost_chunks_test
