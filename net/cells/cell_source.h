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

/// A box in 1/65535 of the source's own box: lower corner, upper corner.
using CellBox = std::array<std::uint16_t, 6>;

/// A part of a source that stands alone.
struct CellChunk {
  /// Of records only: what a reader must know before the records, at most
  /// kMostChunkHead bytes. Goes along with every datagram, so that each can be
  /// used without the others.
  std::vector<std::byte> head;
  /// At most kMostChunkBody bytes, not empty. Of records: whole ones of 8
  /// bytes.
  std::vector<std::byte> body;
};
constexpr std::size_t kMostChunkHead = 64, kMostChunkBody = std::size_t{1} << 20;
constexpr std::size_t kMostStreams = 16, kMostChunks = std::size_t{1} << 20;

/// What a server of cells sends: a base that must arrive, and streams of chunks
/// of which any part may be lost. Implemented by the owner over files. The
/// server calls it from its one thread; calls may read a disc.
class CellSource {
 public:
  CellSource() = default;
  CellSource(const CellSource&) = delete;
  CellSource& operator=(const CellSource&) = delete;
  virtual ~CellSource() = default;

  /// Tells versions of the content apart.
  [[nodiscard]] virtual std::uint32_t version() const = 0;
  /// Sent protected, before all: headers, the first chunks. 1 to 4 MiB; some 15
  /// kB are best.
  [[nodiscard]] virtual std::span<const std::byte> base() const = 0;
  /// 1 to kMostStreams, such as resolutions; sent one after the other.
  [[nodiscard]] virtual std::size_t streams() const = 0;
  /// Whether a stream's chunks are records of 8 bytes, of which any subset is
  /// of use; else only whole chunks are.
  [[nodiscard]] virtual bool records(std::size_t stream) const = 0;
  /// The chunks of a stream, most important first: at most kMostChunks.
  [[nodiscard]] virtual std::uint32_t chunks(std::size_t stream) const = 0;
  /// Where a chunk is; nothing if that is not known: then it meets every
  /// region.
  [[nodiscard]] virtual std::optional<CellBox> box(std::size_t stream, std::uint32_t chunk) const = 0;
  /// Nothing when it cannot be read: then it is left out.
  [[nodiscard]] virtual std::optional<CellChunk> chunk(std::size_t stream, std::uint32_t chunk) = 0;
};

/// Where a server finds sources.
class CellLibrary {
 public:
  CellLibrary() = default;
  CellLibrary(const CellLibrary&) = delete;
  CellLibrary& operator=(const CellLibrary&) = delete;
  virtual ~CellLibrary() = default;
  /// `path` is from outside: any text of at most kMostPath bytes. Clients of
  /// the same path may share one source. The text of a refusal is shown to the
  /// client.
  [[nodiscard]] virtual std::variant<std::shared_ptr<CellSource>, std::string> open(const std::string& path) = 0;
};

}  // namespace gs::net
