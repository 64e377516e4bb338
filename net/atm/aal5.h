#pragma once

#include "net/atm/cells.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

// AAL type 5 (ITU-T I.363.5): user data, padding and a trailer of 8 bytes
// (user-to-user byte, common part indicator, length, CRC-32) in a whole number
// of cells, the last of which says that it is.

constexpr std::size_t kAal5Trailer = 8;
constexpr std::size_t kMostPdu = 65535;
/// A PDU of the paper's figure 6: eight cells with 47 records of 8 bytes.
constexpr std::size_t kRecordBytes = 8, kRecordsOfPdu = 47, kRecordPdu = kRecordBytes * kRecordsOfPdu;
constexpr std::size_t kRecordPduCells = 8;

/// CRC-32 as AAL5 has it: polynomial 04C11DB7, most significant bit first,
/// start and end inverted.
[[nodiscard]] std::uint32_t aal5_crc(std::span<const std::byte> bytes);

/// How many cells a PDU takes.
[[nodiscard]] constexpr std::size_t cells_of_pdu(std::size_t bytes) {
  return (bytes + kAal5Trailer + kCellPayload - 1) / kCellPayload;
}

/// Appends the cells of one PDU. False, and nothing appended, when it is empty
/// or longer than kMostPdu.
bool segment(std::span<const std::byte> user, Vc vc, std::uint8_t user_to_user, bool low_priority,
             std::vector<Cell>& cells);

/// A PDU as it arrived.
struct Pdu {
  /// One cell of a damaged PDU.
  struct Part {
    std::uint32_t place = 0;  // of the cell in the PDU, from 0
    bool last = false;        // its last 8 bytes are the trailer
    std::array<std::byte, kCellPayload> payload{};
  };
  Vc vc;
  bool whole = false;
  std::uint64_t key = 0;          // what `seek` said; 0 without
  std::uint8_t user_to_user = 0;  // whole ones
  std::vector<std::byte> bytes;   // whole ones: the user data
  std::vector<Part> parts;        // else: the cells that came, in order
};

/// Puts PDUs together again. Hands out a PDU as soon as its last cell came,
/// with the right CRC; of a PDU that lost cells, those that came, with their
/// places. Such cells are known by their header only: no checksum covers them
/// here (in UDP, that of the datagram does). Of a PDU that is complete but has
/// a wrong CRC or length, nothing. Nothing waits: a PDU is given up when the
/// next one begins. Memory: `most_vcs` times `most_pdu` at worst; when one more
/// channel comes, the one that was silent longest is forgotten. One thread;
/// safe for untrusted cells.
class Reassembler {
 public:
  explicit Reassembler(std::size_t most_vcs = 64, std::size_t most_pdu = kMostPdu);

  /// The next cell of its channel.
  void push(const Cell& cell, std::vector<Pdu>& out);
  /// Cells of this channel were lost here; how many, where that is known.
  void lost(Vc vc, std::optional<std::uint32_t> cells, std::vector<Pdu>& out);
  /// Cells of any channel may have been lost here.
  void lost_anywhere(std::vector<Pdu>& out);
  /// The next cell of this channel is number `place` of the PDU that the owner
  /// calls `key` (not 0). If that is not the PDU at hand, or lies before its
  /// end, the one at hand is handed out as it is.
  void seek(Vc vc, std::uint64_t key, std::uint32_t place, std::vector<Pdu>& out);
  /// Nothing more comes: hands out what is there.
  void finish(std::vector<Pdu>& out);

  /// PDUs that were complete, but wrong.
  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }

 private:
  struct State {
    std::uint64_t key = 0, used = 0;
    std::uint32_t next = 0;             // place of the next cell; behind a gap of unknown
                                        // length: cells since
    bool placed = true;                 // else behind such a gap
    bool gap = false;                   // cells are missing
    bool overflow = false;              // longer than any PDU: waits for its end
    std::size_t before = 0, after = 0;  // parts before the first gap; the first
                                        // part behind the last gap
    std::vector<Pdu::Part> parts;
  };
  State& state(Vc vc, std::vector<Pdu>& out);
  void lost(Vc vc, State& state, std::optional<std::uint32_t> cells, std::vector<Pdu>& out) const;
  void end(Vc vc, State& state, std::vector<Pdu>& out);
  void end_after_gap(Vc vc, State& state, std::vector<Pdu>& out);

  std::size_t most_vcs_, most_cells_;
  std::uint64_t clock_ = 0, damaged_ = 0;
  std::map<Vc, State> states_;
};

}  // namespace gs::net
