#include "qnv/codecs/payloads.h"

#include "qnv/codecs/records/records_payload.h"
#include "qnv/reader/decode_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/soft_ball.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>

#include <functional>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>
#include <variant>
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

TEST_CASE("detects the payload of a stream from its first twelve bytes") {
  std::set<std::string_view> names;
  for (const PayloadRow& row : payload_rows()) {
    CHECK(names.insert(row.name).second);
    if (row.sniff) continue;  // shares its number with a later row
    CHECK(&row_of(row.payload) == &row);
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

TEST_CASE("tells progressive streams from displaced ones by the front in their section") {
  StreamHeader header;
  header.payload = Payload::displaced;
  header.base.assign(13, std::byte{0});
  header.base[0] = std::byte{255};
  header.base[1] = std::byte{12};  // bits
  CHECK(row_of(header).name == "progressive");
  header.base[1] = std::byte{255};
  CHECK(row_of(header).name == "displaced");
  header.base[0] = std::byte{6};
  CHECK(row_of(header).name == "displaced");
  header.base.clear();
  CHECK(row_of(header).name == "displaced");
  header.payload = Payload::records;
  CHECK(row_of(header).name == "records");
}

TEST_CASE("encodes and decodes each payload by its row of the table") {
  const std::vector<Triangle> square = [] {
    std::vector<Triangle> made(2);
    const glm::vec3 corners[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    for (int i = 0; i < 3; ++i) made[0].positions[i] = corners[i];
    for (int i = 0; i < 3; ++i) made[1].positions[i] = corners[(i + 2) % 4];
    return made;
  }();
  const TriangleSource triangles = [&](const TriangleSink& sink) { return sink(square); };
  Splats geometry;
  for (int i = 0; i < 40; ++i) {
    geometry.positions.emplace_back(i % 8, i / 8, 0);
    geometry.normals.emplace_back(0, 0, 1);
    geometry.weights.push_back(1);
    geometry.description.box.add(geometry.positions.back());
    geometry.description.total += 1;
  }
  PolygonModel model;
  model.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  model.corners = {0, 1, 2, 0, 2, 3};
  model.ends = {3, 6};
  const auto grouped = group_outlines(model, {});
  REQUIRE(std::holds_alternative<OutlineGroups>(grouped));
  const OutlineEncodeOptions outline_options;
  const SoftBall ball(12);
  double magnitudes = 0;
  for (const float weight : ball.geometry.weights) magnitudes += weight;
  const Gaussians cloud = test::splat_cloud(300);
  const EncodeSource sources[] = {std::cref(triangles),
                                  VectorView(geometry),
                                  OutlineSource{std::get<OutlineGroups>(grouped), {}, outline_options},
                                  VectorView(ball.geometry),
                                  std::cref(ball.source),
                                  std::cref(cloud)};
  EncodeOptions few;
  few.vectors = 5000;
  // Sources of each payload.
  const std::set<std::pair<std::string_view, std::size_t>> made = {
      {"records", 0}, {"records", 1},   {"packed", 0},      {"outlines", 2}, {"records", 3}, {"values", 4},
      {"packed", 1},  {"displaced", 0}, {"progressive", 0}, {"records", 5},  {"packed", 5},  {"gaussians", 5}};
  for (const PayloadRow& row : payload_rows())
    for (std::size_t i = 0; i < std::size(sources); ++i) {
      INFO(row.name << " of source " << i);
      const auto encoded = row.encode(sources[i], few, nullptr);
      const auto* stream = std::get_if<EncodedStream>(&encoded);
      REQUIRE((stream != nullptr) == made.contains({row.name, i}));
      if (!stream) continue;
      CHECK(&row_of(stream->header) == &row);
      const DecodedStream decoded = decode_stream(stream->bytes, 1 << 20);
      REQUIRE(decoded.header);
      CHECK(decoded.problems.empty());
      CHECK(decoded.refused_chunks == 0);
      if (row.reader == PayloadReader::polygons) {
        CHECK(std::get<std::vector<OutlineBatch>>(decoded.content).size() >= 1);
      } else {
        const auto& vectors = std::get<Geometry>(decoded.content);
        CHECK(vectors.size() > 0);
        if (i == 1 && row.payload == Payload::records) CHECK(vectors.size() == geometry.size());
        if (i < 4) CHECK(vectors.description().total == Approx(i == 3 ? magnitudes : i == 1 ? 40 : 1).epsilon(0.01));
      }
      // The decoders of vectors and of polygons reject each other's streams.
      if (row.reader == PayloadReader::polygons) {
        StreamDecoder foreign;
        (void)foreign.push(stream->bytes);
        CHECK(foreign.refused_chunks() > 0);
      } else {
        OutlineDecoder foreign;
        CHECK(!foreign.push(stream->bytes));
        CHECK(!foreign.problems().empty());
      }
    }
}

TEST_CASE("cuts chunks so that their parts are useful after losses") {
  const std::vector<std::byte> payload(kRecordsHeaderBytes + 24, std::byte{7});
  for (const PayloadRow& row : payload_rows()) {
    for (const ChunkType type : row.chunks) {
      CHECK(carries(row, type));
      const std::vector<std::byte> chunk = encode_chunk(type, payload);
      const auto parts = cut_chunk(row, chunk);
      REQUIRE(parts);
      CHECK(parts->head.size() == (row.record_bytes > 0 ? kChunkHeaderBytes + kRecordsHeaderBytes : 0));
      CHECK(parts->head.size() + parts->body.size() == chunk.size());
      CHECK(parts->body.data() + parts->body.size() == chunk.data() + chunk.size());
      // The chunk is too short, too long, of another payload, or not a chunk.
      CHECK(!cut_chunk(row, std::span(chunk).first(chunk.size() - 1)));
      std::vector<std::byte> longer = chunk;
      longer.push_back({});
      CHECK(!cut_chunk(row, longer));
      CHECK(!cut_chunk(row, encode_chunk(ChunkType::directory, payload)));
      CHECK(!cut_chunk(row, {}));
    }
  }
  // Records of eight bytes after a header of 48 (FORMAT.md, "Records payload").
  const PayloadRow& records = row_of(Payload::records);
  CHECK(!cut_chunk(records, encode_chunk(ChunkType::records, std::span(payload).first(48))));
  CHECK(!cut_chunk(records, encode_chunk(ChunkType::records, std::span(payload).first(57))));
  CHECK(cut_chunk(records, encode_chunk(ChunkType::records, std::span(payload).first(56)))->body.size() == 8);
}

TEST_CASE("reads type and length from the head of a chunk") {
  const std::vector<std::byte> chunk = encode_chunk(ChunkType::inner, std::vector<std::byte>(300));
  const auto head = chunk_head(std::span(chunk).first(kChunkHeaderBytes));
  REQUIRE(head);
  CHECK(head->type == ChunkType::inner);
  CHECK(head->bytes == chunk.size());
  CHECK(!chunk_head(std::span(chunk).first(kChunkHeaderBytes - 1)));
  CHECK(!chunk_head(std::span(chunk).subspan(1)));
}

}  // namespace gs::qnv
