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

// Streams of outline groups: first the outlines of all groups, then the polygons that replace them, group by group,
// largest group first. Every polygon is a record with its own checksum and decodes alone, so that damage costs one
// record. FORMAT.md, "Outlines payload", defines the bytes.

struct OutlineEncodeOptions {
  int position_bits = 16;  // bits of the lattice along the longest side of the box; 1..30
  int texture_bits = 12;  // texture coordinates have steps of 2^-texture_bits or coarser; 1..20
  std::size_t max_bytes = 0;  // maximum size of the stream; 0 means unlimited
  std::size_t chunk_bytes = 1200;  // approximate size of a chunk's payload; a larger polygon has a longer chunk
  std::vector<std::pair<std::string, std::string>> metadata{};
  unsigned threads = 0;  // 0 means one per core
};

/// Encodes groups with `appearances`, which the groups refer to by index. If empty, uses a default appearance.
/// Rounds positions to a lattice with a power-of-two step, 2^-position_bits of the longest side. The error is at most
/// half a step per axis. Equal corners stay bitwise equal. If all positions are on a coarser lattice, uses that lattice
/// without loss. Drops polygons without area on the lattice. Cuts a polygon with more corners than a chunk can hold;
/// the cut adds corners on the lattice.
/// Returns an error for mismatched arrays, for unknown appearances, or if the appearances do not fit into a header.
/// Also returns an error if no polygon is left, if the model is too far from the origin for its size, or if cancelled.
/// The bytes do not depend on the number of threads. Blocks. Any thread.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_outlines(const OutlineGroups& groups,
                                                                       std::span<const OutlineAppearance> appearances,
                                                                       const OutlineEncodeOptions& options,
                                                                       Progress* progress = nullptr);

/// Received polygons of one appearance: either outlines or inner polygons.
struct OutlineBatch {
  std::uint32_t appearance = 0;  // index in the header's list of appearances
  bool inner = false;
  std::vector<std::uint32_t> groups;  // group of each polygon; less than the header's number of groups
  /// For each outline, the number of inner polygons of its group. They replace the outline when all are received. 0
  /// means that the outline is exact and stays. Empty in batches of inner polygons.
  std::vector<std::uint32_t> counts;
  OutlinePolygons polygons;  // either all polygons have texture coordinates, or none

  [[nodiscard]] bool stays(std::size_t polygon) const { return !inner && counts[polygon] == 0; }
};

/// Decoder of an outline stream. The stream may be received in pieces or with losses. One thread at a time. Safe for
/// untrusted bytes: skips invalid parts. Memory is bounded by the data received since the last take(), plus one bit per
/// polygon.
class OutlineDecoder {
 public:
  /// `most_polygons` limits the number of returned polygons. Eight times as many corners are allowed.
  explicit OutlineDecoder(std::size_t most_polygons = std::size_t{1} << 23) : most_polygons_(most_polygons) {}

  /// Decodes the next bytes of the stream. Returns false if the stream is rejected: it is not an outline stream, or its
  /// header is damaged.
  bool push(std::span<const std::byte> bytes);
  /// Adds a chunk that was received separately, for example as a datagram. Call it after the header is received; chunks
  /// may have any order. Skips records that were received before. `missing` are the ranges of the payload that are not
  /// received yet; a later call may add them. Uses the other records if the chunk's head is complete.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// Ends the stream. Decodes the remaining bytes, and reports missing bytes as problems.
  void finish();

  /// Returns the polygons received since the last call, in batches. Batches are in the order in which their kinds first
  /// appeared.
  [[nodiscard]] std::vector<OutlineBatch> take();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const;
  [[nodiscard]] bool refused() const { return refused_ || reader_.refused(); }
  /// Returns the number of received outlines. Repetitions do not count.
  [[nodiscard]] std::size_t outline_polygons() const { return outline_polygons_; }
  [[nodiscard]] std::size_t inner_polygons() const { return inner_polygons_; }
  /// Returns the number of unusable chunks. refused_records() counts unusable records in usable chunks, except lost
  /// records.
  [[nodiscard]] std::size_t refused_chunks() const { return refused_chunks_; }
  [[nodiscard]] std::size_t refused_records() const { return refused_records_; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

 private:
  bool is_outlines();
  /// Adds the polygons of a chunk. Returns false if its head is damaged.
  bool add_polygons(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing);
  OutlineBatch& batch(std::uint32_t appearance, bool inner, bool textured);

  StreamReader reader_;
  std::size_t most_polygons_, corners_ = 0;
  std::size_t outline_polygons_ = 0, inner_polygons_ = 0, refused_chunks_ = 0, refused_records_ = 0;
  bool refused_ = false;
  std::vector<StreamProblem> other_payload_;  // problems of streams without outlines
  std::unordered_map<std::uint32_t, std::vector<bool>> handed_out_;  // flags of the received records, by chunk number
  std::vector<OutlineBatch> batches_;
  std::map<std::tuple<std::uint32_t, bool, bool>, std::size_t> batch_of_;  // key: appearance, inner, textured
  std::vector<DirectoryEntry> directory_;
};

}  // namespace gs::qnv
