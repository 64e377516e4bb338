#pragma once

#include "qnv/base/description.h"
#include "qnv/base/voxels.h"
#include "qnv/container/gaussian_coding.h"
#include "qnv/container/outline_header.h"
#include "qnv/container/step_table.h"
#include "qnv/container/value_grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv {

// Container of a QNV stream: a header, independent chunks in order of importance, and a directory. FORMAT.md,
// "Container", defines the bytes.

/// Version of streams with an origin (Description::origin), and version of streams without. Readers accept both.
constexpr std::uint16_t kVersion = 2, kVersionWithoutOrigin = 1;
/// Maximum size of a header, and of the payload of a chunk.
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20, kMaxChunkBytes = 65535;
constexpr std::size_t kChunkHeaderBytes = 10, kDirectoryEntryBytes = 32;
/// Limits of a reader. After kMaxDirectoryEntries entries, the reader skips further directory chunks. After
/// kMaxProblems problems, it does not record further ones.
constexpr std::size_t kMaxDirectoryEntries = std::size_t{1} << 22, kMaxProblems = 100;

/// Encoding of a stream's geometry.
enum class Payload : std::uint8_t { records = 0, packed = 1, outlines = 2, displaced = 3, values = 5, gaussians = 6 };
/// Type of a chunk.
enum class ChunkType : std::uint8_t {
  records = 0,
  packed = 1,
  outlines = 2,
  inner = 3,
  displaced = 4,
  exact = 6,
  piece = 7,
  shading = 8,
  splits = 9,
  low_bits = 10,
  cover = 11,
  picture = 12,
  normals = 13,
  values = 14,
  gaps = 15,
  remainders = 16,
  parity = 17,
  places = 18,
  labels = 19,
  gaussians = 20,
  harmonics = 21,
  coarse_harmonics = 22,
  cluster_directory = 23,
  directory = 254
};
/// Reports whether chunks of a type list other chunks of the stream.
[[nodiscard]] constexpr bool is_listing(ChunkType type) {
  return type == ChunkType::directory || type == ChunkType::places || type == ChunkType::cluster_directory;
}
/// Reports whether chunks of a type have harmonics of Gaussians.
[[nodiscard]] constexpr bool is_harmonics(ChunkType type) {
  return type == ChunkType::harmonics || type == ChunkType::coarse_harmonics;
}
/// Reports whether this version has a chunk type. Readers skip other chunks.
[[nodiscard]] constexpr bool is_known(std::uint8_t type) {
  constexpr std::uint8_t kReserved = 5;
  return (type <= static_cast<std::uint8_t>(ChunkType::cluster_directory) && type != kReserved) ||
         type == static_cast<std::uint8_t>(ChunkType::directory);
}

struct StreamHeader {
  Description description;
  Kind kind = Kind::surface;
  Payload payload = Payload::packed;
  bool colored = false;               // each vector has its own colour
  bool meshed = false;                // packed: the exact mesh follows the octree
  bool parity = false;                // the stream has chunks of parity (lost_chunks.h)
  Rgb8 color;                         // colour of all vectors if not `colored`
  std::uint64_t vectors = 0;          // number at full detail
  std::uint32_t chunks = 0;           // number without directory and parity; 0 if unknown when the header was written
  std::uint64_t directory = 0;        // byte offset in the stream; 0 means none
  Cube cube;                          // packed: cube that the octree divides
  std::vector<Rgb8> palette;          // records of a surface: colour of each index C; at most 256
  OutlineHeader outlines;             // outlines only
  std::vector<std::byte> base;        // displaced: encoded first stage (displaced/surface.h)
  ValueGrid grid;                     // values only; of the first component
  std::vector<ValueGrid> more_grids;  // of the other components
  StepTable steps;                    // values only; of a time series
  GaussianCoding gaussians;           // gaussians only
};

/// Directory entry of a chunk.
struct DirectoryEntry {
  std::uint64_t offset = 0;  // byte offset of the chunk header
  std::uint32_t bytes = 0;   // including the chunk header
  /// packed: level of the voxels; gaussians: level of the cluster; values: levels above the volume; displaced: level of
  /// the vertices; records: layer; outlines: 0; inner polygons: 1
  std::uint8_t level = 0;
  std::uint32_t parent = 0;  // packed: index of the chunk that it refines; 0xffffffff means none
  std::uint32_t vectors = 0;
  Box box;  // bounds, rounded outwards to 1/65535 of the stream's box
  friend bool operator==(const DirectoryEntry&, const DirectoryEntry&) = default;
};

/// Problem in a stream, with its byte offset from the start.
struct StreamProblem {
  std::uint64_t offset = 0;
  std::string message;
};

