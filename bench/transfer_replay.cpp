#include "bench/transfer_run.h"
#include "net/range_set.h"
#include "qnv/container.h"
#include "qnv/decoder.h"
#include "qnv/records_payload.h"

#include <algorithm>
#include <map>

namespace gs::bench {
namespace {

/// What came of a chunk of records.
struct RecordsCame {
  std::vector<std::byte> payload;  // the 48 bytes of its header, and the records as far as they reach
  net::RangeSet came;              // of payload
};

void put(const net::CellEvent& event, RecordsCame& chunk) {
  constexpr std::size_t kHead = qnv::kRecordsHeaderBytes;
  if (event.head.size() != qnv::kChunkHeaderBytes + kHead) return;
  const std::size_t begin = kHead + event.offset, end = begin + event.bytes.size();
  if (chunk.payload.size() < end) chunk.payload.resize(end);
  std::copy(event.head.begin() + qnv::kChunkHeaderBytes, event.head.end(), chunk.payload.begin());
  std::copy(event.bytes.begin(), event.bytes.end(), chunk.payload.begin() + static_cast<std::ptrdiff_t>(begin));
  chunk.came.add({0, kHead});
  chunk.came.add({begin, end});
}

void add(const RecordsCame& chunk, qnv::StreamDecoder& decoder) {
  std::vector<qnv::ByteRange> missing;
  std::uint64_t end = 0;
  for (const net::ByteRange& range : chunk.came.ranges()) {
    if (range.begin > end) missing.push_back({end, range.begin});
    end = range.end;
  }
  decoder.add(qnv::ChunkType::records, chunk.payload, missing);
}

}  // namespace

qnv::Cloud cloud_of(std::span<const CellArrival> arrivals) {
  using Kind = net::CellEvent::Kind;
  qnv::StreamDecoder decoder;
  for (const CellArrival& arrival : arrivals)
    if (arrival.event.kind == Kind::base) (void)decoder.push(arrival.event.bytes);
  if (!decoder.header()) return {};
  std::map<net::ChunkName, RecordsCame> records;
  for (const auto& [seconds, event] : arrivals) {
    if (event.kind != Kind::piece) continue;
    if (event.records)
      put(event, records[event.name]);
    else if (event.bytes.size() > qnv::kChunkHeaderBytes)
      decoder.add(static_cast<qnv::ChunkType>(event.bytes[4]), std::span(event.bytes).subspan(qnv::kChunkHeaderBytes));
  }
  for (const auto& [name, chunk] : records) add(chunk, decoder);
  return decoder.cloud();
}

}  // namespace gs::bench
