#pragma once

#include "base/parallel.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/records/record.h"
#include "qnv/container/container.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// Records payload of a QNV stream: chunks of 8-byte records. All records of a chunk belong to one layer and one octree
/// cell. FORMAT.md, "Records payload", defines the bytes. All functions are pure and safe from any thread.
namespace gs::qnv {

inline constexpr std::size_t kRecordsHeaderBytes = 48;  // size of the payload of an ATM cell
inline constexpr unsigned kDeepestRecordsCell = 20;

/// Cell of the octree over a stream's box. At `depth`, there are 2^depth cells per axis; x, y, z select one.
struct RecordsCell {
  std::uint8_t depth = 0;             // 0..20
  std::uint32_t x = 0, y = 0, z = 0;  // below 2^depth
  friend bool operator==(const RecordsCell&, const RecordsCell&) = default;
};

/// Cube that the octree divides. Its lower corner is that of the stream's box; its edge is the longest edge of the box.
class RecordsCube {
 public:
  explicit RecordsCube(const Box& box);
  /// Returns the cell of depth 20 that contains a position. Outside the cube, returns the nearest cell.
  [[nodiscard]] std::array<std::uint32_t, 3> cell_of(const glm::vec3& position) const;
  /// Returns the cell of depth 20 that is nearest to a position among the cells inside `within`.
  [[nodiscard]] std::array<std::uint32_t, 3> cell_of(const glm::vec3& position, const RecordsCell& within) const;

 private:
  std::array<double, 3> lower_{};
  double cells_per_unit_ = 0;
};

/// Header of a records chunk.
struct RecordsHeader {
  std::uint8_t layer = 0;  // 0 is the coarsest layer
  std::uint16_t count = 0;  // number of records; a truncated chunk contains fewer
  RecordsCell cell;  // cell that contains all records of the chunk
  RecordFrame frame;
  float cell_weight = 0;  // total weight of all vectors in the cell, in all layers
  friend bool operator==(const RecordsHeader&, const RecordsHeader&) = default;
};

struct RecordsChunk {
  RecordsHeader header;
  std::vector<std::byte> payload;  // header, then records in progressive order
};

struct RecordsOptions {
  std::uint64_t seed = 1;
  std::size_t vectors = std::numeric_limits<std::size_t>::max();  // maximum number; keeps the first vectors in
                                                                  // progressive order
  std::size_t first_layer = 768;  // vectors in layer 0; each layer makes the total four times as large
  std::size_t most_per_chunk = 1000;  // maximum records per chunk, 16..8000
  std::span<const Rgb8> palette = {};  // surface: 1..256 colours; if empty, all indices are 0
  unsigned threads = 0;
  Progress* progress = nullptr;  // if cancelled, the result is empty
};

/// Splits vectors into chunks, most important first: layer by layer, and within a layer spread over the object. The
/// records of a chunk are in progressive order (order.h). Cells are chosen so that a chunk has at most most_per_chunk
/// records. Children with fewer than a tenth of that share one chunk of the parent cell.
/// `vectors.description.box` must contain all positions. Skips vectors without weight, and those with a position or
/// weight that is not finite or beyond 1e37. The chunks depend only on the vectors and the options, not on the number
/// of threads. Throws only bad_alloc.
[[nodiscard]] std::vector<RecordsChunk> encode_records(const VectorView& vectors, const RecordsOptions& options);

/// Received part of one chunk.
struct RecordsPatch {
  RecordsHeader header;
  std::vector<std::uint16_t> indices;  // index in the chunk of each received record, ascending
  std::vector<glm::vec3> positions;  // one entry per received record, like all arrays below
  std::vector<glm::vec3> normals;
  std::vector<float> weights;
  std::vector<std::uint8_t> colors;  // surface: palette indices; volume: classes
  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

struct RecordsError {
  std::string message;
};

/// Decodes the records that were received completely. The ranges `missing` (in any order), and all bytes after the end
/// of `payload`, are lost. Returns an error if the header is lost or invalid, or if other bytes follow the last record.
/// Safe for untrusted bytes.
[[nodiscard]] std::variant<RecordsPatch, RecordsError> decode_records(std::span<const std::byte> payload,
                                                                      std::span<const ByteRange> missing = {});

}  // namespace gs::qnv
