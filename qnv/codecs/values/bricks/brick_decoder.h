#pragma once

#include "base/noncopyable.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/shared/chunk_requests.h"
#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/values/bricks/brick_cache.h"
#include "qnv/codecs/values/bricks/brick_choice.h"
#include "qnv/codecs/values/bricks/received/cluster_chunks.h"
#include "qnv/codecs/values/bricks/received/gap_runs.h"
#include "qnv/codecs/values/bricks/received/kept_payloads.h"
#include "qnv/codecs/values/bricks/received/remainder_runs.h"
#include "qnv/codecs/values/chunk_places.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

namespace gs::qnv {

/// Limits of a volume in bricks.
struct BrickLimits {
  std::size_t brick_bytes = std::size_t{192} << 20;    // bricks, their vectors, and the copies for drawing
  std::size_t arrived_bytes = std::size_t{128} << 20;  // received chunks of bricks
  std::size_t base_vectors = std::size_t{1} << 20;     // of the level that is decoded as a whole
};

/// Counts of a volume in bricks.
struct BrickStatistics {
  std::size_t bricks = 0;    // in memory
  std::size_t shown = 0;     // of the last cut
  std::size_t computed = 0;  // by the last cut
  std::size_t bytes = 0;     // memory of bricks and blocks
  std::size_t arrived = 0;   // bytes of received chunks
  std::size_t clusters = 0;  // places that are known
  int base = 0, finest = 0;  // level of the whole volume; finest level of the last cut
};

/// Decoder of a values stream into a coarse level of the whole volume, and bricks of finer levels for views. One thread
/// at a time. Safe for untrusted bytes.
class BrickDecoder : NonCopyable {
 public:
  /// `source` is the file of the stream; null means that its chunks are added. `step` is that of a time series.
  BrickDecoder(const StreamHeader& header, const BrickLimits& limits, std::shared_ptr<const ChunkSource> source,
               std::uint32_t step = 0);

  /// Returns the level that is decoded as a whole.
  [[nodiscard]] static int base_level(const ValueGrid& grid, std::size_t most_vectors);

  /// Reads the directory of the file, or without one all chunks, and the chunks of the coarse level. Returns false if
  /// the file cannot be read, or if `stop` returned true.
  bool read_source(const std::function<bool()>& stop);
  /// Adds bytes directly after those before. Returns false if further bytes are useless.
  bool push(std::span<const std::byte> bytes);
  void finish();
  /// Adds a whole chunk. Returns false if it is damaged.
  bool add(std::uint64_t offset, std::span<const std::byte> chunk);
  /// Sets the directory. Returns false if it is damaged or of another kind.
  bool set_directory(std::span<const std::byte> chunks);

  /// Decodes what views need. Returns the volume to draw, which is the one before if nothing changed.
  [[nodiscard]] std::shared_ptr<const Volume> decode(std::span<const LodView> views, const std::atomic<bool>& stop);
  /// Returns the chunks that the last decode() lacked, in the order of the stream.
  [[nodiscard]] std::vector<ChunkRange> wanted() const;
  [[nodiscard]] BrickStatistics statistics() const;
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return reader_.problems(); }

 private:
  void take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset);
  void take_place(values::ChunkPlace place);
  bool scan_source(const std::function<bool()>& stop);
  void take_cluster(std::span<const std::byte> payload, std::uint64_t offset);
  void take_run(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset);
  bool decode_base();
  void choose(std::span<const LodView> views);
  void need_runs(const values::SampleBox& brick, std::span<const LodView> views, bool all);
  [[nodiscard]] bool has_final_base() const;
  /// Time series have no remainders here, because section 12 counts them with all other chunks of a step.
  [[nodiscard]] bool has_remainders() const {
    return !chain_.series && (header_.grid.exact || header_.grid.correction != 0);
  }
  void merge(bool with_values);
  [[nodiscard]] bool is_base(std::uint64_t block) const;
  [[nodiscard]] bool is_fine(std::uint64_t block) const;

  const StreamHeader& header_;
  const BrickLimits limits_;
  const std::shared_ptr<const ChunkSource> source_;
  values::BrickLayout layout_;
  const values::StepChain chain_;
  std::vector<VolumeLayout> levels_;  // layouts of the levels 0 to layout_.base()
  values::KeptPayloads kept_;         // received chunks of bricks
  values::ClusterChunks chunks_;
  values::GapRuns gaps_;
  values::RemainderRuns remainders_;
  values::BrickCache cache_;
  StreamReader reader_;
  std::unique_ptr<Decoder> decoder_;  // of the coarse level; null when that is complete
  std::vector<ChunkRange> base_places_;
  std::unordered_set<std::uint64_t> base_known_, base_taken_;  // offsets
  std::size_t base_chunks_ = 0, shown_chunks_ = 0;  // that changed the coarse level so far, and of base_volume_
  std::shared_ptr<const Volume> base_volume_, shown_;
  values::BrickBase base_;
  values::BrickNeeds needs_;                        // of the views
  std::map<std::uint64_t, values::RunPlace> runs_;  // runs of the exact bricks, by their first cube
  std::vector<values::BrickName> merged_;           // bricks of shown_
  bool merged_values_ = false;                      // shown_ has the values of its bricks
  bool whole_base_ = false;                         // the coarse level has the samples that bricks need
  bool has_places_ = false;                         // the places of all chunks that may come are known
};

}  // namespace gs::qnv
