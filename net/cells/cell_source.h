#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::net {

/// Box in 1/65535 of the source's own box: lower corner, upper corner.
using CellBox = std::array<std::uint16_t, 6>;

/// Part of a source that decodes alone.
struct CellChunk {
  /// Records only: data that a reader needs before the records, at most kMaxChunkHead bytes. It is part of every
  /// datagram, so that each datagram decodes alone.
  std::vector<std::byte> head;
  /// Body of 1 to kMaxChunkBody bytes. For records: complete records of 8 bytes.
  std::vector<std::byte> body;
};
constexpr std::size_t kMaxChunkHead = 64, kMaxChunkBody = std::size_t{1} << 20;
constexpr std::size_t kMaxStreams = 16, kMaxChunks = std::size_t{1} << 20;

/// Data of a server of cells: a base that must be received, and streams of chunks, any of which may be lost. The owner
/// implements it over files. The server calls it from one thread; calls may read a disk.
class CellSource {
 public:
  CellSource() = default;
  CellSource(const CellSource&) = delete;
  CellSource& operator=(const CellSource&) = delete;
  virtual ~CellSource() = default;

  /// Returns a number that identifies the version of the content.
  [[nodiscard]] virtual std::uint32_t version() const = 0;
  /// Returns the data that is sent first, with protection: headers and first chunks. At most 4 MiB; about 15 kB are
  /// best.
  [[nodiscard]] virtual std::span<const std::byte> base() const = 0;
  /// Returns the number of streams, such as resolutions, 1 to kMaxStreams. They are sent one after the other.
  [[nodiscard]] virtual std::size_t streams() const = 0;
  /// Reports whether the chunks of a stream are records of 8 bytes, of which any subset is useful. Of other streams,
  /// only whole chunks are.
  [[nodiscard]] virtual bool records(std::size_t stream) const = 0;
  /// Returns the number of chunks of a stream, at most kMaxChunks. Chunks are numbered by importance, most important
  /// first.
  [[nodiscard]] virtual std::uint32_t chunks(std::size_t stream) const = 0;
  /// Returns the box of a chunk. Returns nullopt if it is unknown; the chunk then belongs to every region.
  [[nodiscard]] virtual std::optional<CellBox> box(std::size_t stream, std::uint32_t chunk) const = 0;
  /// Reads a chunk. Returns nullopt if it cannot be read; the server then leaves it out.
  [[nodiscard]] virtual std::optional<CellChunk> chunk(std::size_t stream, std::uint32_t chunk) = 0;
};

/// Lookup of sources for a server.
class CellLibrary {
 public:
  CellLibrary() = default;
  CellLibrary(const CellLibrary&) = delete;
  CellLibrary& operator=(const CellLibrary&) = delete;
  virtual ~CellLibrary() = default;
  /// Opens a source, or returns a refusal that the client displays. `path` is untrusted text of at most kMaxPath
  /// bytes. Clients of one path may share a source.
  [[nodiscard]] virtual std::variant<std::shared_ptr<CellSource>, std::string> open(const std::string& path) = 0;
};

}  // namespace gs::net
