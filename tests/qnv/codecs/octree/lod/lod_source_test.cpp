#include "qnv/reader/loss.h"
#include "tests/qnv/lod_streams.h"
#include "tests/watched.h"

#include <atomic>
#include <functional>
#include <random>

// Tests of streams that are read in place, with wrong directories.
namespace gs::qnv {
namespace {

/// Source that counts reads and can end early.
class WatchedSource : public ChunkSource {
 public:
  explicit WatchedSource(std::vector<std::byte> bytes) : bytes_(memory_source(std::move(bytes))) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_->size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset >= end) return 0;
    const std::size_t count =
        bytes_->read(offset, to.first(static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), end - offset))));
    done += count;
    return count;
  }
  mutable std::atomic<std::size_t> done{0};
  std::uint64_t end = ~std::uint64_t{0};

 private:
  std::shared_ptr<const ChunkSource> bytes_;
};

std::vector<DirectoryEntry> entries_of(const EncodedStream& stream) {
  return read_directory(*memory_source(stream.bytes), stream.header);
}

/// Returns the stream with another directory.
std::vector<std::byte> with_directory(const EncodedStream& stream, std::span<const DirectoryEntry> entries) {
  std::vector<std::byte> bytes(stream.bytes.begin(),
                               stream.bytes.begin() + static_cast<std::ptrdiff_t>(stream.header.directory));
  const auto directory = encode_directory(entries, stream.header.description.box);
  bytes.insert(bytes.end(), directory.begin(), directory.end());
  return bytes;
}

void check_sound(LodStream& lod, std::size_t most) {
  for (int i = 0; i < 2; ++i) {
    const auto pieces = lod.cut(everything());
    CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.07));
    CHECK(count(pieces) <= most);
  }
  CHECK(lod.whole().size() <= most);
  CHECK(lod.complete());
}

}  // namespace

