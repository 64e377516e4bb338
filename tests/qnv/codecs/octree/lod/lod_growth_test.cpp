#include "tests/qnv/lod_streams.h"

#include <random>

// Tests of partly received streams.
namespace gs::qnv {
namespace {

struct Parts {
  EncodedStream stream;
  std::size_t header_bytes = 0;
  std::vector<DirectoryEntry> entries;

  [[nodiscard]] std::span<const std::byte> front(std::size_t bytes) const {
    return std::span(stream.bytes).first(bytes);
  }
  [[nodiscard]] std::span<const std::byte> directory() const {
    return std::span(stream.bytes).subspan(static_cast<std::size_t>(stream.header.directory));
  }
  [[nodiscard]] std::span<const std::byte> at(const ChunkRange& range) const {
    return std::span(stream.bytes)
        .subspan(static_cast<std::size_t>(range.offset), static_cast<std::size_t>(range.bytes));
  }
  [[nodiscard]] std::span<const std::byte> chunk(std::size_t i) const {
    return at({entries[i].offset, entries[i].bytes});
  }
};

Parts parts_of(EncodedStream stream) {
  Parts parts{std::move(stream), 0, {}};
  bool need_more = false;
  (void)decode_header(parts.stream.bytes, parts.header_bytes, need_more);
  parts.entries = read_directory(*memory_source(parts.stream.bytes), parts.stream.header);
  return parts;
}

}  // namespace

TEST_CASE("draws every prefix of a pushed stream as a complete picture") {
  const Parts parts = parts_of(sphere_stream(20'000));
  const auto& bytes = parts.stream.bytes;
  for (std::size_t size = 0; size < parts.header_bytes; size += 7)
    CHECK_FALSE(std::holds_alternative<std::unique_ptr<LodStream>>(LodStream::begin(parts.front(size))));
  const auto lod = taken(LodStream::begin(parts.front(parts.header_bytes)));
  CHECK(encode_header(lod->header()) == encode_header(parts.stream.header));
  CHECK(lod->cut(everything()).empty());
  CHECK(lod->complete());
  std::size_t most = 0;
  for (std::size_t at = parts.header_bytes; at < bytes.size();) {
    const std::size_t size = std::min<std::size_t>(1 + at % 97, bytes.size() - at);
    CHECK(lod->push(std::span(bytes).subspan(at, size)));
    at += size;
    const auto pieces = lod->cut(everything());
    REQUIRE(count(pieces) >= most);
    most = count(pieces);
    REQUIRE((most == 0 || area(pieces) == Approx(kSphereArea).epsilon(0.07)));
    REQUIRE(lod->complete());
    // The result does not depend on the order of receipt.
    if (at % 50 == 0) {
      const auto fresh = taken(LodStream::begin(parts.front(at)));
      CHECK(places(fresh->cut(everything())) == places(pieces));
    }
  }
  lod->finish();
  CHECK(lod->problems().empty());
  CHECK(places(lod->cut(everything())) == places(opened(bytes)->cut(everything())));
  CHECK(lod->statistics().clusters == parts.stream.header.chunks);
}

TEST_CASE("leaves no hole when chunks are added in any order") {
  const Parts parts = parts_of(sphere_stream(60'000));
  const auto whole = places(opened(parts.stream.bytes)->cut(everything()));
  std::mt19937 random(3);
  for (int round = 0; round < 6; ++round) {
    const auto lod = taken(LodStream::begin(parts.front(parts.header_bytes)));
    if (round % 2 == 0) REQUIRE(lod->set_directory(parts.directory()));
    std::vector<std::size_t> order(parts.entries.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    std::size_t most = 0, came = 0;
    for (const std::size_t i : order) {
      const std::uint64_t before = lod->revision();
      REQUIRE(lod->add(parts.entries[i].offset, parts.chunk(i)));
      CHECK(lod->revision() != before);
      CHECK(lod->add(parts.entries[i].offset, parts.chunk(i)));  // repeated
      CHECK(lod->statistics().clusters == ++came);
      const auto pieces = lod->cut(everything());
      REQUIRE(count(pieces) >= most);
      most = count(pieces);
      REQUIRE((most == 0 || area(pieces) == Approx(kSphereArea).epsilon(0.07)));
      REQUIRE_FALSE(lod->pending());
      for (const Piece& piece : pieces) REQUIRE((piece.age >= 0 && piece.age <= 1));
      if (round % 2 == 0) REQUIRE(lod->lacking().size() == parts.entries.size() - came);
    }
    CHECK(lod->problems().empty());
    CHECK(places(lod->cut(everything())) == whole);
    CHECK(places(lod->whole().positions) == whole);
  }
}

TEST_CASE("lists the missing chunks of a view by importance", "[optimised]") {
  const Parts parts = parts_of(sphere_stream(400'000));
  LodView view = from({0, 0, 1.6f}, 400);
  view.planes[0] = {1, 0, 0, 0};  // the half with x > 0
  view.budget = 30'000;
  const auto lod = taken(LodStream::begin(parts.front(parts.header_bytes)));
  CHECK(lod->cut(view).empty());
  CHECK(lod->lacking().empty());  // the stream does not have its directory yet
  REQUIRE(lod->set_directory(parts.directory()));
  CHECK(lod->cut(view).empty());
  CHECK_FALSE(lod->complete());
  REQUIRE(lod->lacking().size() > 10);
  CHECK(lod->lacking()[0] == ChunkRange{parts.entries[0].offset, parts.entries[0].bytes});
  std::size_t bytes = 0, rounds = 0, most = 0;
  for (; rounds < 20 && !lod->complete(); ++rounds) {
    const std::vector<ChunkRange> wanted = lod->lacking();
    // Nearer and coarser chunks come first.
    for (std::size_t i = 0; i < std::min<std::size_t>(wanted.size(), 4); ++i) {
      bytes += wanted[i].bytes;
      REQUIRE(lod->add(wanted[i].offset, parts.at(wanted[i])));
    }
    const auto pieces = lod->cut(view);
    CHECK(count(pieces) >= most);
    CHECK(count(pieces) <= view.budget);
    most = count(pieces);
  }
  CHECK(lod->complete());
  CHECK(rounds > 1);
  CHECK(bytes < parts.stream.bytes.size() / 2);
  const std::size_t there = count(opened_there(parts.stream.bytes)->cut(view));
  CHECK(static_cast<double>(most) == Approx(static_cast<double>(there)).epsilon(0.1));
}

TEST_CASE("lists the missing chunks of several viewports in turn without duplicates") {
  const Parts parts = parts_of(sphere_stream(100'000));
  const auto lod = taken(LodStream::begin(parts.front(parts.header_bytes)));
  REQUIRE(lod->set_directory(parts.directory()));
  CHECK(lod->wanted().empty());
  CHECK(lod->views().empty());
  LodView left = from({0, 0, 1.6f}, 400), right = left;
  left.planes[0] = {-1, 0, 0, 0};
  right.planes[0] = {1, 0, 0, 0};
  right.viewport = 1;
  (void)lod->cut(left);
  const auto of_left = lod->lacking();
  (void)lod->cut(right);
  const auto of_right = lod->lacking();
  REQUIRE(of_left.size() > 10);
  REQUIRE(of_left != of_right);
  CHECK(lod->views() == std::vector<LodView>{left, right});
  auto all = lod->wanted();
  // The first chunk of each view precedes the second chunk of any view.
  CHECK(all[0] == of_left[0]);
  const auto place = [&](const ChunkRange& range) { return std::find(all.begin(), all.end(), range) - all.begin(); };
  for (std::size_t i = 0; i < 10; ++i) {
    CHECK(place(of_left[i]) <= static_cast<std::ptrdiff_t>(2 * i));
    CHECK(place(of_right[i]) <= static_cast<std::ptrdiff_t>(2 * i + 1));
  }
  const auto offsets = [](std::vector<ChunkRange> ranges) {
    std::vector<std::uint64_t> sorted;
    for (const ChunkRange& range : ranges) sorted.push_back(range.offset);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  std::vector<ChunkRange> both = of_left;
  both.insert(both.end(), of_right.begin(), of_right.end());
  auto expected = offsets(both);
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  CHECK(offsets(all) == expected);
  // A received chunk is no longer wanted, and a closed view wants nothing.
  REQUIRE(lod->add(all[0].offset, parts.at(all[0])));
  CHECK(lod->wanted().size() == all.size() - 1);
  lod->forget(0);
  CHECK(lod->views() == std::vector<LodView>{right});
  CHECK(lod->wanted().size() == of_right.size() - 1);
}

TEST_CASE("merges pushed and added chunks to one stream") {
  const Parts parts = parts_of(sphere_stream(60'000));
  const auto lod = taken(LodStream::begin(parts.front(3000)));
  REQUIRE(lod->set_directory(parts.directory()));
  const std::size_t last = parts.entries.size() - 1;
  for (std::size_t i = last; i > last / 2; --i) REQUIRE(lod->add(parts.entries[i].offset, parts.chunk(i)));
  CHECK(area(lod->cut(everything())) == Approx(kSphereArea).epsilon(0.07));
  CHECK(lod->push(std::span(parts.stream.bytes).subspan(3000)));
  lod->finish();
  CHECK(lod->problems().empty());
  CHECK(places(lod->cut(everything())) == places(opened(parts.stream.bytes)->cut(everything())));
  CHECK(lod->complete());
}

TEST_CASE("ignores invalid chunks and reports them") {
  const Parts parts = parts_of(sphere_stream(20'000));
  const auto lod = taken(LodStream::begin(parts.front(parts.header_bytes)));
  std::vector<std::byte> damaged(parts.chunk(1).begin(), parts.chunk(1).end());
  damaged[40] ^= std::byte{1};
  CHECK_FALSE(lod->add(parts.entries[1].offset, damaged));
  CHECK_FALSE(lod->add(parts.entries[1].offset, parts.chunk(1).first(30)));
  CHECK_FALSE(lod->add(0, {}));
  CHECK_FALSE(lod->add(7, encode_chunk(ChunkType::packed, std::vector<std::byte>(50))));
  CHECK_FALSE(lod->set_directory(parts.directory().first(parts.directory().size() - 1)));
  CHECK_FALSE(lod->set_directory({}));
  CHECK(lod->problems().size() == 4);
  REQUIRE(lod->set_directory(parts.directory()));
  // The chunk is valid, but belongs to another offset.
  CHECK_FALSE(lod->add(parts.entries[2].offset, parts.chunk(1)));
  for (std::size_t i = 0; i < parts.entries.size(); ++i)
    if (i != 2) CHECK(lod->add(parts.entries[i].offset, parts.chunk(i)));
  CHECK(area(lod->cut(everything())) == Approx(kSphereArea).epsilon(0.07));
  // A stream in a file accepts no chunks.
  const auto still = opened(parts.stream.bytes);
  CHECK_FALSE(still->add(parts.entries[1].offset, parts.chunk(1)));
  CHECK_FALSE(still->push(parts.chunk(1)));
  CHECK_FALSE(still->set_directory(parts.directory()));
}

TEST_CASE("continues a damaged stream after the damage") {
  const Parts parts = parts_of(sphere_stream(20'000));
  for (std::size_t at = parts.header_bytes; at < parts.stream.bytes.size(); at += 331) {
    auto bytes = parts.stream.bytes;
    bytes[at] ^= std::byte{0x55};
    auto made = LodStream::begin(std::span(bytes).first(parts.header_bytes + 100));
    REQUIRE(std::holds_alternative<std::unique_ptr<LodStream>>(made));
    auto& lod = *std::get<std::unique_ptr<LodStream>>(made);
    CHECK(lod.push(std::span(bytes).subspan(parts.header_bytes + 100)));
    lod.finish();
    const auto pieces = lod.cut(everything());
    CHECK((pieces.empty() || area(pieces) == Approx(kSphereArea).epsilon(0.07)));
  }
}

}  // namespace gs::qnv
