#pragma once

#include "qnv/codecs/octree/lod/lod_cache.h"
#include "qnv/codecs/octree/lod/lod_chunks.h"
#include "qnv/codecs/octree/lod/lod_cutter.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/shared/lod_view.h"
#include "qnv/codecs/shared/viewed_stream.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Statistics of an octree stream.
struct LodStatistics {
  std::size_t clusters = 0;                        // number of received clusters
  std::size_t cached_discs = 0, cached_bytes = 0;  // decoded splats; memory of all decoded data
  std::size_t decoded = 0;                         // approximate number of splats that were decoded for the last cut
};

/// Octree stream from which each view decodes the clusters that it needs: coarse clusters everywhere, finer ones in
/// view, largest on the screen first. The stream is in memory, in a file, or still growing. One thread at a time. Safe
/// for untrusted bytes: skips invalid clusters with their descendants; the coarser picture remains.
class LodStream final : public ViewedStream {
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
  bool push(std::span<const std::byte> bytes) override;
  /// Ends the input. Call it after the last push().
  void finish() override;
  bool set_directory(std::span<const std::byte> chunks) override { return chunks_.set_directory(chunks); }
  /// Adds a whole chunk at its offset in the stream, in any order. Returns false if the chunk is rejected; problems()
  /// has the reason.
  bool add(std::uint64_t offset, std::span<const std::byte> chunk) override;

  /// Returns the runs of splats to draw. They cover everything in view exactly once. Omits clusters entirely outside
  /// the view. For the same view and bytes, the detail never decreases from call to call.
  [[nodiscard]] std::vector<Piece> cut(const LodView& view) { return cutter_.cut(view); }
  /// Reports whether the last cut lacks clusters that are received but not decoded yet. If so, the next cut is better.
  [[nodiscard]] bool pending() const { return cutter_.pending(); }
  /// Returns the chunks that the last cut needed and that are not received yet, most wanted first.
  [[nodiscard]] const std::vector<ChunkRange>& lacking() const { return cutter_.lacking(); }
  /// Reports whether the last cut contains everything that its view requested.
  [[nodiscard]] bool complete() const { return !pending() && lacking().empty(); }

  /// Does nothing, because cut() notes its view.
  void note(const LodView&) override {}
  /// Frees the state of a viewport that will make no further cuts.
  void forget(std::uint32_t viewport) override { cutter_.forget(viewport); }
  /// Returns the view of each viewport's last cut.
  [[nodiscard]] std::vector<LodView> views() const override { return cutter_.views(); }
  [[nodiscard]] const Box& box() const override { return header().description.box; }
  [[nodiscard]] std::uint64_t directory() const override { return header().directory; }
  [[nodiscard]] bool in_stream_order() const override { return false; }
  /// Returns the chunks that the last cuts of all viewports lacked: takes one per viewport in turn, without duplicates.
  [[nodiscard]] std::vector<ChunkRange> wanted() const override { return cutter_.lacking_for_all(); }

  /// Returns all vectors at full detail, or coarser ones at the limit of splats.
  [[nodiscard]] Splats whole();
  /// Reports whether whole() returned coarser vectors because of the limit.
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  /// Returns the number of vectors at full detail. Decodes the whole stream to count them.
  [[nodiscard]] std::size_t count();

  [[nodiscard]] const StreamHeader& header() const { return chunks_.header(); }
  /// Returns the problems in the bytes read so far. Valid parts of the stream remain usable.
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return chunks_.problems(); }
  /// Returns a counter that increases with every received chunk.
  [[nodiscard]] std::uint64_t revision() const { return chunks_.revision(); }
  [[nodiscard]] LodStatistics statistics() const {
    return {chunks_.tree().present(), cache_.disc_count(), cache_.bytes(), cutter_.decoded()};
  }

 private:
  LodStream(LodChunks chunks, std::size_t cache_bytes)
      : chunks_(std::move(chunks)), cache_(chunks_, cache_bytes), cutter_(chunks_, cache_) {}
  static Opened make(LodChunks::Opened opened, std::size_t cache_bytes);

  LodChunks chunks_;
  LodCache cache_;
  LodCutter cutter_;
  std::size_t most_discs_ = LodLimits{}.discs;
  bool cut_short_ = false;
};

}  // namespace gs::qnv