TEST_CASE("reads from a remote stream only the chunks that a view needs", "[optimised]") {
  const EncodedStream& stream = sphere_stream(400'000);
  const auto source = std::make_shared<WatchedSource>(stream.bytes);
  const auto lod = taken(LodStream::open(source));
  const std::size_t directory = stream.bytes.size() - static_cast<std::size_t>(stream.header.directory);
  // Reads some chunks to check that the directory matches.
  CHECK(source->done < 4096 + directory + 12 * 1400);
  CHECK(lod->statistics().clusters == stream.header.chunks);
  CHECK(lod->problems().empty());
  const std::size_t opening = source->done;
  LodView far = from({0, 0, 100});
  CHECK(area(lod->cut(far)) == Approx(kSphereArea).epsilon(0.06));
  CHECK(source->done - opening < stream.bytes.size() / 10);
  CHECK(places(lod->cut(everything())) == places(opened(stream.bytes)->cut(everything())));
  const std::size_t all = source->done;
  CHECK(all < opening + stream.bytes.size());
  (void)lod->cut(everything());
  CHECK(source->done == all);
}

TEST_CASE("reads the whole stream if it has no valid directory") {
  const EncodedStream& stream = sphere_stream(60'000);
  const auto expected = places(opened(stream.bytes)->cut(everything()));
  const auto at = static_cast<std::size_t>(stream.header.directory);
  auto cut_off = stream.bytes;
  cut_off.resize(at);
  auto damaged = stream.bytes;
  damaged[at + 100] ^= std::byte{1};
  auto behind = stream.bytes;
  behind.resize(behind.size() + 1000, std::byte{0x51});
  for (const auto& bytes : {cut_off, damaged, behind}) {
    const auto lod = opened_there(bytes);
    CHECK(lod->statistics().clusters == stream.header.chunks);
    CHECK(places(lod->cut(everything())) == expected);
  }
  // The directory belongs to another stream, or has its entries in another order.
  std::vector<DirectoryEntry> entries = entries_of(stream);
  std::swap(entries[3], entries[entries.size() / 2]);
  std::swap(entries[1], entries[entries.size() - 1]);
  for (std::size_t i = 0; i < entries.size(); i += 2) entries[i].parent = 0;
  entries[0].parent = kNoParent;
  const auto lod = opened_there(with_directory(stream, entries));
  CHECK(places(lod->cut(everything())) == expected);
  REQUIRE(lod->problems().size() == 1);
  CHECK(lod->problems()[0].message.find("does not match") != std::string::npos);
  CHECK_FALSE(std::holds_alternative<std::unique_ptr<LodStream>>(
      LodStream::open(memory_source(std::vector<std::byte>(stream.bytes.begin(), stream.bytes.begin() + 300)))));
}

TEST_CASE("loses only a damaged chunk and its descendants, once") {
  const EncodedStream& stream = sphere_stream(60'000);
  const std::vector<DirectoryEntry> entries = entries_of(stream);
  const std::size_t full = count(opened(stream.bytes)->cut(everything()));
  for (const std::size_t which : {5u, 17u}) {
    auto bytes = stream.bytes;
    bytes[static_cast<std::size_t>(entries[which].offset) + 200] ^= std::byte{4};
    const auto lod = opened_there(bytes);
    CHECK(lod->problems().empty());
    const auto pieces = lod->cut(everything());
    CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.06));
    CHECK(count(pieces) < full);
    CHECK(count(pieces) > full / 4);
    REQUIRE(lod->problems().size() == 1);
    CHECK(lod->problems()[0].offset == entries[which].offset);
    CHECK(lod->problems()[0].message == "a chunk is damaged and left out");
    CHECK(places(lod->cut(everything())) == places(pieces));
    CHECK(lod->problems().size() == 1);
    CHECK(places(lod->whole().positions) == places(pieces));
  }
}

TEST_CASE("keeps the data that it has when the file becomes shorter") {
  const EncodedStream& stream = sphere_stream(60'000);
  const auto source = std::make_shared<WatchedSource>(stream.bytes);
  const auto lod = taken(LodStream::open(source, 0));
  const LodView view = from({0, 0, 30}, 20);
  const std::size_t coarse = count(lod->cut(view));
  source->end = stream.bytes.size() / 2;
  auto pieces = lod->cut(everything());
  CHECK(count(pieces) > coarse);
  CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.06));
  CHECK(lod->problems().size() > 1);
  source->end = 0;
  pieces = lod->cut(view);
  CHECK((pieces.empty() || area(pieces) == Approx(kSphereArea).epsilon(0.06)));
  CHECK(lod->problems().size() <= 100);
}

