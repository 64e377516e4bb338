#pragma once

#include "base/parallel.h"
#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/codecs/records/records_payload.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/container/container.h"

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

// Outline groups as a stream: first the outlines of all groups, then the polygons that replace them, group after group,
// largest first. Every polygon is a record with its own checksum and decodes alone, so damage costs one record.
// FORMAT.md, "Outlines payload", defines the bytes.

struct OutlineEncodeOptions {
  int position_bits = 16;          // of the lattice along the longest side of the box; 1..30
  int texture_bits = 12;           // steps of texture coordinates are 2^-this of the texture, or coarser; 1..20
  std::size_t max_bytes = 0;       // of the whole stream; 0 means unlimited
  std::size_t chunk_bytes = 1200;  // approximate payload; larger polygons have longer chunks
  std::vector<std::pair<std::string, std::string>> metadata{};
  unsigned threads = 0;  // 0: one per core
};

/// Encodes groups with `appearances`, which the groups index; if empty, a default appearance is used.
/// Positions are rounded to a lattice with a power-of-two step: the error is at most half a step per axis,
/// 2^-position_bits of the longest side. Equal corners stay bitwise equal. If all positions lie on a coarser lattice,
/// that one is used without loss. Polygons without area on the lattice are dropped. A polygon with more corners than a
/// chunk can hold is cut, which adds corners on the lattice. Returns an error for mismatched arrays, unknown
/// appearances, or appearances that exceed a header. Returns an error too if no polygon is left, the model is too far
/// from the origin for its size, or if cancelled. The bytes do not depend on the number of threads. Blocks; safe from
/// any thread.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_outlines(const OutlineGroups& groups,
                                                                       std::span<const OutlineAppearance> appearances,
                                                                       const OutlineEncodeOptions& options,
                                                                       Progress* progress = nullptr);

/// Received polygons of one appearance, either outlines or inner ones.
struct OutlineBatch {
  std::uint32_t appearance = 0;  // index in the header
  bool inner = false;
  std::vector<std::uint32_t> groups;  // group of each polygon, below the header's number of groups
  /// For each outline polygon, the number of inner polygons that replace its group's outline when all are received; 0:
  /// it stays, since it is exact. Empty for inner polygons.
  std::vector<std::uint32_t> counts;
  OutlinePolygons polygons;  // all with texture coordinates, or none

  [[nodiscard]] bool stays(std::size_t polygon) const { return !inner && counts[polygon] == 0; }
};

/// Decodes an outline stream, received in pieces or with losses, into polygons. Not thread-safe. Safe for untrusted
/// bytes: invalid parts are skipped. Memory is bounded by the data received since the last take(), plus one bit per
/// polygon.
class OutlineDecoder {
 public:
  /// Limits the polygons returned to `most_polygons`, and their corners to eight times as many.
  explicit OutlineDecoder(std::size_t most_polygons = std::size_t{1} << 23) : most_polygons_(most_polygons) {}

  /// Decodes the next bytes of the stream. Returns false once the stream is rejected: it is not an outline stream, or
  /// its header is damaged.
  bool push(std::span<const std::byte> bytes);
  /// Adds a chunk received separately (as a datagram), after the header, in any order. Skips records received before.
  /// The bytes `missing` in the payload may be added later or never; if the chunk's head is complete, the other records
  /// are used.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// Ends the stream: decodes waiting bytes, and reports missing ones.
  void finish();

  /// Returns the polygons received since the last call, in the order in which their kinds first appeared.
  [[nodiscard]] std::vector<OutlineBatch> take();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const;
  [[nodiscard]] bool refused() const { return refused_ || reader_.refused(); }
  /// Returns the number of outlines received, each counted once.
  [[nodiscard]] std::size_t outline_polygons() const { return outline_polygons_; }
  [[nodiscard]] std::size_t inner_polygons() const { return inner_polygons_; }
  /// Returns the number of unusable chunks. refused_records() counts unusable records in other chunks, without lost
  /// ones.
  [[nodiscard]] std::size_t refused_chunks() const { return refused_chunks_; }
  [[nodiscard]] std::size_t refused_records() const { return refused_records_; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

 private:
  bool is_outlines();
  /// Returns false if the head is damaged.
  bool add_polygons(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing);
  OutlineBatch& batch(std::uint32_t appearance, bool inner, bool textured);

  StreamReader reader_;
  std::size_t most_polygons_, corners_ = 0;
  std::size_t outline_polygons_ = 0, inner_polygons_ = 0, refused_chunks_ = 0, refused_records_ = 0;
  bool refused_ = false;
  std::vector<StreamProblem> other_payload_;                         // problems, if the stream is not of outlines
  std::unordered_map<std::uint32_t, std::vector<bool>> handed_out_;  // received records, by chunk number
  std::vector<OutlineBatch> batches_;
  std::map<std::tuple<std::uint32_t, bool, bool>, std::size_t> batch_of_;  // appearance, inner, textured
  std::vector<DirectoryEntry> directory_;
};

}  // namespace gs::qnv
