#include "net/atm/cells.h"

#include "net/base/network_bytes.h"

#include <algorithm>

namespace gs::net {
namespace {

constexpr std::uint32_t kBottomOfStack = 1U << 8;
constexpr std::uint32_t kTimeToLive = 64;
constexpr std::uint32_t kLargestVpi = 0xfff;
constexpr std::uint64_t kSequences = 65535;  // Sequence numbers run from 1 to 65535. 0 is never used.

std::uint32_t header_word(const Cell& cell) {
  return (cell.vc.vpi & kLargestVpi) << 20 | static_cast<std::uint32_t>(cell.vc.vci) << 4 | (cell.type & 7U) << 1 |
         (cell.low_priority ? 1U : 0U);
}

void read_header(std::uint32_t word, Cell& cell) {
  cell.vc = {static_cast<std::uint16_t>(word >> 20), static_cast<std::uint16_t>(word >> 4 & 0xffff)};
  cell.type = word >> 1 & 7;
  cell.low_priority = (word & 1) != 0;
}

}  // namespace

std::vector<std::byte> encode_datagram(std::uint32_t label, std::uint16_t sequence, std::span<const Cell> cells) {
  std::vector<std::byte> bytes;
  bytes.reserve(kDatagramHeader + cells.size() * kPackedCell);
  NetworkWriter writer(bytes);
  writer.integer(label << 12 | kBottomOfStack | kTimeToLive);
  // RFC 4717 8.1: the length is only necessary if Ethernet may pad the datagram: up to 63 bytes with the control word.
  const std::size_t length = 4 + cells.size() * kPackedCell;
  writer.integer(static_cast<std::uint16_t>(length < 64 ? length : 0));
  writer.integer(sequence);
  for (const Cell& cell : cells) {
    writer.integer(header_word(cell));
    writer.bytes(cell.payload);
  }
  return bytes;
}

std::variant<CellDatagram, CellError> decode_datagram(std::span<const std::byte> bytes) {
  NetworkReader reader(bytes);
  const auto entry = reader.integer<std::uint32_t>();
  const auto flags = reader.integer<std::uint16_t>();
  CellDatagram datagram;
  datagram.sequence = reader.integer<std::uint16_t>();
  if (!reader.good()) return CellError{"a cell datagram is too short; expected a label and a control word"};
  if ((entry & kBottomOfStack) == 0) return CellError{"a cell datagram has several labels; expected one"};
  if (flags >> 12 != 0) return CellError{"a cell datagram has no control word (RFC 4385)"};
  datagram.label = entry >> 12;
  const std::size_t count = reader.rest().size() / kPackedCell;
  if (count == 0 || reader.rest().size() % kPackedCell != 0)
    return CellError{"a datagram holds " + std::to_string(reader.rest().size()) +
                     " bytes of cells; expected a multiple of 52"};
  datagram.cells.resize(count);
  for (Cell& cell : datagram.cells) {
    read_header(reader.integer<std::uint32_t>(), cell);
    const auto payload = reader.bytes(kCellPayload);
    std::copy(payload.begin(), payload.end(), cell.payload.begin());
  }
  return datagram;
}

void put_associated_channel(std::vector<std::byte>& out, std::uint32_t label, std::uint16_t type) {
  NetworkWriter writer(out);
  writer.integer(label << 12 | kBottomOfStack | kTimeToLive);
  writer.integer(std::uint16_t{0x1000});  // the bits 0001, then version 0
  writer.integer(type);
}

std::optional<std::span<const std::byte>> associated_channel(std::span<const std::byte> bytes, std::uint32_t label,
                                                             std::uint16_t type) {
  NetworkReader reader(bytes);
  const auto entry = reader.integer<std::uint32_t>();
  const auto flags = reader.integer<std::uint16_t>();
  const auto channel = reader.integer<std::uint16_t>();
  if (!reader.good() || (entry & kBottomOfStack) == 0 || entry >> 12 != label || flags >> 8 != 0x10 || channel != type)
    return std::nullopt;
  return reader.rest();
}

std::uint64_t widen_sequence(std::uint16_t sequence, std::uint64_t expected) {
  const std::uint64_t residue = (sequence + kSequences - 1) % kSequences;
  const std::uint64_t base = expected - expected % kSequences;
  std::uint64_t best = base + residue;
  // The same 16 bits in the previous or the next round may be nearer to `expected`.
  if (best > expected + kSequences / 2 && best >= kSequences) return best - kSequences;
  if (best + kSequences / 2 < expected) return best + kSequences;
  return best;
}

std::uint16_t narrow_sequence(std::uint64_t running) { return static_cast<std::uint16_t>(running % kSequences + 1); }

}  // namespace gs::net
