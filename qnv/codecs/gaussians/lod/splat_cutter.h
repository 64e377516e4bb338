#pragma once

#include "qnv/codecs/gaussians/lod/splat_cache.h"
#include "qnv/codecs/gaussians/lod/splat_chunks.h"
#include "qnv/codecs/shared/chunk_requests.h"
#include "qnv/codecs/shared/lod_view.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::qnv {

/// Run of Gaussians of one cluster.
struct SplatRun {
  std::shared_ptr<const Gaussians> splats;
  std::uint32_t first = 0, count = 0;
  float presence = 1;  // share of the opacity; below 1 while other Gaussians fade in or out here
  friend bool operator==(const SplatRun&, const SplatRun&) = default;
};

namespace gaussians {

/// Cuts of the viewports that draw a stream of Gaussians. Each viewport keeps its last cut. One thread at a time.
class SplatCutter {
 public:
  /// `chunks` and `cache` belong to the same stream and must outlive this object.
  SplatCutter(SplatChunks& chunks, SplatCache& cache) : chunks_(chunks), tree_(chunks.tree()), cache_(cache) {}

  /// Sets the maximum number of Gaussians of one cut, for any budget.
  void set_most_splats(std::size_t most_splats) { most_splats_ = most_splats; }
  /// Returns the runs to draw. @see SplatStream::cut
  [[nodiscard]] const std::vector<SplatRun>& cut(const LodView& view, std::optional<double> time, bool fades);
  void forget(std::uint32_t viewport);

  /// Reports whether the last cut lacks clusters that are received but not decoded yet.
  [[nodiscard]] bool pending() const { return pending_; }
  /// Reports whether Gaussians of the last cut fade in or out.
  [[nodiscard]] bool fading() const { return fading_; }
  /// Returns the missing chunks of the last cuts of all viewports: one per viewport in turn, without duplicates.
  [[nodiscard]] std::vector<ChunkRange> lacking_for_all() const;
  [[nodiscard]] std::vector<LodView> views() const;
  [[nodiscard]] std::size_t decoded() const { return decoded_; }

 private:
  /// Chunk that is not yet received.
  struct Lack {
    std::uint32_t index = 0;  // index of a cluster or of a chunk of harmonics
    bool harmonics = false;
  };
  /// State of the last cut of one viewport.
  struct Viewport {
    LodView view;
    std::uint64_t last_cut = 0;  // number of the last cut; 0 means none yet
    std::uint64_t revision = 0;
    bool complete = false;                            // all selected clusters that are received are in the cut
    std::vector<std::uint32_t> chosen;                // parents before children
    std::unordered_map<std::uint32_t, float> fading;  // weights of clusters that fade in or out
    double time = 0;                                  // time of the last cut with a time
    std::vector<Lack> lacking;                        // most important first
    std::vector<SplatRun> runs;
  };
  static constexpr std::size_t kViewports = 16;

  std::size_t viewport_of(std::uint32_t id);
  void forget_slot(std::size_t slot);
  [[nodiscard]] float key_of(const SplatCluster& cluster, const LodView& view) const;
  void select(const LodView& view, const Viewport& last, std::uint16_t bit);
  [[nodiscard]] std::vector<std::uint32_t> to_decode(const LodView& view, bool& limited);
  [[nodiscard]] std::int64_t gained(std::uint32_t cluster) const;
  [[nodiscard]] std::int64_t budget_of(const LodView& view) const;
  void choose(const LodView& view, Viewport& viewport, std::uint16_t bit);
  void look_ahead(const LodView& view, Viewport& viewport) const;
  void fade(const LodView& view, Viewport& viewport, std::span<const std::uint32_t> before, std::uint16_t bit,
            std::optional<double> time, bool fades);
  [[nodiscard]] std::vector<std::uint32_t> drawn(const Viewport& viewport) const;
  void make_runs(const LodView& view, Viewport& viewport);
  void keep_cuts();

  SplatChunks& chunks_;
  SplatTree& tree_;  // of chunks_
  SplatCache& cache_;
  std::size_t most_splats_ = std::size_t{1} << 26;
  std::uint64_t cuts_ = 0;
  std::array<Viewport, kViewports> viewports_;

  // Results of the current or last cut.
  std::vector<std::uint32_t> order_;  // selected clusters, most important first
  std::size_t decoded_ = 0;
  bool pending_ = false, fading_ = false;
};

}  // namespace gaussians
}  // namespace gs::qnv
