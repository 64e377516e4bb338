#pragma once

#include "qnv/codecs/octree/lod/lod_cache.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/octree/lod/lod_tree.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/shared/lod_view.h"
#include "qnv/container/container.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Run of splats that share arrays.
struct Piece {
  std::shared_ptr<const Splats> splats;
  std::size_t first = 0, count = 0;
  std::uint8_t level = 0;   // in the octree
  std::uint32_t chunk = 0;  // unique number
  float age = 0;            // 0: received first; 1: received last
};

/// Position of a chunk in its stream.
struct ChunkRange {
  std::uint64_t offset = 0, bytes = 0;
  friend bool operator==(const ChunkRange&, const ChunkRange&) = default;
};

/// Memory limits of a stream.
struct LodLimits {
  std::size_t cache_bytes = std::size_t{1} << 29;    // decoded data, besides the last cuts
  std::size_t discs = std::size_t{1} << 26;          // of one cut or of a full copy, for any budget
  std::size_t arrived_bytes = std::size_t{1} << 30;  // received chunks of a growing stream
};

/// Packed stream from which each view decodes what it needs: coarse clusters everywhere, finer ones in view, largest on
/// the screen first. The stream is in memory, in a file, or still growing. Not thread-safe. Safe for untrusted bytes:
/// invalid clusters are skipped with their descendants, and the coarser picture remains.
class LodStream {
 public:
  /// Default memory for decoded data besides the last cuts.
  static constexpr std::size_t kCacheBytes = LodLimits{}.cache_bytes;
  using Opened = std::variant<std::unique_ptr<LodStream>, StreamProblem>;

  /// Opens a stream in memory; reads and checks all of it now. Returns an error if that fails.
  [[nodiscard]] static Opened open(std::vector<std::byte> bytes, std::size_t cache_bytes = kCacheBytes);
  /// Opens a stream in another place: reads the header and the directory now, and chunks when a view needs them. If the
  /// directory is incomplete or wrong, reads the whole stream once.
  [[nodiscard]] static Opened open(std::shared_ptr<const ChunkSource> source, std::size_t cache_bytes = kCacheBytes);
  /// Opens a growing stream from its first bytes, which include the header.
  [[nodiscard]] static Opened begin(std::span<const std::byte> front, std::size_t cache_bytes = kCacheBytes);

  /// Sets the limits. Call before the first cut.
  void set_limits(const LodLimits& limits);

  /// Adds bytes to a growing stream, after those given to begin() and the last push(). Returns false once more bytes
  /// are useless.
  bool push(std::span<const std::byte> bytes);
  /// Ends the calls of push().
  void finish();
  /// Sets the directory from all its chunks, concatenated; wanted() needs it. Returns false if they are incomplete.
  bool set_directory(std::span<const std::byte> chunks);
  /// Adds a whole chunk at an offset of the stream, in any order. Returns false if it is rejected; problems() has the
  /// reason.
  bool add(std::uint64_t offset, std::span<const std::byte> chunk);

  /// Returns the pieces to draw. They cover everything in view exactly once. Skips clusters entirely outside the view.
  /// For the same view and bytes, detail never decreases between calls.
  [[nodiscard]] std::vector<Piece> cut(const LodView& view);
  /// Reports whether the last cut lacks received parts that are not decoded yet. The next cut is better.
  [[nodiscard]] bool pending() const { return pending_; }
  /// Returns the chunks that the last cut lacks, most wanted first.
  [[nodiscard]] const std::vector<ChunkRange>& wanted() const { return wanted_; }
  /// Returns the chunks that the last cuts of all viewports lack, in turn and without duplicates.
  [[nodiscard]] std::vector<ChunkRange> wanted_by_all() const;
  /// Returns the last views of the viewports.
  [[nodiscard]] std::vector<LodView> views() const;
  /// Reports whether the last cut has everything that the view requested.
  [[nodiscard]] bool complete() const { return !pending_ && wanted_.empty(); }
  /// Removes a viewport that will make no more cuts.
  void forget(std::uint32_t viewport);

