#include "qnv/codecs/octree/lod/lod_source.h"

#include "base/bytes.h"
#include "qnv/container/cluster_directory.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>
#include <utility>

namespace gs::qnv {
namespace {

class MemorySource : public ChunkSource {
 public:
  explicit MemorySource(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset >= bytes_.size()) return 0;
    const std::size_t count = std::min(to.size(), bytes_.size() - static_cast<std::size_t>(offset));
    if (count > 0) std::memcpy(to.data(), bytes_.data() + offset, count);
    return count;
  }

 private:
  std::vector<std::byte> bytes_;
};

// Returns the length of a chunk, including its header. `head` starts with that header.
std::size_t length_of(std::span<const std::byte> head) {
  ByteReader read(head);
  (void)read.integer<std::uint16_t>();
  return kChunkHeaderBytes + read.integer<std::uint16_t>();
}

}  // namespace

std::shared_ptr<const ChunkSource> memory_source(std::vector<std::byte> bytes) {
  return std::make_shared<const MemorySource>(std::move(bytes));
}

void ArrivedChunks::set_most_bytes(std::size_t most_bytes) {
  const std::unique_lock lock(mutex_);
  most_bytes_ = most_bytes;
}

bool ArrivedChunks::has(std::uint64_t offset) const {
  const std::shared_lock lock(mutex_);
  return chunks_.contains(offset);
}

bool ArrivedChunks::add(std::uint64_t offset, std::vector<std::byte> chunk) {
  const std::unique_lock lock(mutex_);
  if (chunk.size() > most_bytes_ - std::min(most_bytes_, bytes_)) return false;
  bytes_ += chunk.size();
  chunks_.emplace(offset, std::move(chunk));
  return true;
}

std::size_t ArrivedChunks::read(std::uint64_t offset, std::span<std::byte> to) const {
  const std::shared_lock lock(mutex_);
  const auto found = chunks_.find(offset);
  if (found == chunks_.end()) return 0;
  const std::size_t count = std::min(to.size(), found->second.size());
  std::copy_n(found->second.begin(), count, to.begin());
  return count;
}

std::variant<SoundChunk, std::string> sound_chunk(std::span<const std::byte> bytes) {
  if (bytes.size() < kChunkHeaderBytes || bytes.size() - kChunkHeaderBytes > kMaxChunkBytes)
    return "a chunk of " + std::to_string(bytes.size()) + " bytes; expected " + std::to_string(kChunkHeaderBytes) +
           " to " + std::to_string(kChunkHeaderBytes + kMaxChunkBytes);
  SoundChunk chunk{static_cast<ChunkType>(bytes[4]), bytes.subspan(kChunkHeaderBytes)};
  // Compares the chunk's mark, length, reserved byte and checksum with a freshly encoded header.
  const std::vector<std::byte> expected = encode_chunk(chunk.type, chunk.payload);
  if (!std::equal(expected.begin(), expected.begin() + kChunkHeaderBytes, bytes.begin()))
    return "a chunk is damaged and left out";
  return chunk;
}

std::variant<SoundChunk, std::string> read_chunk(const ChunkSource& source, std::uint64_t offset, std::size_t bytes,
                                                 std::vector<std::byte>& buffer) {
  buffer.resize(std::min(bytes, kChunkHeaderBytes + kMaxChunkBytes));
  if (source.read(offset, buffer) != buffer.size()) return "a chunk cannot be read, because the stream became shorter";
  return sound_chunk(buffer);
}

std::variant<StreamHeader, StreamProblem> read_stream_header(const ChunkSource& source, std::size_t& header_bytes) {
  std::vector<std::byte> bytes(4096);
  bool need_more = false;
  header_bytes = 0;
  bytes.resize(source.read(0, bytes));
  auto header = decode_header(bytes, header_bytes, need_more);
  if (need_more && header_bytes > bytes.size()) {
    bytes.resize(header_bytes);  // at most kMaxHeaderBytes
    bytes.resize(source.read(0, bytes));
    header = decode_header(bytes, header_bytes, need_more);
  }
  if (need_more) return StreamProblem{0, "ends inside its header"};
  return header;
}

std::vector<DirectoryEntry> read_directory(const ChunkSource& source, const StreamHeader& header) {
  if (header.directory == 0 || header.directory >= source.size()) return {};
  std::vector<DirectoryEntry> entries;
  DirectoryReader reader(header);
  std::vector<std::byte> buffer;
  std::array<std::byte, kChunkHeaderBytes> head{};
  const auto wanted = [&] { return header.chunks == 0 || entries.size() < header.chunks; };
  for (std::uint64_t at = header.directory; at < source.size() && wanted();) {
    if (source.read(at, head) != head.size()) return {};
    const auto chunk = read_chunk(source, at, length_of(head), buffer);
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    if (!sound || !reader.add(sound->type, sound->payload, entries)) return {};
    at += buffer.size();
  }
  if (entries.size() > kMaxDirectoryEntries || (header.chunks != 0 && entries.size() != header.chunks)) return {};
  return entries;
}

std::vector<DirectoryEntry> directory_of(std::span<const std::byte> chunks, const StreamHeader& header) {
  std::vector<DirectoryEntry> entries;
  DirectoryReader reader(header);
  while (!chunks.empty()) {
    const auto chunk = sound_chunk(chunks.first(std::min(chunks.size(), length_of(chunks))));
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    if (!sound || !reader.add(sound->type, sound->payload, entries)) return {};
    chunks = chunks.subspan(kChunkHeaderBytes + sound->payload.size());
  }
  if (entries.size() > kMaxDirectoryEntries || (header.chunks != 0 && entries.size() != header.chunks)) return {};
  return entries;
}

}  // namespace gs::qnv
