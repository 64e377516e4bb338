#pragma once

#include "qnv/codecs/octree/lod/lod_cache.h"
#include "qnv/codecs/octree/lod/lod_chunks.h"
#include "qnv/codecs/shared/chunk_requests.h"
#include "qnv/codecs/shared/lod_view.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::qnv {

/// Run of splats that share arrays.
struct Piece {
  std::shared_ptr<const Splats> splats;
  std::size_t first = 0, count = 0;
  std::uint8_t level = 0;   // octree level of the splats
  std::uint32_t chunk = 0;  // identifier of the cluster, unique in the stream
  float age = 0;            // 0 for the chunk received first, 1 for the last
};

/// Cuts of the viewports that draw an octree stream. Each viewport keeps its last cut. One thread at a time.
class LodCutter {
 public:
  /// `chunks` and `cache` belong to the same stream and must outlive this object.
  LodCutter(LodChunks& chunks, LodCache& cache) : chunks_(chunks), tree_(chunks.tree()), cache_(cache) {}

  /// Sets the maximum number of splats of one cut, for any budget.
  void set_most_discs(std::size_t most_discs) { most_discs_ = most_discs; }
  /// Returns the runs of splats to draw. @see LodStream::cut
  [[nodiscard]] std::vector<Piece> cut(const LodView& view);
  /// Frees the state of a viewport that will make no further cuts.
  void forget(std::uint32_t viewport);

  /// Reports whether the last cut lacks clusters that are received but not decoded yet.
  [[nodiscard]] bool pending() const { return pending_; }
  /// Returns the chunks that the last cut needed and that are not received yet, most wanted first.
  [[nodiscard]] const std::vector<ChunkRange>& lacking() const { return lacking_; }
  /// Returns the lacking chunks of all viewports: takes one per viewport in turn, without duplicates.
  [[nodiscard]] std::vector<ChunkRange> lacking_for_all() const;
  /// Returns the view of each viewport's last cut.
  [[nodiscard]] std::vector<LodView> views() const;
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

  std::size_t viewport_of(std::uint32_t id);
  void forget_slot(std::size_t slot);
  void select(const LodView& view, const Viewport& last, std::uint16_t bit);
  [[nodiscard]] std::vector<std::uint32_t> to_decode(const LodView& view);
  [[nodiscard]] std::int64_t discs_gained(std::uint32_t node) const;
  void choose(const LodView& view, Viewport& viewport, std::uint16_t bit);
  [[nodiscard]] std::vector<Run> runs(Viewport& viewport, std::uint16_t bit) const;
  [[nodiscard]] std::vector<Piece> pieces(const LodView& view, std::span<const Run> runs) const;
  void keep_cuts();

  LodChunks& chunks_;
  LodTree& tree_;  // of chunks_
  LodCache& cache_;
  std::size_t most_discs_ = LodLimits{}.discs;
  std::uint64_t cuts_ = 0;
  std::array<Viewport, kViewports> viewports_;

  // Results of the current cut; between two cuts, of the last cut.
  std::vector<std::uint32_t> order_;  // requested nodes, most important first
  std::vector<ChunkRange> lacking_;
  std::size_t decoded_ = 0;
  bool pending_ = false;
};

}  // namespace gs::qnv
