#include "qnv/codec/payloads.h"

#include "qnv/records/record.h"
#include "qnv/records/records_payload.h"

#include <array>

namespace gs::qnv {
namespace {

constexpr std::array<PayloadRow, 3> kRows = {{
    {Payload::records, "records", PayloadReader::vectors, ChunkType::records, ChunkType::records, kRecordsHeaderBytes,
     kRecordBytes, 1200 / kRecordBytes},
    {Payload::packed, "packed", PayloadReader::levels, ChunkType::packed, ChunkType::packed, 0, 0, 0},
    {Payload::outlines, "outlines", PayloadReader::polygons, ChunkType::outlines, ChunkType::inner, 0, 0, 0},
}};

// The table is in the order of the enumeration.
static_assert([] {
  for (std::size_t i = 0; i < kRows.size(); ++i)
    if (static_cast<std::size_t>(kRows[i].payload) != i) return false;
  return true;
}());

}  // namespace

std::span<const PayloadRow> payload_rows() { return kRows; }

const PayloadRow& row_of(Payload payload) { return kRows[static_cast<std::size_t>(payload)]; }

const PayloadRow* payload_of(std::span<const std::byte> bytes) {
  const std::optional<std::uint8_t> number = payload_number(bytes);
  return number && *number < kRows.size() ? &kRows[*number] : nullptr;
}

bool carries(const PayloadRow& row, ChunkType type) { return type == row.chunk || type == row.inner_chunk; }

std::optional<ChunkParts> cut_chunk(const PayloadRow& row, std::span<const std::byte> chunk) {
  const std::optional<ChunkHead> head = chunk_head(chunk);
  if (!head || head->bytes != chunk.size() || !carries(row, head->type)) return {};
  if (row.record_bytes == 0) return ChunkParts{{}, chunk};
  const std::size_t front = kChunkHeaderBytes + row.head_bytes;
  if (chunk.size() <= front || (chunk.size() - front) % row.record_bytes != 0) return {};
  return ChunkParts{chunk.first(front), chunk.subspan(front)};
}

}  // namespace gs::qnv
