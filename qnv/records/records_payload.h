#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/parallel.h"
#include "qnv/records/record.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// The `records` payload of a QNV stream: chunks of 8-byte records, each of one layer and one cell of an octree. The
/// bytes are defined in FORMAT.md, "Records payload". Pure; may be called from any thread.
namespace gs::qnv {

inline constexpr std::size_t kRecordsHeaderBytes = 48;  // as much as an ATM cell carries
inline constexpr unsigned kDeepestRecordsCell = 20;

/// A cell of the octree over a stream's box: of 2^depth cells an axis, the one at x, y, z.
struct RecordsCell {
  std::uint8_t depth = 0;             // 0..20
  std::uint32_t x = 0, y = 0, z = 0;  // below 2^depth
  friend bool operator==(const RecordsCell&, const RecordsCell&) = default;
};

/// The cube that the octree divides: from the lower corner of the stream's box, with its longest edge.
class RecordsCube {
 public:
  explicit RecordsCube(const Box& box);
  /// The cell of depth 20 that a position lies in, or the nearest to it.
  [[nodiscard]] std::array<std::uint32_t, 3> cell_of(const glm::vec3& position) const;
  /// The same, of those that lie in `within`.
  [[nodiscard]] std::array<std::uint32_t, 3> cell_of(const glm::vec3& position, const RecordsCell& within) const;

 private:
  std::array<double, 3> lower_{};
  double cells_per_unit_ = 0;
};

/// What a chunk says before its records.
struct RecordsHeader {
  std::uint8_t layer = 0;   // 0: the coarsest
  std::uint16_t count = 0;  // records, of which a truncated chunk has fewer
  RecordsCell cell;         // that all of them lie in
  RecordFrame frame;
  float cell_weight = 0;  // integrated weight of all vectors in the cell, those of every layer
  friend bool operator==(const RecordsHeader&, const RecordsHeader&) = default;
};

struct RecordsChunk {
  RecordsHeader header;
  std::vector<std::byte> payload;  // the header's bytes, then the records, in progressive order
};

struct RecordsOptions {
  std::uint64_t seed = 1;
  std::size_t vectors = std::numeric_limits<std::size_t>::max();  // so many at most: the first ones
  std::size_t first_layer = 768;       // vectors of layer 0; each layer makes it four times as many
  std::size_t most_per_chunk = 1000;   // 16..8000
  std::span<const Rgb8> palette = {};  // of a surface, 1..256 colours; empty: every index is 0
  unsigned threads = 0;
  Progress* progress = nullptr;  // watched for `cancelled`: then the result is empty
};

/// Cuts a cloud into chunks, the most important first: layer by layer, and spread over the object within a layer. A
/// chunk's records are in progressive order (order.h). Its cell is chosen so that it has up to most_per_chunk; what
/// is left of a cell's children with fewer than a tenth of that goes into one chunk of the cell itself.
///
/// `cloud.description.box` must hold all positions. Vectors with a position, or a weight, that is not finite or beyond
/// 1e37, and those without weight, are left out. The chunks depend only on the cloud and the options, not on the
/// number of threads. Throws only bad_alloc.
[[nodiscard]] std::vector<RecordsChunk> encode_records(const Cloud& cloud, const RecordsOptions& options);

/// What arrived of one chunk.
struct RecordsPatch {
  RecordsHeader header;
  std::vector<std::uint16_t> indices;  // which of its records, rising
  std::vector<glm::vec3> positions;    // one entry each from here on
  std::vector<glm::vec3> normals;
  std::vector<float> weights;
  std::vector<std::uint8_t> colors;  // indices of the palette; of a volume, classes
  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

struct RecordsError {
  std::string message;
};

/// Bytes first..last-1.
struct ByteRange {
  std::size_t first, last;
};

/// Decodes a chunk of which the bytes in `missing` (in any order) and those behind the end of `payload` have not
/// arrived: the records that are there as a whole. An error when the header is not there or is impossible, or when
/// there are bytes behind the last record. Safe for untrusted bytes.
[[nodiscard]] std::variant<RecordsPatch, RecordsError> decode_records(std::span<const std::byte> payload,
                                                                      std::span<const ByteRange> missing = {});

}  // namespace gs::qnv