  /// Returns all vectors at full detail, up to the limit of a cut.
  [[nodiscard]] Splats whole();
  /// Reports whether whole() left parts coarse because of the limit.
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  /// Returns the number of vectors at full detail. Decodes the whole stream.
  [[nodiscard]] std::size_t count();

  [[nodiscard]] const StreamHeader& header() const { return header_; }
  /// Returns the problems of the bytes read so far; valid parts remain usable.
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  /// Returns the number of clusters received.
  [[nodiscard]] std::size_t clusters() const { return tree_.present(); }
  /// Returns a number that changes with every received chunk.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  [[nodiscard]] std::size_t cached_discs() const { return cache_.disc_count(); }
  [[nodiscard]] std::size_t cached_bytes() const { return cache_.bytes(); }
  /// Returns the approximate number of splats decoded for the last cut.
  [[nodiscard]] std::size_t decoded() const { return decoded_; }

 private:
  /// Last cut of one viewport.
  struct Viewport {
    LodView view;
    std::uint64_t last_cut = 0;  // 0 means none
    std::uint64_t revision = 0;
    std::vector<std::uint32_t> chosen, shown;
    std::vector<std::uint32_t> lacking;  // missing nodes, most wanted first
  };
  static constexpr std::size_t kViewports = 16;
  /// Splats of a node to draw: voxels `first` to `last`.
  struct Run {
    std::uint32_t node = 0, first = 0, last = 0;
  };

  LodStream(StreamHeader header, std::size_t cache_bytes, bool grows)
      : header_(std::move(header)), cache_(tree_, header_, cache_bytes, grows) {}
  static Opened make(StreamHeader header, std::size_t cache_bytes, bool grows);
  void scan();
  bool directory_fits() const;
  bool take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset);
  void problem(std::uint64_t offset, std::string message);
  void keep_few_problems();
  /// Callback for a cluster's voxels `first` to `first + count` - 1, which have no finer voxels.
  using OnVoxels = std::function<void(const Cluster& cluster, std::size_t first, std::size_t count)>;
  /// Visits everything received, no finer than `most_discs` splats allow. Returns the number of splats.
  std::size_t visit_whole(std::size_t most_discs, const OnVoxels& visit);
  void visit_below(std::uint32_t node, const Cluster& cluster, std::size_t most_discs, std::size_t& discs,
                   const OnVoxels& visit);

  std::size_t viewport_of(std::uint32_t id);
  void forget_slot(std::size_t slot);
  void select(const LodView& view, const Viewport& last, std::uint16_t bit);
  [[nodiscard]] std::vector<std::uint32_t> to_decode(const LodView& view);
  [[nodiscard]] std::int64_t discs_gained(std::uint32_t node) const;
  void choose(const LodView& view, Viewport& viewport, std::uint16_t bit);
  [[nodiscard]] std::vector<Run> runs(Viewport& viewport, std::uint16_t bit) const;
  [[nodiscard]] std::vector<Piece> pieces(const LodView& view, std::span<const Run> runs) const;

  std::size_t most_discs_ = LodLimits{}.discs;
  bool cut_short_ = false;
  StreamHeader header_;
  std::shared_ptr<const ChunkSource> source_;
  std::shared_ptr<ArrivedChunks> arrived_;  // same object as source_, for a growing stream
  StreamReader reader_;                     // of pushed bytes
  std::size_t reader_problems_ = 0;         // number already copied from reader_
  LodTree tree_;
  LodCache cache_;
  std::vector<StreamProblem> problems_;
  std::uint64_t revision_ = 1, cuts_ = 0;
  std::array<Viewport, kViewports> viewports_;

  // State of the current cut, then of the last one.
  std::vector<std::uint32_t> order_;  // requested nodes, most important first
  std::vector<ChunkRange> wanted_;
  std::size_t decoded_ = 0;
  bool pending_ = false;
};

}  // namespace gs::qnv
