#pragma once

#include "qnv/base/parallel.h"
#include "qnv/encode/encode_surface.h"
#include "qnv/outline/outline_groups.h"
#include "qnv/records/records_payload.h"
#include "qnv/stream/container.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

// Outline groups as a stream: outlines of all groups first, then the polygons that take their place, group after
// group; largest first. Every polygon is a record with a checksum of its own that is understood without any other; a
// damaged one costs itself. The bytes are defined in FORMAT.md, "Outlines payload".

struct OutlineEncodeOptions {
  int position_bits = 16;          // of the lattice along the longest side of the box; 1..30
  int texture_bits = 12;           // steps of texture coordinates are 2^-this of the texture, or coarser; 1..20
  std::size_t max_bytes = 0;       // of the whole stream; 0: no limit
  std::size_t chunk_bytes = 1200;  // of payload, about; a polygon that needs more has a longer chunk
  std::vector<std::pair<std::string, std::string>> metadata{};
  unsigned threads = 0;  // 0: one a core
};

/// Encodes groups with their polygons' looks, one an appearance number that groups name; without any, the default one.
///
/// Positions go to the nearest point of a lattice whose step is a power of two: at most half a step of error an axis,
/// 2^-position_bits of the longest side. Corners that were equal stay equal, in bits. Where all positions lie on a
/// coarser lattice, that one is taken, and nothing is lost. What has no area left on the lattice is left out; a polygon
/// of more corners than a chunk can hold is cut, so that its edges get new corners on the lattice.
///
/// An error where the arrays do not fit each other, a group names an appearance that is not there, the appearances do
/// not fit into a header, nothing is left, the model is too far from the origin for its size, or it was cancelled. The
/// same bytes for any number of threads. Blocking; any thread.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_outlines(const OutlineGroups& groups,
                                                                       std::span<const OutlineAppearance> appearances,
                                                                       const OutlineEncodeOptions& options,
                                                                       Progress* progress = nullptr);

/// Polygons of one appearance that have come, outlines or inner ones.
struct OutlineBatch {
  std::uint32_t appearance = 0;  // in the header's
  bool inner = false;
  std::vector<std::uint32_t> groups;  // of each polygon, below the header's number of them
  /// Outlines, a polygon: how many inner polygons take the place of its group's outline when all of them have come; 0:
  /// it stays, it is the surface. Empty for inner polygons.
  std::vector<std::uint32_t> counts;
  OutlinePolygons polygons;  // all with texture coordinates, or none

  [[nodiscard]] bool stays(std::size_t polygon) const { return !inner && counts[polygon] == 0; }
};

/// Turns an outline stream that arrives piece by piece, or with holes, into polygons. One thread; safe for untrusted
/// bytes: what is impossible is left out. Memory is bounded by what has come since `take`, and by a bit a polygon.
class OutlineDecoder {
 public:
  /// No more polygons than this are handed out, nor more than eight times as many corners.
  explicit OutlineDecoder(std::size_t most_polygons = std::size_t{1} << 23) : most_polygons_(most_polygons) {}

  /// The next bytes of the stream. False once it was refused: it is no stream of outlines, or its header is damaged.
  bool push(std::span<const std::byte> bytes);
  /// A chunk that came by another way (a datagram), after the header. Any order, any subset; what came before is not
  /// handed out again. The bytes `missing` from the payload may come another time, or never: records outside of them
  /// are used, if the chunk's head is whole.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// The stream has ended: reads what waited for more bytes, and says what is missing.
  void finish();

  /// Polygons that have come since this was last called, in the order in which their kinds came.
  [[nodiscard]] std::vector<OutlineBatch> take();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const;
  [[nodiscard]] bool refused() const { return refused_ || reader_.refused(); }
  /// How many have come, each counted once.
  [[nodiscard]] std::size_t outline_polygons() const { return outline_polygons_; }
  [[nodiscard]] std::size_t inner_polygons() const { return inner_polygons_; }
  /// Chunks of which nothing could be used, and records of others, those that never came not among them.
  [[nodiscard]] std::size_t refused_chunks() const { return refused_chunks_; }
  [[nodiscard]] std::size_t refused_records() const { return refused_records_; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

 private:
  bool is_outlines();
  /// False where the head is damaged.
  bool add_polygons(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing);
  OutlineBatch& batch(std::uint32_t appearance, bool inner, bool textured);

  StreamReader reader_;
  std::size_t most_polygons_, corners_ = 0;
  std::size_t outline_polygons_ = 0, inner_polygons_ = 0, refused_chunks_ = 0, refused_records_ = 0;
  bool refused_ = false;
  std::vector<StreamProblem> other_payload_;                         // what is wrong where it is no stream of outlines
  std::unordered_map<std::uint32_t, std::vector<bool>> handed_out_;  // by the chunk's number: which of its records
  std::vector<OutlineBatch> batches_;
  std::map<std::tuple<std::uint32_t, bool, bool>, std::size_t> batch_of_;  // appearance, inner, textured
  std::vector<DirectoryEntry> directory_;
};

}  // namespace gs::qnv
