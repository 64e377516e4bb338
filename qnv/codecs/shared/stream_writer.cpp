#include "qnv/codecs/shared/stream_writer.h"

#include <algorithm>
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

EncodedStream write_stream(StreamHeader header, std::vector<OutgoingChunk> chunks, std::size_t max_bytes) {
  std::size_t bytes = encode_header(header).size(), last = 0;
  for (; last < chunks.size(); ++last) {
    const std::size_t more = kChunkHeaderBytes + chunks[last].payload.size() + kDirectoryEntryBytes;
    // A directory needs another chunk header for every 2,000 entries.
    if (max_bytes != 0 && last > 0 && bytes + more + kChunkHeaderBytes * (1 + last / 2000) > max_bytes) break;
    bytes += more;
  }
  chunks.resize(last);
  EncodedStream stream;
  std::vector<DirectoryEntry> directory;
  std::uint64_t at = encode_header(header).size();
  header.vectors = 0;
  for (OutgoingChunk& chunk : chunks) {
    chunk.entry.offset = at;
    chunk.entry.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + chunk.payload.size());
    at += chunk.entry.bytes;
    directory.push_back(chunk.entry);
    header.vectors += chunk.entry.vectors - chunk.replaced;
  }
  header.chunks = static_cast<std::uint32_t>(chunks.size());
  header.directory = at;
  stream.bytes = encode_header(header);
  stream.bytes.reserve(bytes + 64);
  for (const OutgoingChunk& chunk : chunks) {
    const std::vector<std::byte> framed = encode_chunk(chunk.type, chunk.payload);
    stream.bytes.insert(stream.bytes.end(), framed.begin(), framed.end());
  }
  const std::vector<std::byte> tail = encode_directory(directory, header.description.box);
  stream.bytes.insert(stream.bytes.end(), tail.begin(), tail.end());
  stream.header = std::move(header);
  return stream;
}

}  // namespace gs::qnv
