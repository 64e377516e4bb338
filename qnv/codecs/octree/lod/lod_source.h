#pragma once

#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <span>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Random access to the bytes of a stream, in memory or in a file.
class ChunkSource {
 public:
  ChunkSource() = default;
  ChunkSource(const ChunkSource&) = delete;
  ChunkSource& operator=(const ChunkSource&) = delete;
  virtual ~ChunkSource() = default;

  /// Returns the length of the stream, in bytes.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Copies bytes from `offset` on to `to`. Returns the number of bytes copied; it is less than the size of `to` at the
  /// end of the stream or on failure. Safe from several threads at once.
  [[nodiscard]] virtual std::size_t read(std::uint64_t offset, std::span<std::byte> to) const = 0;
};

/// Returns a source for a stream that is completely in memory.
[[nodiscard]] std::shared_ptr<const ChunkSource> memory_source(std::vector<std::byte> bytes);

/// Received chunks of a stream, in any order. Any thread.
class ArrivedChunks : public ChunkSource {
 public:
  /// `most_bytes` limits the total size of the chunks.
  explicit ArrivedChunks(std::size_t most_bytes) : most_bytes_(most_bytes) {}
  void set_most_bytes(std::size_t most_bytes);
  /// Adds a whole chunk at `offset`. Returns false if the limit would be exceeded.
  bool add(std::uint64_t offset, std::vector<std::byte> chunk);
  [[nodiscard]] bool has(std::uint64_t offset) const;

  [[nodiscard]] std::uint64_t size() const override { return ~std::uint64_t{0}; }
  /// Reads from one chunk. `offset` must be the start of the chunk; stops at its end.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override;

 private:
  mutable std::shared_mutex mutex_;  // guards all members below
  std::unordered_map<std::uint64_t, std::vector<std::byte>> chunks_;
  std::size_t most_bytes_, bytes_ = 0;
};

/// Complete chunk with a valid checksum.
struct SoundChunk {
  ChunkType type = ChunkType::packed;
  std::span<const std::byte> payload;  // view into the parsed bytes
};

/// Parses bytes that must be exactly one chunk. Otherwise returns the reason as text. Safe for untrusted bytes.
[[nodiscard]] std::variant<SoundChunk, std::string> sound_chunk(std::span<const std::byte> bytes);
/// Reads the chunk of `bytes` bytes at `offset` into `buffer`, and parses it like sound_chunk().
[[nodiscard]] std::variant<SoundChunk, std::string> read_chunk(const ChunkSource& source, std::uint64_t offset,
                                                               std::size_t bytes, std::vector<std::byte>& buffer);

/// Reads the header of a stream. Writes its length in bytes to the last argument.
[[nodiscard]] std::variant<StreamHeader, StreamProblem> read_stream_header(const ChunkSource& source,
                                                                           std::size_t& header_bytes);
/// Reads all directory entries. Returns an empty list if the directory is incomplete.
[[nodiscard]] std::vector<DirectoryEntry> read_directory(const ChunkSource& source, const StreamHeader& header);
/// Decodes all directory entries from the concatenated directory chunks.
[[nodiscard]] std::vector<DirectoryEntry> directory_of(std::span<const std::byte> chunks, const StreamHeader& header);

}  // namespace gs::qnv
