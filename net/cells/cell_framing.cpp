#include "net/cells/cell_framing.h"

#include "net/base/network_bytes.h"
#include "net/cells/erasure.h"

#include <algorithm>
#include <utility>

namespace gs::net {
namespace {

bool sound_place(const Place& place) {
  if (place.stream >= kMaxStreams || place.total == 0) return false;
  switch (place.kind) {
    case PlaceKind::records:
      return place.chunk < kMaxChunks && place.total <= kMaxChunkBody && place.total % kRecordBytes == 0 &&
             place.at < cells_of_records(place.total);
    case PlaceKind::piece:
      return place.chunk < kMaxChunks && place.total <= kMaxChunkBody && place.at < place.total;
    case PlaceKind::base:
      return place.chunk <= 65535 && place.total <= ErasureLayout::kMaxBytes && place.at < ErasureLayout::kMaxSymbols;
    case PlaceKind::parity:
      return false;
  }
  return false;
}

}  // namespace

std::vector<std::byte> encode_place(const Place& place, std::span<const std::byte> rest) {
  std::vector<std::byte> bytes;
  bytes.reserve(kPlaceBytes + rest.size());
  NetworkWriter out(bytes);
  out.integer(static_cast<std::uint8_t>(place.kind));
  out.integer(place.stream);
  out.integer(std::uint16_t{0});
  out.integer(place.version);
  out.integer(place.time);
  out.integer(place.chunk);
  out.integer(place.total);
  out.integer(place.at);
  out.bytes(rest);
  return bytes;
}

std::optional<Place> decode_place(std::span<const std::byte> bytes, std::span<const std::byte>& rest) {
  NetworkReader in(bytes);
  Place place;
  place.kind = static_cast<PlaceKind>(in.integer<std::uint8_t>());
  place.stream = in.integer<std::uint8_t>();
  (void)in.integer<std::uint16_t>();
  place.version = in.integer<std::uint32_t>();
  place.time = in.integer<std::uint32_t>();
  place.chunk = in.integer<std::uint32_t>();
  place.total = in.integer<std::uint32_t>();
  place.at = in.integer<std::uint32_t>();
  if (!in.good() || !sound_place(place)) return std::nullopt;
  rest = in.rest();
  if (place.kind == PlaceKind::records && rest.size() > kMaxChunkHead) return std::nullopt;
  if (place.kind == PlaceKind::piece && (rest.empty() || rest.size() > place.total - place.at)) return std::nullopt;
  return place;
}

bool ChunkCutter::sound(const CellChunk& chunk, bool records) {
  if (chunk.body.empty() || chunk.body.size() > kMaxChunkBody || chunk.head.size() > kMaxChunkHead) return false;
  return records ? chunk.body.size() % kRecordBytes == 0 : chunk.head.empty();
}

ChunkCutter::ChunkCutter(CellChunk chunk, bool records, std::size_t slot, Place place)
    : chunk_(std::move(chunk)),
      records_(records),
      place_vc_{path_of_slot(slot), kPlaceVci},
      data_vc_{path_of_slot(slot), static_cast<std::uint16_t>(kFirstDataVci + place.stream)},
      place_(place) {
  place_.kind = records ? PlaceKind::records : PlaceKind::piece;
  place_.total = static_cast<std::uint32_t>(chunk_.body.size());
  end_ = chunk_.body.size();
  if (!records_) return;
  const std::span<const std::byte> body(chunk_.body);
  for (std::size_t at = 0; at < body.size(); at += kRecordPdu)
    (void)segment(body.subspan(at, std::min(kRecordPdu, body.size() - at)), data_vc_, 0, true, cells_);
  end_ = cells_.size();
}

bool ChunkCutter::fits(std::size_t cells) const {
  if (records_) return cells_of_pdu(kPlaceBytes + chunk_.head.size()) + end_ - at_ <= cells;
  return cells_of_pdu(kPlaceBytes + end_ - at_) <= cells;
}

std::size_t ChunkCutter::cut(std::size_t cells, bool fill, std::uint32_t time, std::vector<Cell>& out) {
  return records_ ? cut_records(cells, fill, time, out) : cut_piece(cells, time, out);
}

std::size_t ChunkCutter::cut_records(std::size_t cells, bool fill, std::uint32_t time, std::vector<Cell>& out) {
  place_.time = time;
  place_.at = static_cast<std::uint32_t>(at_);
  const std::size_t before = out.size();
  (void)segment(encode_place(place_, chunk_.head), place_vc_, 0, false, out);
  const std::size_t used = out.size() - before;
  std::size_t count = std::min(cells > used ? cells - used : 1, end_ - at_);
  // End at the end of a PDU if possible. Otherwise a lost datagram would damage PDUs in other datagrams.
  if (!fill && at_ + count < end_ && count >= kRecordPduCells) count -= (at_ + count) % kRecordPduCells;
  const auto bytes_before = [](std::size_t cell) {
    return cell / kRecordPduCells * kRecordPdu + cell % kRecordPduCells * kCellPayload;
  };
  const std::size_t from = bytes_before(at_), to = std::min(bytes_before(at_ + count), chunk_.body.size());
  out.insert(out.end(), cells_.begin() + static_cast<std::ptrdiff_t>(at_),
             cells_.begin() + static_cast<std::ptrdiff_t>(at_ + count));
  at_ += count;
  // The last cell may hold only padding and the trailer, so count to the end of the body.
  return done() ? chunk_.body.size() - std::min(from, chunk_.body.size()) : to - std::min(from, to);
}

std::size_t ChunkCutter::cut_piece(std::size_t cells, std::uint32_t time, std::vector<Cell>& out) {
  place_.time = time;
  place_.at = static_cast<std::uint32_t>(at_);
  const std::size_t count = std::min(piece_bytes(cells), end_ - at_);
  (void)segment(encode_place(place_, std::span(chunk_.body).subspan(at_, count)), data_vc_, 0, true, out);
  at_ += count;
  return count;
}

}  // namespace gs::net
