#include "qnv/reader/directory_requests.h"

#include "qnv/codecs/payloads.h"
#include "qnv/codecs/progressive/encode/progressive_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/surface_shapes.h"

#include <catch2/catch.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace {

// Returns an octree, as a decoder reads it if an exact mesh follows.
EncodedStream octree_of_sphere() {
  EncodeOptions options;
  options.vectors = 30'000;
  return encoded(sphere(100), options);
}

std::span<const std::byte> directory_of(const EncodedStream& stream) {
  return std::span(stream.bytes).subspan(static_cast<std::size_t>(stream.header.directory));
}

std::vector<DirectoryEntry> listed_chunks_of(const EncodedStream& stream) {
  StreamDecoder decoder;
  REQUIRE(decoder.push(stream.bytes));
  return decoder.directory();
}

std::vector<ChunkRange> ranges_of(const std::vector<DirectoryEntry>& entries) {
  std::vector<ChunkRange> ranges;
  for (const DirectoryEntry& entry : entries) ranges.push_back({entry.offset, entry.bytes});
  return ranges;
}

// Returns a view of the positions with x of at least `least`.
LodView view_from(float least, std::uint32_t viewport = 0) {
  LodView view;
  view.planes[0] = {1, 0, 0, -least};
  view.viewport = viewport;
  return view;
}

}  // namespace

TEST_CASE("requests chunks in the order of the stream without views") {
  const EncodedStream stream = octree_of_sphere();
  DirectoryRequests requests(stream.header);
  CHECK(requests.wanted().empty());
  CHECK_FALSE(requests.in_stream_order());
  CHECK(requests.directory() == stream.header.directory);
  CHECK_FALSE(requests.set_directory(directory_of(stream).first(20)));
  REQUIRE(requests.set_directory(directory_of(stream)));
  CHECK(requests.wanted() == ranges_of(listed_chunks_of(stream)));
  CHECK(requests.wanted().size() > 10);
}

TEST_CASE("requests the chunks in view first") {
  const EncodedStream stream = octree_of_sphere();
  DirectoryRequests requests(stream.header);
  REQUIRE(requests.set_directory(directory_of(stream)));
  const std::vector<DirectoryEntry> entries = listed_chunks_of(stream);
  const float least = requests.box().upper.x * 0.5f;
  requests.note(view_from(least));
  std::vector<ChunkRange> expected;
  for (const bool visible : {true, false})
    for (const DirectoryEntry& entry : entries)
      if ((entry.box.upper.x >= least) == visible) expected.push_back({entry.offset, entry.bytes});
  CHECK(requests.wanted() == expected);
  CHECK(expected != ranges_of(entries));
  CHECK(requests.views() == std::vector<LodView>{view_from(least)});
  // A second viewport that sees everything.
  requests.note(view_from(requests.box().lower.x - 1, 1));
  CHECK(requests.wanted() == ranges_of(entries));
  requests.forget(1);
  CHECK(requests.wanted() == expected);
  requests.forget(0);
  CHECK(requests.wanted() == ranges_of(entries));
}

TEST_CASE("keeps the order of a progressive stream for every view") {
  CHECK(row_of(Payload::records).requests == RequestOrder::stream);

  const Triangles ball = sphere(60);
  auto encoded = encode_progressive(source_of(ball), {}, nullptr);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  const auto& stream = std::get<EncodedStream>(encoded);
  DirectoryRequests requests(stream.header);
  CHECK(requests.in_stream_order());
  REQUIRE(requests.set_directory(directory_of(stream)));
  requests.note(view_from(0.5f));
  CHECK(requests.wanted() == ranges_of(listed_chunks_of(stream)));
}

}  // namespace gs::qnv
