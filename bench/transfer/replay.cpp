#include "app/formats/content_types.h"
#include "app/formats/qnv/outline_scene.h"
#include "bench/shared/studio.h"
#include "bench/transfer/run.h"
#include "net/base/range_set.h"
#include "qnv/codecs/records/records_payload.h"
#include "qnv/container/container.h"
#include "qnv/reader/stream_decoder.h"

#include <algorithm>
#include <map>

namespace gs::bench {
namespace {

/// Received part of a chunk of records.
struct RecordsCame {
  std::vector<std::byte> payload;  // the 48 bytes of its header, and the received records
  net::RangeSet came;              // received ranges of payload
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

using Kind = net::CellEvent::Kind;

render::RenderList polygons_of(std::span<const CellArrival> arrivals) {
  qnv::OutlineDecoder decoder;
  for (const CellArrival& arrival : arrivals)
    if (arrival.event.kind == Kind::base) (void)decoder.push(arrival.event.bytes);
  if (!decoder.header()) return {};
  for (const auto& [seconds, event] : arrivals)
    if (event.kind == Kind::piece && event.bytes.size() > qnv::kChunkHeaderBytes)
      decoder.add(static_cast<qnv::ChunkType>(event.bytes[4]), std::span(event.bytes).subspan(qnv::kChunkHeaderBytes));
  vrml::SceneGraph scene;
  Diagnostics diagnostics;
  app::OutlineScene outlines(scene, diagnostics);
  outlines.add(decoder.header()->outlines, decoder.take());
  render::MeshCache meshes;
  return render::collect(scene, {}, meshes);
}

}  // namespace

qnv::Geometry geometry_of(std::span<const CellArrival> arrivals) {
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
  return decoder.geometry();
}

render::RenderList list_of(std::span<const CellArrival> arrivals) {
  for (const CellArrival& arrival : arrivals)
    if (arrival.event.kind == Kind::base && app::is_outline_stream(arrival.event.bytes)) return polygons_of(arrivals);
  return list_of(geometry_of(arrivals));
}

}  // namespace gs::bench
