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
  std::uint8_t level = 0;  // octree level of the splats
  std::uint32_t chunk = 0;  // identifier of the cluster, unique in the stream
  float age = 0;  // 0 for the chunk received first, 1 for the last
};

/// Position of a chunk in its stream.
struct ChunkRange {
  std::uint64_t offset = 0, bytes = 0;
  friend bool operator==(const ChunkRange&, const ChunkRange&) = default;
};

/// Memory limits of a stream.
struct LodLimits {
  std::size_t cache_bytes = std::size_t{1} << 29;  // decoded data that the last cuts do not need
  std::size_t discs = std::size_t{1} << 26;  // splats of one cut or of whole(), for any budget
  std::size_t arrived_bytes = std::size_t{1} << 30;  // received chunks of a stream that still grows
};

/// Octree stream from which each view decodes the clusters that it needs: coarse clusters everywhere, finer ones in
/// view, largest on the screen first. The stream is in memory, in a file, or still growing. One thread at a time. Safe
/// for untrusted bytes: skips invalid clusters with their descendants; the coarser picture remains.
class LodStream {
 public:
  /// Default limit in bytes of decoded data that the last cuts do not need.
  static constexpr std::size_t kCacheBytes = LodLimits{}.cache_bytes;
  using Opened = std::variant<std::unique_ptr<LodStream>, StreamProblem>;

  /// Opens a stream in memory. Reads and checks all of it now. Returns an error if that fails.
  [[nodiscard]] static Opened open(std::vector<std::byte> bytes, std::size_t cache_bytes = kCacheBytes);
  /// Opens a stream from a source, such as a file. Reads the header and the directory now, and a chunk when a view
  /// needs it. If the directory is incomplete or wrong, reads the whole stream once.
  [[nodiscard]] static Opened open(std::shared_ptr<const ChunkSource> source, std::size_t cache_bytes = kCacheBytes);
  /// Opens a growing stream from its first bytes, which must contain the whole header.
  [[nodiscard]] static Opened begin(std::span<const std::byte> front, std::size_t cache_bytes = kCacheBytes);

  /// Sets the limits. Call it before the first cut.
  void set_limits(const LodLimits& limits);

  /// Adds bytes to a growing stream, directly after the bytes of begin() and of earlier calls. Returns false if further
  /// bytes are useless.
  bool push(std::span<const std::byte> bytes);
  /// Ends the input. Call it after the last push().
  void finish();
  /// Sets the directory. `chunks` are all directory chunks, concatenated. wanted() needs the directory. Returns false
  /// if `chunks` is incomplete.
  bool set_directory(std::span<const std::byte> chunks);
  /// Adds a whole chunk at its offset in the stream, in any order. Returns false if the chunk is rejected; problems()
  /// has the reason.
  bool add(std::uint64_t offset, std::span<const std::byte> chunk);

  /// Returns the runs of splats to draw. They cover everything in view exactly once. Omits clusters entirely outside
  /// the view. For the same view and bytes, the detail never decreases from call to call.
  [[nodiscard]] std::vector<Piece> cut(const LodView& view);
  /// Reports whether the last cut lacks clusters that are received but not decoded yet. If so, the next cut is better.
  [[nodiscard]] bool pending() const { return pending_; }
  /// Returns the chunks that the last cut needed and that are not received yet, most wanted first.
  [[nodiscard]] const std::vector<ChunkRange>& wanted() const { return wanted_; }
  /// Returns the wanted chunks of all viewports: takes one per viewport in turn, without duplicates.
  [[nodiscard]] std::vector<ChunkRange> wanted_by_all() const;
  /// Returns the view of each viewport's last cut.
  [[nodiscard]] std::vector<LodView> views() const;
  /// Reports whether the last cut contains everything that its view requested.
  [[nodiscard]] bool complete() const { return !pending_ && wanted_.empty(); }
  /// Frees the state of a viewport that will make no further cuts.
  void forget(std::uint32_t viewport);

  /// Returns all vectors at full detail, or coarser ones at the limit of splats.
  [[nodiscard]] Splats whole();
  /// Reports whether whole() returned coarser vectors because of the limit.
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  /// Returns the number of vectors at full detail. Decodes the whole stream to count them.
  [[nodiscard]] std::size_t count();

  [[nodiscard]] const StreamHeader& header() const { return header_; }
  /// Returns the problems in the bytes read so far. Valid parts of the stream remain usable.
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  /// Returns the number of received clusters.
  [[nodiscard]] std::size_t clusters() const { return tree_.present(); }
  /// Returns a counter that increases with every received chunk.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  [[nodiscard]] std::size_t cached_discs() const { return cache_.disc_count(); }
  [[nodiscard]] std::size_t cached_bytes() const { return cache_.bytes(); }
  /// Returns the approximate number of splats that were decoded for the last cut.
  [[nodiscard]] std::size_t decoded() const { return decoded_; }

 private:
  /// State of the last cut of one viewport.
  struct Viewport {
    LodView view;
    std::uint64_t last_cut = 0;  // number of the last cut; 0 means none yet
    std::uint64_t revision = 0;
    std::vector<std::uint32_t> chosen, shown;
    std::vector<std::uint32_t> lacking;  // nodes not received, most wanted first
  };
  static constexpr std::size_t kViewports = 16;
  /// Part of a node's splats to draw: the splats of its voxels from `first` up to `last`, which is excluded.
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
  /// Callback that receives `count` voxels of a cluster, from index `first` on. They have no finer voxels.
  using OnVoxels = std::function<void(const Cluster& cluster, std::size_t first, std::size_t count)>;
  /// Visits the finest received voxels. Visits coarser voxels instead where the number of splats would exceed
  /// `most_discs`. Returns the number of splats.
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
  std::shared_ptr<ArrivedChunks> arrived_;  // same object as source_ in a growing stream, otherwise null
  StreamReader reader_;  // reader of the bytes passed to push()
  std::size_t reader_problems_ = 0;  // number of problems already copied from reader_
  LodTree tree_;
  LodCache cache_;
  std::vector<StreamProblem> problems_;
  std::uint64_t revision_ = 1, cuts_ = 0;
  std::array<Viewport, kViewports> viewports_;

  // Results of the current cut; between two cuts, of the last cut.
  std::vector<std::uint32_t> order_;  // requested nodes, most important first
  std::vector<ChunkRange> wanted_;
  std::size_t decoded_ = 0;
  bool pending_ = false;
};

}  // namespace gs::qnv
