#include "qnv/codecs/shared/stream_writer.h"

#include <algorithm>
#include <span>
#include <utility>

namespace gs::qnv {

std::size_t payload_budget(const StreamHeader& header, std::size_t max_bytes) {
  constexpr std::size_t kTypical = 1000;
  const std::size_t head = encode_header(header).size();
  if (max_bytes <= head) return 1;
  const std::size_t left = max_bytes - head;
  return std::max<std::size_t>(1, left * kTypical / (kTypical + kChunkHeaderBytes + kDirectoryEntryBytes));
}

void add_metadata(const std::vector<std::pair<std::string, std::string>>& metadata, Description& about) {
  std::vector<std::pair<std::string, std::string>> all = metadata;
  for (const auto& pair : about.metadata) {
    const auto same = [&](const auto& other) { return other.first == pair.first; };
    if (std::ranges::none_of(all, same)) all.push_back(pair);
  }
  about.metadata = std::move(all);
}

Protection equal_protection(const EncodeOptions& options) {
  const double loss = options.parity.value_or(0);
  return loss > 0 ? Protection{Protection::Kind::equal, loss} : Protection{};
}

EncodedStream write_stream(StreamHeader header, std::vector<OutgoingChunk> chunks, std::size_t max_bytes,
                           const Protection& protection) {
  header.parity = protection.kind != Protection::Kind::none;
  EncodedStream stream;
  stream.bytes = encode_header(header);
  ParityWriter parity(protection);
  std::vector<DirectoryEntry> directory;
  header.vectors = 0;
  // Reports whether a chunk fits. A directory needs another chunk header for every 2,000 entries.
  const auto fits = [&](std::size_t payload, bool listed) {
    const std::size_t entries = directory.size() + (listed ? 1 : 0);
    return max_bytes == 0 || stream.bytes.size() + kChunkHeaderBytes + payload + entries * kDirectoryEntryBytes +
                                     kChunkHeaderBytes * (1 + entries / 2000) <=
                                 max_bytes;
  };
  const auto append = [&](ChunkType type, std::span<const std::byte> payload) {
    const std::vector<std::byte> framed = encode_chunk(type, payload);
    stream.bytes.insert(stream.bytes.end(), framed.begin(), framed.end());
  };
  const auto append_parity = [&](const std::vector<std::vector<std::byte>>& payloads) {
    for (const std::vector<std::byte>& payload : payloads)
      if (fits(payload.size(), false)) append(ChunkType::parity, payload);
  };
  for (OutgoingChunk& chunk : chunks) {
    if (!directory.empty() && !fits(chunk.payload.size(), true)) break;
    chunk.entry.offset = stream.bytes.size();
    chunk.entry.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + chunk.payload.size());
    directory.push_back(chunk.entry);
    header.vectors += chunk.entry.vectors - chunk.replaced;
    append(chunk.type, chunk.payload);
    append_parity(parity.add(chunk));
  }
  append_parity(parity.finish());
  header.chunks = static_cast<std::uint32_t>(directory.size());
  header.directory = stream.bytes.size();
  const std::vector<std::byte> front = encode_header(header);  // of the same size
  std::ranges::copy(front, stream.bytes.begin());
  const std::vector<std::byte> tail = encode_directory(directory, header.description.box);
  stream.bytes.insert(stream.bytes.end(), tail.begin(), tail.end());
  stream.header = std::move(header);
  return stream;
}

}  // namespace gs::qnv
