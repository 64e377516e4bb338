#pragma once

#include "qnv/stream/container.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Where the bytes of a stream lie: in memory, or in a file that whoever does I/O reads.
class ChunkSource {
 public:
  ChunkSource() = default;
  ChunkSource(const ChunkSource&) = delete;
  ChunkSource& operator=(const ChunkSource&) = delete;
  virtual ~ChunkSource() = default;

  /// How long the stream is.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Copies what stands from `offset` on; how many bytes came: fewer than `to` has where the stream ends or cannot be
  /// read. Several threads may read at once.
  [[nodiscard]] virtual std::size_t read(std::uint64_t offset, std::span<std::byte> to) const = 0;
};

/// A stream that lies in memory as a whole.
[[nodiscard]] std::shared_ptr<const ChunkSource> memory_source(std::vector<std::byte> bytes);

/// The chunks of a stream that have come, in any order. One thread adds; not while others read.
class ArrivedChunks : public ChunkSource {
 public:
  /// `most_bytes`: of all of them together.
  explicit ArrivedChunks(std::size_t most_bytes) : most_bytes_(most_bytes) {}
  void set_most_bytes(std::size_t most_bytes) { most_bytes_ = most_bytes; }
  /// A whole chunk that stands at `offset`. False when they would take too much memory.
  bool add(std::uint64_t offset, std::vector<std::byte> chunk);
  [[nodiscard]] bool has(std::uint64_t offset) const { return chunks_.contains(offset); }

  [[nodiscard]] std::uint64_t size() const override { return ~std::uint64_t{0}; }
  /// Only from the first byte of a chunk on, and no further than its end.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override;

 private:
  std::unordered_map<std::uint64_t, std::vector<std::byte>> chunks_;
  std::size_t most_bytes_, bytes_ = 0;
};

/// A chunk, whole and with the right checksum.
struct SoundChunk {
  ChunkType type = ChunkType::packed;
  std::span<const std::byte> payload;  // in the bytes that it was read from
};

/// Bytes that should be exactly one chunk; else what is wrong with them. Safe for untrusted bytes.
[[nodiscard]] std::variant<SoundChunk, std::string> sound_chunk(std::span<const std::byte> bytes);
/// The chunk of `bytes` bytes at `offset`, which lies in `buffer` then.
[[nodiscard]] std::variant<SoundChunk, std::string> read_chunk(const ChunkSource& source, std::uint64_t offset,
                                                               std::size_t bytes, std::vector<std::byte>& buffer);

/// The header of a stream, and how long it is.
[[nodiscard]] std::variant<StreamHeader, StreamProblem> read_stream_header(const ChunkSource& source,
                                                                           std::size_t& header_bytes);
/// All entries of the directory; empty unless it is whole.
[[nodiscard]] std::vector<DirectoryEntry> read_directory(const ChunkSource& source, const StreamHeader& header);
/// The same of the bytes of its chunks, one after the other.
[[nodiscard]] std::vector<DirectoryEntry> directory_of(std::span<const std::byte> chunks, const StreamHeader& header);

}  // namespace gs::qnv