[[nodiscard]] std::vector<std::byte> encode_header(const StreamHeader& header);
/// Encodes a chunk with its header. `payload` has at most kMaxChunkBytes bytes.
[[nodiscard]] std::vector<std::byte> encode_chunk(ChunkType type, std::span<const std::byte> payload);
/// Returns the CRC-32 in the header of a chunk.
[[nodiscard]] std::uint32_t chunk_checksum(ChunkType type, std::span<const std::byte> payload);
/// Encodes the directory as one or more chunks.
[[nodiscard]] std::vector<std::byte> encode_directory(std::span<const DirectoryEntry> entries, const Box& box);
/// Decodes the entries in the payload of one directory chunk. Safe for untrusted bytes.
[[nodiscard]] std::vector<DirectoryEntry> decode_directory(std::span<const std::byte> payload, const Box& box);

/// Corners of a box in 1/65535 of the stream's box, from its lower corner: lower x, y, z, upper x, y, z.
using BoxCodes = std::array<std::uint16_t, 6>;
/// Rounds a box outwards. `whole` is the box of the stream.
[[nodiscard]] BoxCodes box_codes(const Box& box, const Box& whole);
[[nodiscard]] Box box_of(const BoxCodes& codes, const Box& whole);

/// Range of bytes from `first` up to `last`, which is excluded.
struct ByteRange {
  std::size_t first, last;
};

/// Type and length of a chunk.
struct ChunkHead {
  ChunkType type = ChunkType::records;
  std::size_t bytes = 0;  // including the chunk header
};
/// Reads the header of the chunk at the start of `bytes`; the chunk may be incomplete. Returns nullopt if no chunk
/// starts there or its header is truncated. Does not verify the checksum. Safe for untrusted bytes.
[[nodiscard]] std::optional<ChunkHead> chunk_head(std::span<const std::byte> bytes);

/// Reports whether bytes start like a QNV stream. Needs 8 bytes.
[[nodiscard]] bool is_stream(std::span<const std::byte> bytes);
/// Returns the payload number of a stream from its first 12 bytes. Returns nullopt for other data, or if there are
/// fewer bytes.
[[nodiscard]] std::optional<std::uint8_t> payload_number(std::span<const std::byte> bytes);

/// Decodes a header. If it is incomplete, returns a problem and sets `need_more`. Safe for untrusted bytes.
[[nodiscard]] std::variant<StreamHeader, StreamProblem> decode_header(std::span<const std::byte> bytes,
                                                                      std::size_t& header_bytes, bool& need_more);

/// Reader that splits a stream into whole chunks. The stream may be received in pieces of any size. Skips a chunk with
/// a wrong checksum, and continues at the next chunk. Memory is bounded by one chunk. One thread at a time. Safe for
/// untrusted bytes.
class StreamReader {
 public:
  using OnChunk = std::function<void(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset)>;
  /// Callback for a damaged chunk of outlines or inner polygons. Its checksum is wrong but its length is plausible:
  /// another chunk or the end of the stream follows. Returns true if part of the chunk was usable; reading then
  /// continues after it.
  using OnDamaged = std::function<bool(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset)>;

  /// Processes the next bytes. Returns false if the stream is rejected: it does not start like a QNV stream, or its
  /// header is damaged.
  bool push(std::span<const std::byte> bytes, const OnChunk& on_chunk, const OnDamaged& on_damaged = {});
  /// Ends the stream. Reports missing parts as problems, and passes on whole chunks that follow a damaged length.
  void finish(const OnChunk& on_chunk, const OnDamaged& on_damaged = {});

  [[nodiscard]] const StreamHeader* header() const { return header_ ? &*header_ : nullptr; }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  [[nodiscard]] bool refused() const { return refused_; }

 private:
  bool read_header();
  bool read_chunk(const OnChunk& on_chunk, const OnDamaged& on_damaged);
  /// Reports whether an intact chunk or the end of the stream follows after `bytes` bytes of a possibly damaged chunk.
  /// Returns nullopt if that is undecided until more bytes are received.
  [[nodiscard]] std::optional<bool> ends_well(std::size_t bytes) const;
  void problem(std::uint64_t offset, std::string message);

  std::optional<StreamHeader> header_;
  std::vector<std::byte> waiting_;
  std::size_t at_ = 0;        // index in waiting_ of the next byte to read
  std::uint64_t offset_ = 0;  // offset in the stream of waiting_[0]
  std::uint64_t wasted_ = 0;  // number of bytes checked in chunks with a wrong checksum
  bool refused_ = false, lost_ = false, ended_ = false;
  std::vector<StreamProblem> problems_;
};

}  // namespace gs::qnv
