#include "qnv/codec/payloads.h"

#include "qnv/records/records_payload.h"

#include <catch2/catch.hpp>

#include <set>
#include <vector>

namespace gs::qnv {
namespace {

std::vector<std::byte> begin_of_stream(Payload payload) {
  StreamHeader header;
  header.payload = payload;
  header.description.box = {glm::vec3(0), glm::vec3(1)};
  header.cube.edge = 1;
  return encode_header(header);
}

}  // namespace

TEST_CASE("the payload of a stream is told by its first twelve bytes") {
  std::set<std::string_view> names;
  for (const PayloadRow& row : payload_rows()) {
    CHECK(&row_of(row.payload) == &row);
    CHECK(names.insert(row.name).second);
    const std::vector<std::byte> header = begin_of_stream(row.payload);
    for (std::size_t bytes = 0; bytes < 12; ++bytes) CHECK(!payload_of(std::span(header).first(bytes)));
    CHECK(payload_of(std::span(header).first(12)) == &row);
    std::vector<std::byte> other = header;
    other[0] = std::byte{0};
    CHECK(!payload_of(other));
    other = header;
    other[11] = std::byte{99};
    CHECK(!payload_of(other));
  }
}

TEST_CASE("chunks are cut so that what may be lost is of use in parts") {
  const std::vector<std::byte> payload(kRecordsHeaderBytes + 24, std::byte{7});
  for (const PayloadRow& row : payload_rows()) {
    for (const ChunkType type : {row.chunk, row.inner_chunk}) {
      CHECK(carries(row, type));
      const std::vector<std::byte> chunk = encode_chunk(type, payload);
      const auto parts = cut_chunk(row, chunk);
      REQUIRE(parts);
      CHECK(parts->head.size() == (row.record_bytes > 0 ? kChunkHeaderBytes + kRecordsHeaderBytes : 0));
      CHECK(parts->head.size() + parts->body.size() == chunk.size());
      CHECK(parts->body.data() + parts->body.size() == chunk.data() + chunk.size());
      // Too short, too long, of another payload, no chunk.
      CHECK(!cut_chunk(row, std::span(chunk).first(chunk.size() - 1)));
      std::vector<std::byte> longer = chunk;
      longer.push_back({});
      CHECK(!cut_chunk(row, longer));
      CHECK(!cut_chunk(row, encode_chunk(ChunkType::directory, payload)));
      CHECK(!cut_chunk(row, {}));
    }
  }
  // Records of eight bytes behind a header of 48 (FORMAT.md, "Records payload").
  const PayloadRow& records = row_of(Payload::records);
  CHECK(!cut_chunk(records, encode_chunk(ChunkType::records, std::span(payload).first(48))));
  CHECK(!cut_chunk(records, encode_chunk(ChunkType::records, std::span(payload).first(57))));
  CHECK(cut_chunk(records, encode_chunk(ChunkType::records, std::span(payload).first(56)))->body.size() == 8);
}

TEST_CASE("the head of a chunk tells its type and length") {
  const std::vector<std::byte> chunk = encode_chunk(ChunkType::inner, std::vector<std::byte>(300));
  const auto head = chunk_head(std::span(chunk).first(kChunkHeaderBytes));
  REQUIRE(head);
  CHECK(head->type == ChunkType::inner);
  CHECK(head->bytes == chunk.size());
  CHECK(!chunk_head(std::span(chunk).first(kChunkHeaderBytes - 1)));
  CHECK(!chunk_head(std::span(chunk).subspan(1)));
}

}  // namespace gs::qnv
