#pragma once

#include "base/noncopyable.h"

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

/// Box in units of 1/65535 of the source's box: lower corner, then upper corner.
using CellBox = std::array<std::uint16_t, 6>;

/// Part of a source that decodes without other chunks.
struct CellChunk {
  /// For records only: data that a reader needs before the records, at most kMaxChunkHead bytes. Each datagram of the
  /// chunk contains the head, so that it decodes alone.
  std::vector<std::byte> head;
  /// Body of 1 to kMaxChunkBody bytes. For records, it consists of whole records of 8 bytes.
  std::vector<std::byte> body;
};
constexpr std::size_t kMaxChunkHead = 64, kMaxChunkBody = std::size_t{1} << 20;
constexpr std::size_t kMaxStreams = 16, kMaxChunks = std::size_t{1} << 20;

/// Data that a cell server sends: a base, which clients must receive completely, and streams of chunks, which may be
/// lost. The owner implements it over files. The server calls it on one thread; calls may read a disk.
class CellSource : NonCopyable {
 public:
  virtual ~CellSource() = default;

  /// Returns a number that identifies the version of the content.
  [[nodiscard]] virtual std::uint32_t version() const = 0;
  /// Returns the base: data that is sent first, protected by parity, such as headers and first chunks. At most 4 MiB;
  /// about 15 kB are best.
  [[nodiscard]] virtual std::span<const std::byte> base() const = 0;
  /// Returns the number of streams, for example of resolutions, 1 to kMaxStreams. The server sends one after the other.
  [[nodiscard]] virtual std::size_t streams() const = 0;
  /// Reports whether the chunks of a stream are records of 8 bytes. Any subset of the records is useful. Other chunks
  /// are only useful as a whole.
  [[nodiscard]] virtual bool records(std::size_t stream) const = 0;
  /// Returns the number of chunks of a stream, at most kMaxChunks. Index 0 is the most important chunk.
  [[nodiscard]] virtual std::uint32_t chunks(std::size_t stream) const = 0;
  /// Returns the box of a chunk. Returns nullopt if the box is unknown; the chunk then counts as part of every region.
  [[nodiscard]] virtual std::optional<CellBox> box(std::size_t stream, std::uint32_t chunk) const = 0;
  /// Reads a chunk. Returns nullopt if it cannot be read; the server then skips the chunk.
  [[nodiscard]] virtual std::optional<CellChunk> chunk(std::size_t stream, std::uint32_t chunk) = 0;
};

/// Opens the sources of a server.
class CellLibrary : NonCopyable {
 public:
  virtual ~CellLibrary() = default;
  /// Opens a source, or returns a reason for refusal that the client displays. `path` is untrusted text of at most
  /// kMaxPath bytes. Clients that request one path may share a source.
  [[nodiscard]] virtual std::variant<std::shared_ptr<CellSource>, std::string> open(const std::string& path) = 0;
};

}  // namespace gs::net
