#pragma once

#include "net/atm/aal5.h"
#include "net/cells/cell_contract.h"
#include "net/cells/cell_framing.h"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::net {

/// Event that a client of cells reports to its owner.
struct CellEvent {
  enum class Kind : std::uint8_t {
    granted,       // `rate`, `chunks`; chunks of the slot will follow
    refused,       // `text`: the reason
    base,          // `bytes`: the complete base
    piece,         // `bytes` of chunk `name` from `offset` on
    ended,         // the server has sent everything; data that is missing was lost
    complete,      // no data is missing; follows `ended`
    lost_contact,  // no datagrams are received; the client asks the server again
    failed,        // `text`: the reason; the client has stopped
  };
  Kind kind = Kind::failed;
  std::uint8_t slot = 0;
  ChunkName name;
  bool records = false;  // piece: true if `bytes` are whole records of 8 bytes; false if they are the whole chunk
  std::uint32_t version = 0;  // version of the source
  std::uint32_t total = 0, offset = 0;
  std::uint64_t rate = 0;       // bits per second
  std::vector<std::byte> head;  // head of the chunk, for a piece of records
  std::vector<std::byte> bytes;
  std::vector<std::uint32_t> chunks;  // granted: the chunks of each stream
  std::string text;
};

/// Assembles the base and the chunks of one slot from its cells. Returns received data at once, even after losses.
/// Memory: the base twice, kMaxWaiting bytes of incomplete chunks, and one bit per chunk. One thread. Safe for
/// untrusted cells.
class CellAssembly {
 public:
  static constexpr std::size_t kMaxWaiting = std::size_t{16} << 20, kMaxProgress = 4096;

  CellAssembly(std::size_t slot, const GrantMessage& grant);

  /// Takes the cells of one datagram and appends events to `out`. Ignores cells of other slots.
  void take(std::span<const Cell> cells, std::vector<CellEvent>& out);
  /// Records that datagrams are missing, or a pause. Appends the received cells of incomplete PDUs to `out`.
  void gap(std::vector<CellEvent>& out);

  /// Reports whether a new grant is for the same content. If so, the received data remains valid.
  [[nodiscard]] bool continues(const GrantMessage& grant) const;
  [[nodiscard]] bool base_done() const { return base_done_; }
  /// Returns and clears the time stamp of the newest place or symbol.
  [[nodiscard]] std::optional<std::uint32_t> take_stamp() { return std::exchange(stamp_, std::nullopt); }
  /// Reports whether a chunk was received, or is none of the source.
  [[nodiscard]] bool has(const ChunkName& name) const;
  /// Takes a received chunk again.
  void forget(const ChunkName& name);
  /// Returns at most `most` incomplete chunks of the streams in the bit set `streams`, most important first.
  [[nodiscard]] std::vector<ChunkName> missing(std::uint32_t streams, std::size_t most) const;
  [[nodiscard]] std::uint64_t damaged() const { return reassembler_.damaged(); }

 private:
  /// Chunk of records to which the next cells of a stream belong.
  struct Group {
    bool current = false;  // the current datagram contains the place PDU of the chunk
    Place place;
    std::vector<std::byte> head;
    std::uint32_t next = 0;  // index of the next cell
  };
  struct Stream {
    bool records = false;
    std::vector<bool> done;
    Group group, previous;
  };
  struct Progress {
    std::uint32_t total = 0;
    std::uint64_t touched = 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;  // sorted pairs of begin and end; disjoint
    std::vector<std::byte> bytes;  // empty for chunks of records
  };
  void handle_cell(const Cell& cell, std::vector<CellEvent>& out);
  void handle_pdus(std::vector<CellEvent>& out);
  void handle_place(const Pdu& pdu);
  void handle_base(const Pdu& pdu, std::vector<CellEvent>& out);
  void handle_piece(std::size_t stream, const Pdu& pdu, std::vector<CellEvent>& out);
  void handle_records(std::size_t stream, const Pdu& pdu, std::vector<CellEvent>& out);
  void put_records(std::size_t stream, const Group& group, std::uint32_t offset, std::span<const std::byte> bytes,
                   std::vector<CellEvent>& out);
  void hand_out_records(const ChunkName& name, const Group& group, std::uint32_t offset,
                        std::span<const std::byte> bytes, std::vector<CellEvent>& out);
  Progress& progress(const ChunkName& name, std::uint32_t total);
  void forget_one();
  void forget(std::map<ChunkName, Progress>::iterator at);

  std::uint16_t path_;
  std::uint8_t slot_;
  std::uint32_t version_, base_crc_;
  Reassembler reassembler_;
  ErasureLayout layout_;
  std::optional<ErasureDecoder> base_;
  bool base_done_ = false;
  std::vector<Stream> streams_;
  std::map<ChunkName, Progress> progress_;
  std::vector<Pdu> pdus_;  // output of the reassembler, reused
  std::uint64_t clock_ = 0, waiting_bytes_ = 0;
  std::optional<std::uint32_t> stamp_;
};

}  // namespace gs::net
