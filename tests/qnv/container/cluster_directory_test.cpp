#include "qnv/container/cluster_directory.h"

#include "qnv/base/short_number.h"
#include "tests/qnv/pinned_vectors.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace cluster_directory_test {

using Bytes = std::vector<std::byte>;

const Box kWhole{{-5, 0, 2}, {7, 1, 30}};

StreamHeader header_of_gaussians() {
  StreamHeader header;
  header.payload = Payload::gaussians;
  header.description.box = kWhole;
  return header;
}

/// Returns a box inside another one.
Box part_of(const Box& box, std::mt19937& random) {
  Box part;
  for (int corner = 0; corner < 2; ++corner) {
    const auto place = [&] { return static_cast<float>(random() % 1001) / 1000; };
    part.add(box.lower + box.size() * glm::vec3(place(), place(), place()));
  }
  return part;
}

/// Returns the entries of a random tree, with chunks of harmonics, and with parity between the chunks.
std::vector<DirectoryEntry> random_entries(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<DirectoryEntry> entries, clusters;
  std::uint64_t at = 121;
  for (std::size_t i = 0; i < count; ++i) {
    DirectoryEntry entry;
    if (random() % 40 == 0) at += random() % 3000;
    entry.offset = at;
    entry.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + 1 + random() % 1200);
    at += entry.bytes;
    if (clusters.empty()) {
      entry.parent = 0xffffffff;
      entry.vectors = 60;
      entry.box = kWhole;
      clusters.push_back(entry);
    } else {
      const auto reach = std::min<std::size_t>(clusters.size(), 500);
      entry.parent = static_cast<std::uint32_t>(clusters.size() - 1 - random() % reach);
      const DirectoryEntry& parent = clusters[entry.parent];
      entry.level = parent.level;
      entry.box = parent.box;
      if (random() % 5 > 0 && parent.level < 40) {
        ++entry.level;
        entry.vectors = static_cast<std::uint32_t>(1 + random() % 300);
        // Some boxes exceed the box of their parent.
        entry.box = part_of(random() % 10 == 0 ? kWhole : parent.box, random);
        clusters.push_back(entry);
      }
    }
    entries.push_back(entry);
  }
  return entries;
}

/// Returns all entries of a directory. Requires that all chunks are valid.
std::vector<DirectoryEntry> read_clusters(std::span<const Bytes> payloads) {
  DirectoryReader reader(header_of_gaussians());
  std::vector<DirectoryEntry> entries;
  for (const Bytes& payload : payloads) REQUIRE(reader.add(ChunkType::cluster_directory, payload, entries));
  return entries;
}

/// Checks that `outer` contains `inner`. On each side, it may be larger by 1/32 of `parent`, plus the rounding to
/// 1/65535 of the whole box.
void check_contains(const Box& outer, const Box& inner, const Box& parent) {
  for (int axis = 0; axis < 3; ++axis) {
    const float rounding = kWhole.size()[axis] / 65535 * 2 + 1e-5f;
    REQUIRE(outer.lower[axis] <= inner.lower[axis] + 1e-5f);
    REQUIRE(outer.upper[axis] >= inner.upper[axis] - 1e-5f);
    const float step = parent.size()[axis] / 32 + rounding;
    REQUIRE(outer.lower[axis] >= inner.lower[axis] - step);
    REQUIRE(outer.upper[axis] <= inner.upper[axis] + step);
  }
}

