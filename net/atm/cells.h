#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

// ATM cells (ITU-T I.361) and how they travel in UDP datagrams: an MPLS label
// stack entry (RFC 3032), a control word and cells in the N-to-one mode of RFC
// 4717, in UDP as RFC 7510 has it. How GhostSpace uses them: CELLS.md.

constexpr std::size_t kCellPayload = 48;
/// A cell as RFC 4717 carries it: the header without its check byte, and the
/// payload.
constexpr std::size_t kPackedCell = 52;
/// A cell on a line: with its header error control.
constexpr std::size_t kLineCell = 53;
/// What a datagram holds before its cells: label and control word.
constexpr std::size_t kDatagramHeader = 8;
/// So many cells fit into a datagram of 1400 bytes.
constexpr std::size_t kMostCells = 26;
constexpr std::size_t kMostDatagram = kDatagramHeader + kMostCells * kPackedCell;
/// Bytes that the headers of IPv4 and UDP add to a datagram.
constexpr std::uint64_t kPacketHeaders = 28;
/// Where MPLS in UDP is expected (RFC 7510).
constexpr std::uint16_t kMplsPort = 6635;

/// A virtual channel: path identifier of 12 bits (NNI) and channel identifier.
struct Vc {
  std::uint16_t vpi = 0, vci = 0;
  friend auto operator<=>(const Vc&, const Vc&) = default;
};

/// One cell. `type` is the PTI: bit 0 tells the last cell of an AAL5 PDU, bit 1
/// congestion, bit 2 that it is no user data. `low_priority` is the CLP bit:
/// dropped first.
struct Cell {
  Vc vc;
  std::uint8_t type = 0;
  bool low_priority = false;
  std::array<std::byte, kCellPayload> payload{};
  friend bool operator==(const Cell&, const Cell&) = default;
};

/// Why a datagram was refused.
struct CellError {
  std::string message;
};

/// CRC-8 of a header of four bytes, x^8 + x^2 + x + 1, plus 55 hexadecimal
/// (I.432.1 4.3.2).
[[nodiscard]] std::uint8_t header_check(std::span<const std::byte, 4> header);

/// The 53 bytes of a cell on a line.
[[nodiscard]] std::array<std::byte, kLineCell> encode_line_cell(const Cell& cell);

/// Reads cells from a line. As I.432.1 4.3.2.2 has it: a single wrong bit of a
/// header is mended, after that the next damaged header is refused, until a
/// sound one has come. Safe for untrusted bytes.
class LineReceiver {
 public:
  /// Nothing when the header is damaged.
  [[nodiscard]] std::optional<Cell> receive(std::span<const std::byte, kLineCell> bytes);
  [[nodiscard]] std::uint64_t corrected() const { return corrected_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  bool correcting_ = true;
  std::uint64_t corrected_ = 0, refused_ = 0;
};

/// The cells of one datagram, and its number among those with the same label: 1
/// to 65535, then 1 again (RFC 4385 4.1); 0 means that the sender does not
/// count.
struct CellDatagram {
  std::uint32_t label = 0;
  std::uint16_t sequence = 0;
  std::vector<Cell> cells;
};

/// `cells` of at most kMostCells, all of the control word's flags 0.
[[nodiscard]] std::vector<std::byte> encode_datagram(std::uint32_t label, std::uint16_t sequence,
                                                     std::span<const Cell> cells);
/// Safe for untrusted bytes. Refuses more than one label, an associated channel
/// (see is_associated_channel), and what is no whole number of cells, at least
/// one.
[[nodiscard]] std::variant<CellDatagram, CellError> decode_datagram(std::span<const std::byte> bytes);

/// A message beside the cells, on the associated channel of their label (RFC
/// 4385 5): `type` tells which, 7FF8 to 7FFF hexadecimal are free for
/// experiments (RFC 5586 10).
void put_associated_channel(std::vector<std::byte>& out, std::uint32_t label, std::uint16_t type);
/// What follows if the datagram is such a message; nothing otherwise. Safe for
/// untrusted bytes.
[[nodiscard]] std::optional<std::span<const std::byte>> associated_channel(std::span<const std::byte> bytes,
                                                                           std::uint32_t label, std::uint16_t type);

/// Widens the 16 bits of the control word: the running number, from 0, of the
/// datagram that is nearest to `expected`. Right as long as fewer than 32767
/// datagrams in a row are lost.
[[nodiscard]] std::uint64_t widen_sequence(std::uint16_t sequence, std::uint64_t expected);
/// The 16 bits for a running number.
[[nodiscard]] std::uint16_t narrow_sequence(std::uint64_t running);

}  // namespace gs::net
