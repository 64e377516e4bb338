#include "qnv/codecs/values/chunk_places.h"

#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/codecs/values/lifting.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <random>
#include <vector>

namespace gs::qnv {
namespace chunk_places_test {

using values::ChunkPlace;
using Bytes = std::vector<std::byte>;

std::vector<ChunkPlace> random_places(std::size_t count) {
  std::mt19937 random(3);
  std::vector<ChunkPlace> places;
  std::vector<std::uint32_t> next(2000);
  std::uint64_t at = 400;
  for (std::size_t i = 0; i < count; ++i) {
    ChunkPlace place;
    if (random() % 50 == 0) at += random() % 3000;  // parity
    place.offset = at;
    place.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + random() % 1200);
    if (i < 20 || i + 30 > count) {
      place.type = i < 20 ? ChunkType::gaps : ChunkType::remainders;
      place.first = i * 5000;
      place.count = 1 + static_cast<std::uint32_t>(random() % 5000);
    } else {
      place.first = random() % next.size();
      place.count = next[static_cast<std::size_t>(place.first)]++;
    }
    at += place.bytes;
    places.push_back(place);
  }
  return places;
}

TEST_CASE("places: A directory of all kinds of chunks is read as it was written") {
  const std::vector<ChunkPlace> places = random_places(60000);
  values::PlacesReader reader;
  std::size_t bytes = 0;
  for (const Bytes& payload : values::pack_places(places)) {
    CHECK(payload.size() <= kMaxChunkBytes);
    REQUIRE(reader.add(payload));
    bytes += payload.size();
  }
  CHECK(reader.places() == places);
  CHECK(bytes < 5 * places.size());
}

TEST_CASE("places: Truncated and mutated directories are refused or harmless") {
  const std::vector<ChunkPlace> places = random_places(300);
  std::mt19937 random(11);
  for (const Bytes& payload : values::pack_places(places)) {
    for (std::size_t size = 0; size < payload.size(); ++size) {
      values::PlacesReader reader;
      (void)reader.add(std::span(payload).first(size));
      CHECK(reader.places().size() <= places.size());
    }
    for (int i = 0; i < 3000; ++i) {
      Bytes mutated = payload;
      mutated[random() % mutated.size()] = static_cast<std::byte>(random() % 256);
      values::PlacesReader reader;
      (void)reader.add(mutated);
      std::uint64_t end = 0;
      for (const ChunkPlace& place : reader.places()) {
        CHECK(place.offset >= end);
        end = place.offset + place.bytes;
      }
    }
  }
  values::PlacesReader reader;
  CHECK_FALSE(reader.add({}));
  const Bytes of_parity{std::byte{17}, std::byte{0}};
  CHECK_FALSE(reader.add(of_parity));
}

TEST_CASE("places: A stream has places of all its chunks, with their boxes") {
  const auto source = test::volume_of(test::oblique(70, 50, 30), [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x > 30 && y > 20 ? test::kNaN : static_cast<float>(x * y + z * z);
  });
  auto made = encode_values(source, EncodeOptions{});
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  const auto& stream = std::get<EncodedStream>(made);
  const auto chunks = std::span(stream.bytes).subspan(static_cast<std::size_t>(stream.header.directory));
  CHECK(chunks.size() < 8 * stream.header.chunks + 60);
  const auto places = values::places_of(chunks, stream.header);
  REQUIRE(places);
  REQUIRE(places->size() == stream.header.chunks);
  StreamDecoder decoder;
  decoder.push(stream.bytes);
  decoder.finish();
  CHECK(decoder.problems().empty());
  REQUIRE(decoder.directory().size() == places->size());
  for (std::size_t i = 0; i < places->size(); ++i) {
    const auto head = chunk_head(std::span(stream.bytes).subspan(static_cast<std::size_t>((*places)[i].offset)));
    REQUIRE(head);
    CHECK(head->type == (*places)[i].type);
    CHECK(head->bytes == (*places)[i].bytes);
    CHECK(decoder.directory()[i].offset == (*places)[i].offset);
    CHECK_FALSE(decoder.directory()[i].box.empty());
  }
  Bytes damaged(chunks.begin(), chunks.end());
  damaged[15] ^= std::byte{2};
  CHECK_FALSE(values::places_of(damaged, stream.header));
  CHECK_FALSE(values::places_of(chunks.first(chunks.size() - 1), stream.header));
}

}  // namespace chunk_places_test
}  // namespace gs::qnv
