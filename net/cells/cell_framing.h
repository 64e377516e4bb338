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

/// Kind of the data after a place. `parity` has no place and uses its own channel (cell_parity.h).
enum class PlaceKind : std::uint8_t { records = 1, piece = 2, base = 3, parity = 4 };
struct Place {
  PlaceKind kind = PlaceKind::piece;
  std::uint8_t stream = 0;
  std::uint32_t version = 0;  // of the source
  std::uint32_t time = 0;     // send time: microseconds, the low 32 bits
  std::uint32_t chunk = 0;    // number of the chunk; base: number of the block
  std::uint32_t total = 0;    // bytes of the chunk's body; base: bytes of the base
  std::uint32_t at = 0;       // records: number of the next cell; piece: offset; base: number of the symbol
  friend bool operator==(const Place&, const Place&) = default;
};
constexpr std::size_t kPlaceBytes = 24;

/// Encodes the user data of a place PDU: the place, then the chunk's head, or the bytes of a piece or symbol.
[[nodiscard]] std::vector<std::byte> encode_place(const Place& place, std::span<const std::byte> rest);
/// Decodes a place and sets `rest` to the bytes after it. Returns nullopt if the place is missing or invalid. Safe for
/// untrusted bytes.
[[nodiscard]] std::optional<Place> decode_place(std::span<const std::byte> bytes, std::span<const std::byte>& rest);

/// Returns the bytes of a piece or symbol that fit into a datagram of `cells` cells.
[[nodiscard]] constexpr std::size_t piece_bytes(std::size_t cells) {
  return cells * kCellPayload - kAal5Trailer - kPlaceBytes;
}

/// Returns the number of cells of a chunk of records: consecutive PDUs of 47 records, the last one shorter.
[[nodiscard]] constexpr std::uint32_t cells_of_records(std::size_t bytes) {
  const std::size_t rest = bytes % kRecordPdu;
  return static_cast<std::uint32_t>(bytes / kRecordPdu * kRecordPduCells + (rest > 0 ? cells_of_pdu(rest) : 0));
}

/// Makes the datagrams of one chunk in order.
class ChunkCutter {
 public:
  /// Reports whether `chunk` satisfies the limits of CellChunk.
  static bool sound(const CellChunk& chunk, bool records);
  ChunkCutter(CellChunk chunk, bool records, std::size_t slot, Place place);
  [[nodiscard]] bool done() const { return at_ >= end_; }
  /// Reports whether the rest of the chunk fits into `cells` cells.
  [[nodiscard]] bool fits(std::size_t cells) const;
  /// Appends at most `cells` cells (at least kMinCells) and returns the bytes of the body in them. Ends at the end
  /// of a PDU of records if one fits, unless `fill`.
  std::size_t cut(std::size_t cells, bool fill, std::uint32_t time, std::vector<Cell>& out);

 private:
  std::size_t cut_records(std::size_t cells, bool fill, std::uint32_t time, std::vector<Cell>& out);
  std::size_t cut_piece(std::size_t cells, std::uint32_t time, std::vector<Cell>& out);

  CellChunk chunk_;
  bool records_;
  Vc place_vc_, data_vc_;
  Place place_;
  std::size_t at_ = 0, end_ = 0;  // cells for records, bytes for other chunks
  std::vector<Cell> cells_;       // all cells of a chunk of records
};

}  // namespace gs::net
