#pragma once

#include "net/atm/aal5.h"
#include "net/atm/cells.h"
#include "net/cells/cell_source.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

// PDUs of GhostSpace's cells (CELLS.md).

constexpr std::uint16_t kBaseVci = 32, kPlaceVci = 33, kFirstDataVci = 64;
/// Returns the virtual path of a client's slot (0 to 7).
[[nodiscard]] constexpr std::uint16_t path_of_slot(std::size_t slot) { return static_cast<std::uint16_t>(1 + slot); }

/// Kind of a PDU with a head. A `parity` PDU has an own head and channel (cell_parity.h). The head of other kinds is a
/// Place.
enum class PlaceKind : std::uint8_t { records = 1, piece = 2, base = 3, parity = 4 };
struct Place {
  PlaceKind kind = PlaceKind::piece;
  std::uint8_t stream = 0;
  std::uint32_t version = 0;  // version of the source
  std::uint32_t time = 0;  // send time: the server's clock in microseconds, the low 32 bits
  std::uint32_t chunk = 0;  // index of the chunk; base: index of the block
  std::uint32_t total = 0;  // total bytes of the chunk's body; base: total bytes of the base
  std::uint32_t at = 0;  // records: index of the next cell; piece: byte offset; base: index of the symbol
  friend bool operator==(const Place&, const Place&) = default;
};
constexpr std::size_t kPlaceBytes = 24;

/// Encodes the user data of a place PDU: the place, then `rest`. For records, `rest` is the head of the chunk;
/// otherwise it is the bytes of a piece or symbol.
[[nodiscard]] std::vector<std::byte> encode_place(const Place& place, std::span<const std::byte> rest);
/// Decodes a place and sets `rest` to the bytes after it. Returns nullopt if the bytes hold no valid place. Safe for
/// untrusted bytes.
[[nodiscard]] std::optional<Place> decode_place(std::span<const std::byte> bytes, std::span<const std::byte>& rest);

/// Returns the bytes of a piece or symbol that fit into a datagram of `cells` cells, after the place.
[[nodiscard]] constexpr std::size_t piece_bytes(std::size_t cells) {
  return cells * kCellPayload - kAal5Trailer - kPlaceBytes;
}

/// Returns the number of cells of a chunk of records. A chunk is divided into PDUs of 47 records; the last PDU may be
/// shorter.
[[nodiscard]] constexpr std::uint32_t cells_of_records(std::size_t bytes) {
  const std::size_t rest = bytes % kRecordPdu;
  return static_cast<std::uint32_t>(bytes / kRecordPdu * kRecordPduCells + (rest > 0 ? cells_of_pdu(rest) : 0));
}

/// Makes the datagrams of one chunk, in order.
class ChunkCutter {
 public:
  /// Reports whether `chunk` satisfies the limits of CellChunk.
  static bool sound(const CellChunk& chunk, bool records);
  ChunkCutter(CellChunk chunk, bool records, std::size_t slot, Place place);
  [[nodiscard]] bool done() const { return at_ >= end_; }
  /// Reports whether the unsent part of the chunk fits into `cells` cells.
  [[nodiscard]] bool fits(std::size_t cells) const;
  /// Appends at most `cells` cells (at least kMinCells) to `out`. Returns the bytes of the chunk's body in them. For
  /// records, stops at the last end of a PDU that fits, unless `fill` is true.
  std::size_t cut(std::size_t cells, bool fill, std::uint32_t time, std::vector<Cell>& out);

 private:
  std::size_t cut_records(std::size_t cells, bool fill, std::uint32_t time, std::vector<Cell>& out);
  std::size_t cut_piece(std::size_t cells, std::uint32_t time, std::vector<Cell>& out);

  CellChunk chunk_;
  bool records_;
  Vc place_vc_, data_vc_;
  Place place_;
  std::size_t at_ = 0, end_ = 0;  // next and end position: in cells for records, in bytes for other chunks
  std::vector<Cell> cells_;  // cells of the whole chunk; only for records
};

}  // namespace gs::net
