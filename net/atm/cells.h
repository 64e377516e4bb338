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

// ATM cells (ITU-T I.361) and their transport in UDP datagrams. A datagram (RFC 7510) holds an MPLS label stack entry
// (RFC 3032), a control word and cells in the N-to-one mode of RFC 4717. CELLS.md describes how GhostSpace uses them.

constexpr std::size_t kCellPayload = 48;
/// Bytes of a cell in RFC 4717: the header without its check byte (HEC), and the payload.
constexpr std::size_t kPackedCell = 52;
/// Bytes of a datagram before its cells: label and control word.
constexpr std::size_t kDatagramHeader = 8;
/// Number of cells that fit into a datagram of 1400 bytes.
constexpr std::size_t kMaxCells = 26;
constexpr std::size_t kMaxDatagram = kDatagramHeader + kMaxCells * kPackedCell;
/// Bytes that the headers of IPv4 and UDP add to a datagram.
constexpr std::uint64_t kPacketHeaders = 28;
/// Virtual channel: path identifier of 12 bits (NNI) and channel identifier.
struct Vc {
  std::uint16_t vpi = 0, vci = 0;
  friend auto operator<=>(const Vc&, const Vc&) = default;
};

/// ATM cell. Bits of `type` (PTI): 0 marks the last cell of an AAL5 PDU, 1 reports congestion, 2 marks cells without
/// user data. `low_priority` (CLP) means that a congested network drops the cell first.
struct Cell {
  Vc vc;
  std::uint8_t type = 0;
  bool low_priority = false;
  std::array<std::byte, kCellPayload> payload{};
  friend bool operator==(const Cell&, const Cell&) = default;
};

/// Reason why a datagram is not valid.
struct CellError {
  std::string message;
};

/// Cells of one datagram. `sequence` counts the datagrams with the same label from 1 to 65535, then from 1 again (RFC
/// 4385 4.1). 0 means that the sender does not count.
struct CellDatagram {
  std::uint32_t label = 0;
  std::uint16_t sequence = 0;
  std::vector<Cell> cells;
};

/// Encodes a datagram of at most kMaxCells cells. All flags of the control word are 0.
[[nodiscard]] std::vector<std::byte> encode_datagram(std::uint32_t label, std::uint16_t sequence,
                                                     std::span<const Cell> cells);
/// Decodes a datagram. Refuses more than one label, an associated channel (see associated_channel()), an incomplete
/// cell, and a datagram without cells. Safe for untrusted bytes.
[[nodiscard]] std::variant<CellDatagram, CellError> decode_datagram(std::span<const std::byte> bytes);

/// Appends the header of a message on the associated channel of a label (RFC 4385 5). `type` identifies the channel;
/// 7FF8 to 7FFF hexadecimal are for experiments (RFC 5586 10).
void put_associated_channel(std::vector<std::byte>& out, std::uint32_t label, std::uint16_t type);
/// Returns the message in a datagram of the associated channel. Returns nullopt for other datagrams. Safe for untrusted
/// bytes.
[[nodiscard]] std::optional<std::span<const std::byte>> associated_channel(std::span<const std::byte> bytes,
                                                                           std::uint32_t label, std::uint16_t type);

/// Widens a 16-bit sequence number to the running number, from 0, that is nearest to `expected`. Correct if fewer than
/// 32767 consecutive datagrams are lost.
[[nodiscard]] std::uint64_t widen_sequence(std::uint16_t sequence, std::uint64_t expected);
/// Returns the 16-bit sequence number for a running number.
[[nodiscard]] std::uint16_t narrow_sequence(std::uint64_t running);

}  // namespace gs::net
