#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/voxels.h"
#include "qnv/stream/outline_header.h"
#include "qnv/stream/voxel_lattice.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

// The container of a QNV stream: a header, chunks that stand alone, most important first, and a directory at the
// end. The bytes are defined in FORMAT.md, "Container".

/// That is written where a stream has an origin (Description::origin), and where it has none. Both are read.
constexpr std::uint16_t kVersion = 2, kVersionWithoutOrigin = 1;
/// More than this no header has, and no chunk's payload.
constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 20, kMostChunkBytes = 65535;
constexpr std::size_t kChunkHeaderBytes = 10, kDirectoryEntryBytes = 32;
/// A reader takes no further directory chunk once it has more entries than this, and notes no more problems.
constexpr std::size_t kMostDirectoryEntries = std::size_t{1} << 22, kMostProblems = 100;

/// What the payloads of a stream's chunks are.
enum class Payload : std::uint8_t { records = 0, packed = 1, outlines = 2, displaced = 3, voxels = 4 };
/// What one chunk is.
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
/// Whether a chunk's type is one of these; others are passed over.
[[nodiscard]] constexpr bool is_known(std::uint8_t type) {
  return type <= static_cast<std::uint8_t>(ChunkType::normals) ||
         type == static_cast<std::uint8_t>(ChunkType::directory);
}

struct StreamHeader {
  Description description;
  Payload payload = Payload::packed;
  bool colored = false;         // vectors have their own colours
  bool meshed = false;          // packed: the mesh itself comes behind the octree
  Rgb8 color;                   // else of all
  std::uint64_t vectors = 0;    // at full detail
  std::uint32_t chunks = 0;     // without the directory; 0: not known when the header was written
  std::uint64_t directory = 0;  // its offset from the start of the stream; 0: none
  Cube cube;                    // packed: what the octree divides
  std::vector<Rgb8> palette;    // records of a surface: the colours of C, at most 256
  OutlineHeader outlines;       // only of that payload
  std::vector<std::byte> base;  // displaced: the first stage (displaced/surface.h), as it came
  VoxelLattice lattice;         // only of voxels
  friend bool operator==(const StreamHeader&, const StreamHeader&);
};

/// What the directory says of a chunk.
struct DirectoryEntry {
  std::uint64_t offset = 0;  // of its chunk header
  std::uint32_t bytes = 0;   // with the chunk header
  /// Packed, voxels: of its voxels; displaced: of its vertices; records: layer; outlines: 0, inner polygons: 1.
  std::uint8_t level = 0;
  std::uint32_t parent = 0;  // packed, voxels: the chunk that it refines; 0xffffffff: none
  std::uint32_t vectors = 0;
  Box box;  // rounded outwards to 1/65535 of the stream's box
  friend bool operator==(const DirectoryEntry&, const DirectoryEntry&) = default;
};

/// What is wrong with a stream, and where (byte offset from its start).
struct StreamProblem {
  std::uint64_t offset = 0;
  std::string message;
};

[[nodiscard]] std::vector<std::byte> encode_header(const StreamHeader& header);
/// A chunk with its header; `payload` of at most kMostChunkBytes.
[[nodiscard]] std::vector<std::byte> encode_chunk(ChunkType type, std::span<const std::byte> payload);
/// One or several directory chunks.
[[nodiscard]] std::vector<std::byte> encode_directory(std::span<const DirectoryEntry> entries, const Box& box);
/// The entries of the payload of one directory chunk. Safe for untrusted bytes.
[[nodiscard]] std::vector<DirectoryEntry> decode_directory(std::span<const std::byte> payload, const Box& box);

/// What a chunk says of itself.
struct ChunkHead {
  ChunkType type = ChunkType::records;
  std::size_t bytes = 0;  // with this
};
/// Of the chunk that begins here, however much of it there is; nothing where none does, or its head is not there as a
/// whole. Its checksum is not looked at. Safe for untrusted bytes.
[[nodiscard]] std::optional<ChunkHead> chunk_head(std::span<const std::byte> bytes);

/// Whether bytes begin like a QNV stream (8 bytes tell).
[[nodiscard]] bool is_stream(std::span<const std::byte> bytes);
/// What a stream that begins so says its payload is (12 bytes tell); nothing where it is none, or too little is there.
[[nodiscard]] std::optional<std::uint8_t> payload_number(std::span<const std::byte> bytes);

/// Reads a header that is there as a whole: nothing when more bytes are needed. Safe for untrusted bytes.
[[nodiscard]] std::variant<StreamHeader, StreamProblem> decode_header(std::span<const std::byte> bytes,
                                                                      std::size_t& header_bytes, bool& need_more);

/// Takes a stream piece by piece, however it was cut, and hands out whole chunks. A chunk whose checksum is wrong is
/// left out and reading goes on at the next one; memory is bounded by one chunk. One thread; safe for untrusted bytes.
class StreamReader {
 public:
  using OnChunk = std::function<void(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset)>;
  /// A chunk of outlines or inner polygons whose checksum is wrong, though it is as long as it says: another one or the
  /// stream's end stands behind it. True where something of it could be used, so that reading goes on behind it.
  using OnDamaged = std::function<bool(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset)>;

  /// False once the stream was refused: it does not begin like a QNV stream or its header is damaged.
  bool push(std::span<const std::byte> bytes, const OnChunk& on_chunk, const OnDamaged& on_damaged = {});
  /// The stream ends: says what is missing, and hands out the whole chunks behind a damaged length.
  void finish(const OnChunk& on_chunk, const OnDamaged& on_damaged = {});

  [[nodiscard]] const StreamHeader* header() const { return header_ ? &*header_ : nullptr; }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  [[nodiscard]] bool refused() const { return refused_; }

 private:
  bool read_header();
  bool read_chunk(const OnChunk& on_chunk, const OnDamaged& on_damaged);
  /// What stands behind a chunk of `bytes` that may be damaged: nothing where that has not arrived.
  [[nodiscard]] std::optional<bool> ends_well(std::size_t bytes) const;
  void problem(std::uint64_t offset, std::string message);

  std::optional<StreamHeader> header_;
  std::vector<std::byte> waiting_;
  std::size_t at_ = 0;        // of waiting_: what comes next
  std::uint64_t offset_ = 0;  // of waiting_[0] in the stream
  std::uint64_t wasted_ = 0;  // bytes of chunks that were summed in vain
  bool refused_ = false, lost_ = false, ended_ = false;
  std::vector<StreamProblem> problems_;
};

}  // namespace gs::qnv