TEST_CASE("loses at most one cluster to a wrong entry of the directory") {
  const EncodedStream& stream = sphere_stream(60'000);
  const std::vector<DirectoryEntry> sound = entries_of(stream);
  REQUIRE(sound.size() == stream.header.chunks);
  REQUIRE(sound.size() > 25);
  const std::size_t full = count(opened(stream.bytes)->cut(everything()));
  // This chunk is not checked when the stream is opened.
  const std::size_t which = sound.size() / 8 + 1;
  const auto changes = std::vector<std::function<void(DirectoryEntry&)>>{
      [&](DirectoryEntry& e) { e.parent = static_cast<std::uint32_t>(which); },
      [&](DirectoryEntry& e) { e.parent = static_cast<std::uint32_t>(sound.size() - 1); },
      [&](DirectoryEntry& e) { e.parent = 0xfffffffe; },
      [&](DirectoryEntry& e) { e.parent = kNoParent; },
      [&](DirectoryEntry& e) { e.level = 0; },
      [&](DirectoryEntry& e) { e.level = 255; },
      [&](DirectoryEntry& e) { ++e.level; },
      [&](DirectoryEntry& e) { e.vectors = 0; },
      [&](DirectoryEntry& e) { e.vectors = 0xffffffff; },
      [&](DirectoryEntry& e) { ++e.vectors; },
      [&](DirectoryEntry& e) { e.bytes = kChunkHeaderBytes; },
      [&](DirectoryEntry& e) { ++e.bytes; },
      [&](DirectoryEntry& e) { e.offset = ~std::uint64_t{0}; },
      [&](DirectoryEntry& e) { e.offset = stream.bytes.size() - 3; },
      [&](DirectoryEntry& e) { ++e.offset; },
      [&](DirectoryEntry& e) { e.offset = sound[which + 1].offset; },
      [&](DirectoryEntry& e) { e.box.upper = e.box.lower = stream.header.description.box.lower; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    INFO("change " << i);
    std::vector<DirectoryEntry> entries = sound;
    changes[i](entries[which]);
    const auto lod = opened_there(with_directory(stream, entries));
    CHECK(lod->problems().size() <= 1);
    check_sound(*lod, full);
    // Descendants of the chunk may fail too, because they no longer fit.
    CHECK(lod->problems().size() >= 1);
    CHECK(lod->problems().size() <= 2);
    CHECK(count(lod->cut(everything())) > full / 4);
  }
}

TEST_CASE("shows a smaller picture, or none, with many wrong entries in the directory") {
  const EncodedStream& stream = sphere_stream(20'000);
  const std::vector<DirectoryEntry> sound = entries_of(stream);
  const std::size_t full = count(opened(stream.bytes)->cut(everything()));
  std::mt19937 random(5);
  for (std::size_t round = 0; round < 200; round += watched_step(4)) {
    std::vector<DirectoryEntry> entries = sound;
    const std::size_t changed = 1 + random() % 20;
    for (std::size_t i = 0; i < changed; ++i) {
      DirectoryEntry& e = entries[random() % entries.size()];
      const DirectoryEntry& other = entries[random() % entries.size()];
      switch (random() % 6) {
        case 0:
          e.parent = random() % 3 == 0 ? kNoParent : static_cast<std::uint32_t>(random() % entries.size());
          break;
        case 1:
          e.offset = other.offset, e.bytes = other.bytes;
          break;
        case 2:
          e.level = static_cast<std::uint8_t>(random() % 20);
          break;
        case 3:
          e.vectors = static_cast<std::uint32_t>(random());
          break;
        case 4:
          std::swap(e.box, entries[random() % entries.size()].box);
          break;
        default:
          e = other;
      }
    }
    INFO(round);
    auto made = LodStream::open(memory_source(with_directory(stream, entries)));
    if (auto* lod = std::get_if<std::unique_ptr<LodStream>>(&made)) check_sound(**lod, full);
  }
}

TEST_CASE("confines damage with valid checksums to its clusters") {
  const EncodedStream& stream = sphere_stream(20'000);
  const std::vector<DirectoryEntry> sound = entries_of(stream);
  const std::size_t full = count(opened(stream.bytes)->cut(everything()));
  std::mt19937 random(9);
  for (std::size_t round = 0; round < 200; round += watched_step(4)) {
    auto bytes = stream.bytes;
    for (int i = 0; i < 4; ++i) {
      const DirectoryEntry& e = sound[1 + random() % (sound.size() - 1)];
      const auto at = static_cast<std::size_t>(e.offset);
      std::vector<std::byte> payload(bytes.begin() + static_cast<std::ptrdiff_t>(at + kChunkHeaderBytes),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(at + e.bytes));
      payload[random() % (i % 2 == 0 ? 22 : payload.size())] ^= static_cast<std::byte>(1u << random() % 8);
      const auto chunk = encode_chunk(ChunkType::packed, payload);
      std::copy(chunk.begin(), chunk.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
    }
    INFO(round);
    for (const bool there : {false, true}) {
      auto made = there ? LodStream::open(memory_source(bytes)) : LodStream::open(bytes);
      REQUIRE(std::holds_alternative<std::unique_ptr<LodStream>>(made));
      auto& lod = *std::get<std::unique_ptr<LodStream>>(made);
      const auto pieces = lod.cut(everything());
      CHECK(area(pieces) == Approx(kSphereArea).epsilon(0.2));
      CHECK(count(pieces) <= full * 2);
      CHECK(lod.whole().size() <= full * 2);
    }
  }
}

}  // namespace gs::qnv
