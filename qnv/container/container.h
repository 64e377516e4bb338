#pragma once

#include "qnv/base/description.h"
#include "qnv/base/voxels.h"
#include "qnv/container/outline_header.h"
#include "qnv/container/voxel_lattice.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

// The container of a QNV stream: a header, independent chunks in order of importance, and a directory. FORMAT.md,
// "Container", defines the bytes.

/// Versions for streams with an origin (Description::origin) and without. Both can be read.
constexpr std::uint16_t kVersion = 2, kVersionWithoutOrigin = 1;
/// Limits of a header and of a chunk's payload.
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20, kMaxChunkBytes = 65535;
constexpr std::size_t kChunkHeaderBytes = 10, kDirectoryEntryBytes = 32;
/// Limits of a reader: further directory chunks are skipped once it has that many entries, and further problems are not
/// recorded.
constexpr std::size_t kMaxDirectoryEntries = std::size_t{1} << 22, kMaxProblems = 100;

/// Encoding of a stream's geometry.
enum class Payload : std::uint8_t { records = 0, packed = 1, outlines = 2, displaced = 3, voxels = 4 };
/// Type of one chunk.
enum class ChunkType : std::uint8_t {
  records = 0,
  packed = 1,
  outlines = 2,
  inner = 3,
  displaced = 4,
  voxels = 5,
  exact = 6,
  piece = 7,
  shading = 8,
  splits = 9,
  low_bits = 10,
  cover = 11,
  picture = 12,
  normals = 13,
  directory = 254
};
/// Reports whether a chunk type is known; readers skip others.
[[nodiscard]] constexpr bool is_known(std::uint8_t type) {
  return type <= static_cast<std::uint8_t>(ChunkType::normals) ||
         type == static_cast<std::uint8_t>(ChunkType::directory);
}

struct StreamHeader {
  Description description;
  Kind kind = Kind::surface;
  Payload payload = Payload::packed;
  bool colored = false;         // each vector has its own colour
  bool meshed = false;          // packed: the exact mesh follows the octree
  Rgb8 color;                   // of all vectors otherwise
  std::uint64_t vectors = 0;    // at full detail
  std::uint32_t chunks = 0;     // without the directory; 0 if unknown when the header was written
  std::uint64_t directory = 0;  // offset in the stream; 0 means none
  Cube cube;                    // packed: divided by the octree
  std::vector<Rgb8> palette;    // records of a surface: colours of C, at most 256
  OutlineHeader outlines;       // outlines only
  std::vector<std::byte> base;  // displaced: the first stage (displaced/surface.h), as received
  VoxelLattice lattice;         // voxels only
  friend bool operator==(const StreamHeader&, const StreamHeader&);
};

/// Directory entry of a chunk.
struct DirectoryEntry {
  std::uint64_t offset = 0;  // of the chunk header
  std::uint32_t bytes = 0;   // including the chunk header
  /// packed, voxels: level of the voxels; displaced: level of the vertices; records: layer; outlines: 0; inner
  /// polygons: 1
  std::uint8_t level = 0;
  std::uint32_t parent = 0;  // packed, voxels: the chunk that it refines; 0xffffffff means none
  std::uint32_t vectors = 0;
  Box box;  // rounded outwards to 1/65535 of the stream's box
  friend bool operator==(const DirectoryEntry&, const DirectoryEntry&) = default;
};

/// Problem in a stream, with its byte offset from the start.
struct StreamProblem {
  std::uint64_t offset = 0;
  std::string message;
};

[[nodiscard]] std::vector<std::byte> encode_header(const StreamHeader& header);
/// Returns a chunk with its header. `payload` has at most kMaxChunkBytes bytes.
[[nodiscard]] std::vector<std::byte> encode_chunk(ChunkType type, std::span<const std::byte> payload);
/// Returns one or more directory chunks.
[[nodiscard]] std::vector<std::byte> encode_directory(std::span<const DirectoryEntry> entries, const Box& box);
/// Returns the entries of one directory chunk's payload. Safe for untrusted bytes.
[[nodiscard]] std::vector<DirectoryEntry> decode_directory(std::span<const std::byte> payload, const Box& box);

/// Bytes first to last - 1.
struct ByteRange {
  std::size_t first, last;
};

/// Type and length of a chunk.
struct ChunkHead {
  ChunkType type = ChunkType::records;
  std::size_t bytes = 0;  // including the chunk header
};
/// Reads the header of the chunk at the start of `bytes`, which may be incomplete. Returns nullopt if no chunk starts
/// there or its header is truncated. Does not verify the checksum. Safe for untrusted bytes.
[[nodiscard]] std::optional<ChunkHead> chunk_head(std::span<const std::byte> bytes);

/// Reports whether bytes start like a QNV stream; 8 bytes suffice.
[[nodiscard]] bool is_stream(std::span<const std::byte> bytes);
/// Returns the payload number of a stream from its first bytes; 12 suffice. Returns nullopt for other data or fewer
/// bytes.
[[nodiscard]] std::optional<std::uint8_t> payload_number(std::span<const std::byte> bytes);

/// Reads a complete header. If the header is incomplete, sets `need_more`. Safe for untrusted bytes.
[[nodiscard]] std::variant<StreamHeader, StreamProblem> decode_header(std::span<const std::byte> bytes,
                                                                      std::size_t& header_bytes, bool& need_more);

/// Splits a stream, received in pieces of any size, into whole chunks. Skips chunks with a wrong checksum, and resumes
/// at the next chunk. Memory is bounded by one chunk. Not thread-safe; safe for untrusted bytes.
class StreamReader {
 public:
  using OnChunk = std::function<void(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset)>;
  /// Callback for a chunk of outlines or inner polygons with a wrong checksum but a plausible length: another chunk or
  /// the end of the stream follows it. Returns true if part of it was usable; reading then resumes after it.
  using OnDamaged = std::function<bool(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset)>;

  /// Processes the next bytes. Returns false once the stream is rejected: its start is not a QNV stream's, or its
  /// header is damaged.
  bool push(std::span<const std::byte> bytes, const OnChunk& on_chunk, const OnDamaged& on_damaged = {});
  /// Ends the stream: reports missing parts, and delivers whole chunks that follow a damaged length.
  void finish(const OnChunk& on_chunk, const OnDamaged& on_damaged = {});

  [[nodiscard]] const StreamHeader* header() const { return header_ ? &*header_ : nullptr; }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  [[nodiscard]] bool refused() const { return refused_; }

 private:
  bool read_header();
  bool read_chunk(const OnChunk& on_chunk, const OnDamaged& on_damaged);
  /// Reports whether a sound chunk or the stream's end follows a possibly damaged chunk of `bytes` bytes. Returns
  /// nullopt until enough bytes are received.
  [[nodiscard]] std::optional<bool> ends_well(std::size_t bytes) const;
  void problem(std::uint64_t offset, std::string message);

  std::optional<StreamHeader> header_;
  std::vector<std::byte> waiting_;
  std::size_t at_ = 0;        // next byte to read in waiting_
  std::uint64_t offset_ = 0;  // of waiting_[0] in the stream
  std::uint64_t wasted_ = 0;  // bytes of chunks with a wrong checksum, checked so far
  bool refused_ = false, lost_ = false, ended_ = false;
  std::vector<StreamProblem> problems_;
};

}  // namespace gs::qnv
