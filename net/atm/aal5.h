#pragma once

#include "net/atm/cells.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

// AAL type 5 (ITU-T I.363.5): user data, padding and a trailer of 8 bytes fill a whole number of cells. The trailer
// holds the user-to-user byte, common part indicator, length and CRC-32. A bit in the header of the last cell marks the
// end.

constexpr std::size_t kAal5Trailer = 8;
constexpr std::size_t kMaxPdu = 65535;
/// PDU of the paper's figure 6: eight cells with 47 records of 8 bytes.
constexpr std::size_t kRecordBytes = 8, kRecordsOfPdu = 47, kRecordPdu = kRecordBytes * kRecordsOfPdu;
constexpr std::size_t kRecordPduCells = 8;

/// Computes the CRC-32 of AAL5: polynomial 04C11DB7, most significant bit first. The start value is all ones, and the
/// result is inverted.
[[nodiscard]] std::uint32_t aal5_crc(std::span<const std::byte> bytes);

/// Returns the number of cells for `bytes` bytes of user data.
[[nodiscard]] constexpr std::size_t cells_of_pdu(std::size_t bytes) {
  return (bytes + kAal5Trailer + kCellPayload - 1) / kCellPayload;
}

/// Appends the cells of one PDU with the data `user`. Returns false and appends nothing if `user` is empty or longer
/// than kMaxPdu.
bool segment(std::span<const std::byte> user, Vc vc, std::uint8_t user_to_user, bool low_priority,
             std::vector<Cell>& cells);

/// PDU that the Reassembler returns.
struct Pdu {
  /// Received cell of an incomplete PDU.
  struct Part {
    std::uint32_t place = 0;  // index of the cell in the PDU, from 0
    bool last = false;  // true if the last 8 bytes are the trailer
    std::array<std::byte, kCellPayload> payload{};
  };
  Vc vc;
  bool whole = false;
  std::uint64_t key = 0;  // caller's key from Reassembler::seek(); 0 means none
  std::uint8_t user_to_user = 0;  // complete PDUs only
  std::vector<std::byte> bytes;   // complete PDUs only: the user data
  std::vector<Part> parts;        // incomplete PDUs only: the received cells, in order
};

/// Reassembles PDUs.
///
/// Returns a PDU when its last cell is received and its CRC is right. Drops a complete PDU with a wrong CRC or length.
/// Returns the received cells of an incomplete PDU with their indexes when the next PDU begins. No checksum of AAL5
/// covers these cells; in UDP, the checksum of the datagram does.
///
/// Memory: at most `most_vcs` times `most_pdu`. A further channel replaces the channel that was silent longest. One
/// thread. Safe for untrusted cells.
class Reassembler {
 public:
  explicit Reassembler(std::size_t most_vcs = 64, std::size_t most_pdu = kMaxPdu);

  /// Takes the next cell of its channel. Appends finished PDUs to `out`.
  void push(const Cell& cell, std::vector<Pdu>& out);
  /// Records that cells of any channel may be lost. Appends all incomplete PDUs to `out`.
  void lost_anywhere(std::vector<Pdu>& out);
  /// Announces that the next cell of this channel has index `place` in the PDU with the caller's key `key` (not 0).
  /// If the current PDU has another key, or is already past `place`, appends that PDU to `out` as incomplete.
  void seek(Vc vc, std::uint64_t key, std::uint32_t place, std::vector<Pdu>& out);

  /// Returns the number of complete PDUs that were dropped, because of a wrong CRC or length.
  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }

 private:
  struct State {
    std::uint64_t key = 0, used = 0;
    // Index of the next cell in the PDU. After a gap of unknown length, it counts the cells after the gap.
    std::uint32_t next = 0;
    bool placed = true;  // the index of the next cell is known; false after a gap of unknown length
    bool gap = false;  // cells of the current PDU are missing
    bool overflow = false;  // the PDU exceeds the maximum; its cells are dropped
    std::vector<Pdu::Part> parts;
  };
  State& state(Vc vc, std::vector<Pdu>& out);
  static void lost(Vc vc, State& state, std::vector<Pdu>& out);
  void end(Vc vc, State& state, std::vector<Pdu>& out);
  void end_after_gap(Vc vc, State& state, std::vector<Pdu>& out);

  std::size_t most_vcs_, most_cells_;
  std::uint64_t clock_ = 0, damaged_ = 0;
  std::map<Vc, State> states_;
};

}  // namespace gs::net
