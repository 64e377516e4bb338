#include "qnv/reader/loss.h"

#include "qnv/codecs/payloads.h"
#include "qnv/container/container.h"

#include <algorithm>

namespace gs::qnv {
namespace {

// Number of bytes at the start that are never lost. Everything else depends on them, so that a transport repeats them
// or adds parity.
constexpr std::uint64_t kProtectedBytes = 16'000;
constexpr std::size_t kCountAt = 2;  // byte offset of the number of records in a records payload

// Returns a number in [0, 1) for each packet (SplitMix64, Steele et al. 2014).
double random_of(std::uint64_t seed, std::uint64_t packet) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15ULL + packet * 0xbf58476d1ce4e5b9ULL + 0x94d049bb133111ebULL;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
  return static_cast<double>((z ^ z >> 31) >> 11) / 9007199254740992.0;
}

}  // namespace

std::vector<std::byte> drop_packets(std::span<const std::byte> stream, double share, std::uint64_t seed) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  const auto header = decode_header(stream, header_bytes, need_more);
  if (!std::holds_alternative<StreamHeader>(header)) return {stream.begin(), stream.end()};
  std::vector<std::byte> out(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(header_bytes));
  const auto append = [&out](ChunkType type, std::span<const std::byte> payload) {
    const std::vector<std::byte> chunk = encode_chunk(type, payload);
    out.insert(out.end(), chunk.begin(), chunk.end());
  };
  const PayloadRow& row = row_of(std::get<StreamHeader>(header));
  std::uint64_t packet = 0;
  StreamReader reader;
  const auto take = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    const bool safe = offset < kProtectedBytes;
    if ((carries(row, type) && row.record_bytes == 0) || type == ChunkType::parity) {
      if (safe || random_of(seed, packet) >= share) append(type, payload);
    } else if (carries(row, type) && payload.size() >= row.head_bytes) {
      std::vector<std::byte> kept(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(row.head_bytes));
      const auto records = payload.subspan(row.head_bytes);
      const std::size_t packet_bytes = row.packet_records * row.record_bytes;
      for (std::size_t at = 0; at < records.size(); at += packet_bytes, ++packet)
        if (safe || random_of(seed, packet) >= share) {
          const auto part = records.subspan(at, std::min(packet_bytes, records.size() - at));
          kept.insert(kept.end(), part.begin(), part.end());
        }
      const std::size_t count = (kept.size() - row.head_bytes) / row.record_bytes;
      kept[kCountAt] = static_cast<std::byte>(count & 255);
      kept[kCountAt + 1] = static_cast<std::byte>(count >> 8 & 255);
      if (count > 0) append(type, kept);
    } else if (is_listing(type)) {
      return;  // drops the directory, because its offsets would be wrong
    }
    ++packet;
  };
  reader.push(stream, take);
  reader.finish(take);
  return out;
}

}  // namespace gs::qnv
