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

/// What a client of cells tells its owner.
struct CellEvent {
  enum class Kind : std::uint8_t {
    granted,       // `rate`; the slot's pieces follow
    refused,       // `text`
    base,          // `bytes`: the whole base
    piece,         // `bytes` of chunk `name` from `offset`
    ended,         // the server has sent all; what is missing was lost
    complete,      // nothing is missing (any more); comes after `ended`
    lost_contact,  // nothing arrives; the client asks anew
    failed,        // `text`; the client has given up
  };
  Kind kind = Kind::failed;
  std::uint8_t slot = 0;
  ChunkName name;
  bool records = false;       // piece: whole records of 8 bytes; else the whole chunk
  std::uint32_t version = 0;  // of the source
  std::uint32_t total = 0, offset = 0;
  std::uint64_t rate = 0;       // bits a second
  std::vector<std::byte> head;  // piece of records: the chunk's
  std::vector<std::byte> bytes;
  std::string text;
};

/// Makes a base and pieces of chunks out of the cells of one slot. Whatever is
/// lost, what came is handed out at once. Memory: the base twice, kMostWaiting
/// bytes of chunks whose other pieces have not come, and a bit per chunk. One
/// thread; safe for untrusted cells.
class CellAssembly {
 public:
  static constexpr std::size_t kMostWaiting = std::size_t{16} << 20, kMostProgress = 4096;

  CellAssembly(std::size_t slot, const GrantMessage& grant);

  /// The cells of one datagram; those of other slots are passed over.
  void take(std::span<const Cell> cells, std::vector<CellEvent>& out);
  /// Datagrams were lost, or nothing comes: hands out what waits for its PDU's
  /// end.
  void gap(std::vector<CellEvent>& out);

  /// Whether this grant is for the same content, so that what came before still
  /// counts.
  [[nodiscard]] bool continues(const GrantMessage& grant) const;
  [[nodiscard]] bool base_done() const { return base_done_; }
  /// The newest place's time stamp since this was last asked.
  [[nodiscard]] std::optional<std::uint32_t> take_stamp() { return std::exchange(stamp_, std::nullopt); }
  /// Chunks of these streams (bits) of which something is missing, most
  /// important first, at most so many.
  [[nodiscard]] std::vector<ChunkName> missing(std::uint32_t streams, std::size_t most) const;
  [[nodiscard]] std::uint64_t damaged() const { return reassembler_.damaged(); }
  /// Bytes of bodies that were handed out, or wait for the rest of their chunk.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  /// The chunk of records that a stream's cells belong to.
  struct Group {
    bool current = false;  // the datagram at hand said so
    Place place;
    std::vector<std::byte> head;
    std::uint32_t next = 0;  // cell
  };
  struct Stream {
    bool records = false;
    std::vector<bool> done;
    Group group, previous;
  };
  struct Progress {
    std::uint32_t total = 0;
    std::uint64_t touched = 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;  // begin, end; apart, in order
    std::vector<std::byte> bytes;                                 // of what is no records
  };
  void take_cell(const Cell& cell, std::vector<CellEvent>& out);
  void take_pdus(std::vector<CellEvent>& out);
  void take_place(const Pdu& pdu);
  void take_base(const Pdu& pdu, std::vector<CellEvent>& out);
  void take_piece(std::size_t stream, const Pdu& pdu, std::vector<CellEvent>& out);
  void take_records(std::size_t stream, const Pdu& pdu, std::vector<CellEvent>& out);
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
  std::vector<Pdu> pdus_;  // what the reassembler handed out just now
  std::uint64_t clock_ = 0, waiting_bytes_ = 0, bytes_ = 0;
  std::optional<std::uint32_t> stamp_;
};

}  // namespace gs::net