TEST_CASE("restores a directory of clusters with boxes that are never smaller") {
  for (const std::size_t count : {1u, 2u, 700u, 40'000u}) {
    const std::vector<DirectoryEntry> entries = random_entries(count, static_cast<std::uint32_t>(count));
    const auto payloads = pack_clusters(entries, kWhole);
    REQUIRE(payloads);
    CHECK(payloads->size() == (count > 30'000 ? payloads->size() : 1));
    std::size_t bytes = 0;
    for (const Bytes& payload : *payloads) {
      CHECK(payload.size() <= kMaxChunkBytes);
      bytes += payload.size();
    }
    CHECK(bytes < 12 * count + 40);
    const std::vector<DirectoryEntry> back = read_clusters(*payloads);
    REQUIRE(back.size() == entries.size());
    std::vector<std::size_t> clusters;  // their entries
    for (std::size_t i = 0; i < back.size(); ++i) {
      CHECK(back[i].offset == entries[i].offset);
      CHECK(back[i].bytes == entries[i].bytes);
      CHECK(back[i].level == entries[i].level);
      CHECK(back[i].parent == entries[i].parent);
      CHECK(back[i].vectors == entries[i].vectors);
      const bool harmonics = entries[i].vectors == 0;
      if (!harmonics) clusters.push_back(i);
      const Box& parent = i == 0 ? kWhole : back[clusters[entries[i].parent]].box;
      if (harmonics)
        CHECK(back[i].box.lower == parent.lower);
      else
        check_contains(back[i].box, entries[i].box, parent);
    }
  }
}

TEST_CASE("a directory of clusters continues from chunk to chunk") {
  const std::vector<DirectoryEntry> entries = random_entries(40'000, 3);
  const auto payloads = pack_clusters(entries, kWhole);
  REQUIRE(payloads);
  REQUIRE(payloads->size() > 2);
  const auto add = [&](DirectoryReader& reader, std::size_t i, std::vector<DirectoryEntry>& to) {
    return reader.add(ChunkType::cluster_directory, (*payloads)[i], to);
  };
  std::vector<DirectoryEntry> all;
  DirectoryReader without_first(header_of_gaussians());
  CHECK_FALSE(add(without_first, 1, all));
  CHECK(all.empty());
  CHECK(add(without_first, 0, all));
  CHECK(add(without_first, 1, all));
  all.clear();
  DirectoryReader without_second(header_of_gaussians());
  CHECK(add(without_second, 0, all));
  const std::size_t first = all.size();
  CHECK_FALSE(add(without_second, 2, all));
  CHECK(all.size() == first);
  DirectoryReader twice(header_of_gaussians());
  all.clear();
  CHECK(add(twice, 0, all));
  CHECK_FALSE(add(twice, 0, all));
  CHECK(all.size() == first);
  CHECK(add(twice, 1, all));
  DirectoryReader damaged(header_of_gaussians());
  Bytes bytes = payloads->front();
  bytes.resize(bytes.size() / 2);
  all.clear();
  CHECK_FALSE(damaged.add(ChunkType::cluster_directory, bytes, all));
  CHECK_FALSE(add(damaged, 0, all));  // after an invalid chunk, nothing is read
  CHECK(all.empty());
}

TEST_CASE("reads general directories of all streams, and compact ones of Gaussians only") {
  const std::vector<DirectoryEntry> entries = random_entries(300, 5);
  const Bytes general = encode_directory(entries, kWhole);
  const auto compact = pack_clusters(entries, kWhole);
  REQUIRE(compact);
  for (const Payload payload : {Payload::gaussians, Payload::packed, Payload::values}) {
    StreamHeader header = header_of_gaussians();
    header.payload = payload;
    DirectoryReader reader(header);
    std::vector<DirectoryEntry> all;
    CHECK(reader.add(ChunkType::directory, std::span(general).subspan(kChunkHeaderBytes), all));
    CHECK(all.size() == entries.size());
    CHECK(reader.add(ChunkType::cluster_directory, compact->front(), all) == (payload == Payload::gaussians));
    CHECK_FALSE(reader.add(ChunkType::places, compact->front(), all));
    CHECK_FALSE(reader.add(ChunkType::gaussians, compact->front(), all));
  }
}

TEST_CASE("does not pack entries that the directory of clusters cannot express") {
  const std::vector<DirectoryEntry> sound = random_entries(20, 5);
  REQUIRE(pack_clusters(sound, kWhole));
  const auto refused = [&](auto change) {
    std::vector<DirectoryEntry> entries = sound;
    change(entries);
    return !pack_clusters(entries, kWhole);
  };
  CHECK(refused([](auto& e) { e[0].parent = 0; }));
  CHECK(refused([](auto& e) { e[0].level = 1; }));
  CHECK(refused([](auto& e) { e[0].vectors = 0; }));
  CHECK(refused([](auto& e) { e[3].parent = 0xffffffff; }));
  CHECK(refused([](auto& e) { e[3].parent = 19; }));
  CHECK(refused([](auto& e) { e[3].level = 9; }));
  CHECK(refused([](auto& e) { e[3].bytes = kChunkHeaderBytes; }));
  CHECK(refused([](auto& e) { e[3].bytes = 5000; }));
  CHECK(refused([](auto& e) { e[3].offset = 7; }));
  CHECK(refused([](auto& e) { e[19].offset += std::uint64_t{1} << 24; }));
  CHECK(refused([](auto& e) { e[1].vectors = 20'000; }));
  CHECK(refused([](auto& e) { std::swap(e[1].box.lower, e[1].box.upper); }));
  std::vector<DirectoryEntry> deep;
  for (std::uint32_t level = 0; level < 256; ++level) {
    DirectoryEntry entry{.offset = 100 + 60 * level, .bytes = 60, .parent = level - 1, .vectors = 9, .box = kWhole};
    entry.level = static_cast<std::uint8_t>(level);
    deep.push_back(entry);
  }
  CHECK_FALSE(pack_clusters(deep, kWhole));
  deep.pop_back();
  const auto payloads = pack_clusters(deep, kWhole);
  REQUIRE(payloads);
  CHECK(read_clusters(*payloads).back().level == 254);
}

// Requires entries within the limits of the format.
void check_limits(std::span<const DirectoryEntry> entries) {
  std::uint64_t end = 0;
  std::uint32_t clusters = 0;
  for (const DirectoryEntry& entry : entries) {
    REQUIRE(entry.offset >= end);
    REQUIRE(entry.bytes > kChunkHeaderBytes);
    REQUIRE(entry.bytes < kChunkHeaderBytes + 2048);
    REQUIRE(entry.vectors <= 1u << 14);
    REQUIRE(entry.level < 255);
    REQUIRE((entry.parent < clusters || (clusters == 0 && entry.parent == 0xffffffff)));
    for (int axis = 0; axis < 3; ++axis) {
      REQUIRE(entry.box.lower[axis] <= entry.box.upper[axis]);
      REQUIRE(entry.box.lower[axis] >= kWhole.lower[axis]);
      REQUIRE(entry.box.upper[axis] <= kWhole.upper[axis] + 1e-4f);
    }
    end = entry.offset + entry.bytes;
    if (entry.vectors > 0) ++clusters;
  }
}

TEST_CASE("truncated and mutated directories of clusters are refused or harmless") {
  const auto payloads = pack_clusters(random_entries(300, 11), kWhole);
  REQUIRE(payloads);
  const Bytes& payload = payloads->front();
  std::mt19937 random(11);
  const auto add = [](std::span<const std::byte> bytes) {
    DirectoryReader reader(header_of_gaussians());
    std::vector<DirectoryEntry> entries;
    const bool good = reader.add(ChunkType::cluster_directory, bytes, entries);
    CHECK(good == !entries.empty());
    check_limits(entries);
    return good;
  };
  // A decoder reads up to eight zeros after the end.
  for (std::size_t size = 0; size < payload.size(); ++size)
    CHECK((size + 12 > payload.size() || !add(std::span(payload).first(size))));
  for (int i = 0; i < 3000; ++i) {
    Bytes mutated = payload;
    mutated[random() % mutated.size()] = static_cast<std::byte>(random() % 256);
    (void)add(mutated);
  }
  for (int i = 0; i < 300; ++i) {
    Bytes noise;
    put_number(noise, 0);
    put_number(noise, 1 + random() % 20'000);
    const int kind = i % 3;
    for (std::size_t k = random() % 5000; k > 0; --k)
      noise.push_back(kind == 0 ? std::byte{0} : kind == 1 ? std::byte{255} : static_cast<std::byte>(random()));
    (void)add(noise);
  }
}

// An encoder once wrote gaussians_directory.qnv in tests/qnv/vectors/v1. gaussians_directory.py, written from FORMAT.md
// alone, made the .txt file, and compared it with the chunks. Never regenerate any.
TEST_CASE("decodes a pinned directory of clusters") {
  const Bytes bytes = read_bytes("gaussians_directory.qnv");
  std::size_t header_bytes = 0;
  bool need_more = false;
  const auto decoded = decode_header(bytes, header_bytes, need_more);
  REQUIRE(std::holds_alternative<StreamHeader>(decoded));
  const auto& header = std::get<StreamHeader>(decoded);
  const auto chunk = std::span(bytes).subspan(static_cast<std::size_t>(header.directory));
  const auto head = chunk_head(chunk);
  REQUIRE(head);
  REQUIRE(head->bytes == chunk.size());
  CHECK(head->type == ChunkType::cluster_directory);
  std::vector<DirectoryEntry> entries;
  REQUIRE(DirectoryReader(header).add(head->type, chunk.subspan(kChunkHeaderBytes), entries));
  CHECK(entries.size() == header.chunks);
  const Box& whole = header.description.box;
  std::string text;
  for (const DirectoryEntry& entry : entries) {
    const auto parent = entry.parent == 0xffffffff ? std::string("-1") : std::to_string(entry.parent);
    text += std::to_string(entry.offset) + ' ' + std::to_string(entry.bytes - kChunkHeaderBytes) + ' ' +
            std::to_string(entry.level) + ' ' + parent + ' ' + std::to_string(entry.vectors);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto axis = static_cast<int>(i % 3);
      const float at = (i < 3 ? entry.box.lower : entry.box.upper)[axis];
      text += ' ' + std::to_string(std::lround((at - whole.lower[axis]) / whole.size()[axis] * 65535));
    }
    text += '\n';
  }
  CHECK(text == read_text("gaussians_directory.txt"));
}

TEST_CASE("encodes pinned bytes of a directory of clusters") {
  const auto payloads = pack_clusters(random_entries(6, 5), kWhole);
  REQUIRE(payloads);
  REQUIRE(payloads->size() == 1);
  std::string text;
  for (const std::byte byte : payloads->front()) {
    char word[4];
    std::snprintf(word, sizeof word, "%02x", std::to_integer<unsigned>(byte));
    text += word;
  }
  CHECK(text ==
        "0006b03660f5fdfcc0b8bbd563de27c090de625e34ce5c5a90044e567a8eb8177a8a708c457"
        "985f22c8afdb56ea1c2");
}

}  // namespace cluster_directory_test
}  // namespace gs::qnv
