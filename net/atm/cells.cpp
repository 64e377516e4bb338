#include "net/atm/cells.h"

#include "net/base/network_bytes.h"

#include <algorithm>

namespace gs::net {
namespace {

constexpr std::uint32_t kBottomOfStack = 1U << 8;
constexpr std::uint32_t kTimeToLive = 64;
constexpr std::uint32_t kLargestVpi = 0xfff;
constexpr std::uint64_t kSequences = 65535;  // 1 to 65535; 0 is skipped

constexpr std::array<std::uint8_t, 256> check_table() {
  std::array<std::uint8_t, 256> table{};
  for (unsigned value = 0; value < 256; ++value) {
    unsigned crc = value;
    for (int bit = 0; bit < 8; ++bit) crc = crc << 1 ^ ((crc & 128) != 0 ? 0x107U : 0U);
    table[value] = static_cast<std::uint8_t>(crc);
  }
  return table;
}
constexpr auto kCheckTable = check_table();

std::uint32_t header_word(const Cell& cell) {
  return (cell.vc.vpi & kLargestVpi) << 20 | static_cast<std::uint32_t>(cell.vc.vci) << 4 | (cell.type & 7U) << 1 |
         (cell.low_priority ? 1U : 0U);
}

void read_header(std::uint32_t word, Cell& cell) {
  cell.vc = {static_cast<std::uint16_t>(word >> 20), static_cast<std::uint16_t>(word >> 4 & 0xffff)};
  cell.type = word >> 1 & 7;
  cell.low_priority = (word & 1) != 0;
}

std::array<std::byte, 4> word_bytes(std::uint32_t word) {
  return {static_cast<std::byte>(word >> 24), static_cast<std::byte>(word >> 16 & 255),
          static_cast<std::byte>(word >> 8 & 255), static_cast<std::byte>(word & 255)};
}

/// Returns the single damaged bit of the 40 that gives this syndrome, or nullopt.
std::optional<int> damaged_bit(std::uint8_t syndrome) {
  for (int bit = 0; bit < 40; ++bit) {
    if (bit >= 32) {
      if (syndrome == 1U << (39 - bit)) return bit;
      continue;
    }
    const std::array<std::byte, 4> error = word_bytes(1U << (31 - bit));
    if ((header_check(error) ^ 0x55) == syndrome) return bit;
  }
  return std::nullopt;
}

}  // namespace

std::uint8_t header_check(std::span<const std::byte, 4> header) {
  std::uint8_t crc = 0;
  for (const std::byte byte : header) crc = kCheckTable[crc ^ std::to_integer<std::uint8_t>(byte)];
  return crc ^ 0x55;
}

std::array<std::byte, kLineCell> encode_line_cell(const Cell& cell) {
  std::array<std::byte, kLineCell> bytes{};
  const auto header = word_bytes(header_word(cell));
  std::copy(header.begin(), header.end(), bytes.begin());
  bytes[4] = static_cast<std::byte>(header_check(header));
  std::copy(cell.payload.begin(), cell.payload.end(), bytes.begin() + 5);
  return bytes;
}

std::optional<Cell> LineReceiver::receive(std::span<const std::byte, kLineCell> bytes) {
  std::array<std::byte, 4> header{};
  std::copy_n(bytes.begin(), 4, header.begin());
  const auto syndrome = static_cast<std::uint8_t>(header_check(header) ^ std::to_integer<std::uint8_t>(bytes[4]));
  const bool correcting = correcting_;
  correcting_ = syndrome == 0;
  if (syndrome != 0) {
    const auto bit = correcting ? damaged_bit(syndrome) : std::nullopt;
    if (!bit) {
      ++refused_;
      return std::nullopt;
    }
    ++corrected_;
    if (*bit < 32) {
      const auto at = static_cast<std::size_t>(*bit);
      header[at / 8] ^= static_cast<std::byte>(128 >> at % 8);
    }
  }
  Cell cell;
  read_header(NetworkReader(header).integer<std::uint32_t>(), cell);
  std::copy_n(bytes.begin() + 5, kCellPayload, cell.payload.begin());
  return cell;
}

std::vector<std::byte> encode_datagram(std::uint32_t label, std::uint16_t sequence, std::span<const Cell> cells) {
  std::vector<std::byte> bytes;
  bytes.reserve(kDatagramHeader + cells.size() * kPackedCell);
  NetworkWriter writer(bytes);
  writer.integer(label << 12 | kBottomOfStack | kTimeToLive);
  // RFC 4717 8.1: the length field is needed only for Ethernet's padding, up to 63 bytes with the control word.
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
  writer.integer(std::uint16_t{0x1000});  // 0001, version 0
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
  // The number of the previous or the next round may be nearer.
  if (best > expected + kSequences / 2 && best >= kSequences) return best - kSequences;
  if (best + kSequences / 2 < expected) return best + kSequences;
  return best;
}

std::uint16_t narrow_sequence(std::uint64_t running) { return static_cast<std::uint16_t>(running % kSequences + 1); }

}  // namespace gs::net
