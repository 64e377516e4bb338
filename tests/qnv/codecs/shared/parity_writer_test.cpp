#include "qnv/codecs/shared/parity_writer.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <set>
#include <vector>

namespace gs::qnv::parity_writer_test {
namespace {

using Bytes = std::vector<std::byte>;

struct Written {
  std::vector<std::pair<ChunkType, Bytes>> chunks;  // in the order of the stream
  std::size_t bytes = 0, parity = 0;
};

void append(Written& written, ChunkType type, Bytes payload) {
  const std::size_t bytes = kChunkHeaderBytes + payload.size();
  written.bytes += bytes;
  written.parity += type == ChunkType::parity ? bytes : 0;
  written.chunks.emplace_back(type, std::move(payload));
}

// Writes chunks with gains that decrease like those of volumes, in chains.
Written write_chunks(const Protection& protection, std::size_t count) {
  std::mt19937 random(2);
  ParityWriter writer(protection);
  Written written;
  for (std::size_t i = 0; i < count; ++i) {
    OutgoingChunk chunk;
    chunk.type = ChunkType::values;
    chunk.payload.resize(700 + random() % 500);
    for (std::byte& b : chunk.payload) b = static_cast<std::byte>(random());
    chunk.gain = 1e9 * std::pow(static_cast<double>(i + 1), -2.5);
    chunk.chain = static_cast<std::uint32_t>(random() % 90);
    append(written, chunk.type, chunk.payload);
    for (Bytes& payload : writer.add(chunk)) append(written, ChunkType::parity, std::move(payload));
  }
  for (Bytes& payload : writer.finish()) append(written, ChunkType::parity, std::move(payload));
  return written;
}

// Drops chunks, and returns the numbers of the lost ones that parity did not restore.
std::vector<std::size_t> lost_of(const Written& written, double loss, unsigned seed) {
  std::mt19937 random(seed);
  LostChunks lost;
  std::set<Bytes> restored;
  const LostChunks::Take take = [&](ChunkType, std::span<const std::byte> payload) {
    restored.insert({payload.begin(), payload.end()});
  };
  std::vector<std::pair<std::size_t, const Bytes*>> gone;
  std::size_t number = 0;
  for (const auto& [type, payload] : written.chunks) {
    const bool drops = random() < loss * 4294967296.0;
    if (type == ChunkType::parity) {
      if (!drops) CHECK(lost.add(payload, take));
      continue;
    }
    if (drops)
      gone.emplace_back(number, &payload);
    else
      lost.keep(type, payload, take);
    ++number;
  }
  std::vector<std::size_t> left;
  for (const auto& [which, payload] : gone)
    if (!restored.contains(*payload)) left.push_back(which);
  return left;
}

}  // namespace

TEST_CASE("protection: The number of parity chunks fits the loss") {
  CHECK(parity_for(64, 0) == 0);
  CHECK(parity_for(64, 0.1) == 17);
  CHECK(parity_for(64, 0.3) == 49);
  CHECK(parity_for(4, 0.3) == 9);
  CHECK(parity_for(128, 0.5) <= 128);
  CHECK(parity_share({}) == 0);
  CHECK(parity_share({Protection::Kind::unequal}) == kUnequalShare);
}

TEST_CASE("protection: Equal protection restores the stated loss in streams of any length") {
  for (const double loss : {0.05, 0.1, 0.3, 0.5}) {
    const Protection protection{Protection::Kind::equal, loss};
    std::size_t left = 0, times = 0;
    for (const std::size_t count : {1u, 7u, 100u, 500u}) {
      const Written written = write_chunks(protection, count);
      for (unsigned seed = 0; seed < 8; ++seed, ++times) left += lost_of(written, loss, seed).empty() ? 0 : 1;
      if (count == 500)
        CHECK(static_cast<double>(written.parity) <
              (1.2 + 0.1 / loss) * parity_share(protection) * static_cast<double>(written.bytes));
    }
    INFO("loss " << loss << ": " << left << " of " << times << " streams are incomplete");
    CHECK(left <= 2);
  }
  CHECK(write_chunks({}, 50).parity == 0);
  CHECK(write_chunks({Protection::Kind::equal, 0}, 50).parity == 0);
}

TEST_CASE("protection: Unequal protection takes 3 % and restores the first chunks") {
  const Written written = write_chunks({Protection::Kind::unequal}, 1000);
  CHECK(static_cast<double>(written.parity) < 0.03 * static_cast<double>(written.bytes) + 1500);
  CHECK(written.parity > 10'000);
  std::size_t first = 0, all = 0;
  for (unsigned seed = 0; seed < 10; ++seed)
    for (const std::size_t which : lost_of(written, 0.1, seed)) {
      ++all;
      first += which < 60 ? 1 : 0;
    }
  CHECK(first < 10);
  CHECK(all > 300);
  // Every prefix has parity in proportion.
  std::size_t bytes = 0, parity = 0;
  for (const auto& [type, payload] : written.chunks) {
    bytes += kChunkHeaderBytes + payload.size();
    if (type == ChunkType::parity) parity += kChunkHeaderBytes + payload.size();
    CHECK(static_cast<double>(parity) <= 0.03 * static_cast<double>(bytes) + 1500);
  }
}

TEST_CASE("protection: Long payloads are left out") {
  ParityWriter writer({Protection::Kind::equal, 0.3});
  OutgoingChunk chunk;
  chunk.payload.resize(kMaxChunkBytes);
  for (int i = 0; i < 20; ++i) CHECK(writer.add(chunk).empty());
  CHECK(writer.finish().empty());
  chunk.payload.resize(50'000);
  (void)writer.add(chunk);
  const auto parity = writer.finish();
  REQUIRE_FALSE(parity.empty());
  CHECK(parity.front().size() <= kMaxChunkBytes);
}

}  // namespace gs::qnv::parity_writer_test
