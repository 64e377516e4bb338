#pragma once

#include "base/parallel.h"
#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/values/encode/encode_values.h"
#include "qnv/codecs/values/slices/slice_transform.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv::values {

/// Rank that a cluster needs to be among the first `max_bytes` of those seen so far. It only grows with more clusters.
class LeastRank {
 public:
  explicit LeastRank(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  [[nodiscard]] float rank() const { return rank_; }
  void add(std::span<const StoredCluster> clusters);
  /// Raises the rank after some clusters.
  void update();

 private:
  std::size_t max_bytes_;
  float rank_ = 0;
  std::vector<std::pair<float, std::size_t>> kept_;  // rank and bytes
};

/// Encoder of all blocks of a volume. A process alone transforms all levels in one pass over the volume. Several ranks
/// transform one level after the other. Each one takes some rows of blocks, and reads the samples that they depend on,
/// with a halo. It keeps the low samples of its rows in the store, where all ranks read them for the next level.
class VolumeEncoder {
 public:
  /// Encodes no more than what `max_bytes` need, if that is given. Then rank 0 encodes all blocks, because each one
  /// depends on those before.
  VolumeEncoder(Extent extent, const ValuesLimit& limit, SpillStore& store, unsigned threads, Progress* progress,
                const EncodedStep* step, const SharedWork& work);

  [[nodiscard]] std::uint64_t blocks() const { return layout_.count(); }
  [[nodiscard]] const BlockLayout& layout() const { return layout_; }
  /// Encodes down to a plane; coarse levels need more. All ranks return the same.
  std::optional<EncodeError> encode(const ReadSamples& read, int last_plane);
  /// Returns the clusters of all ranks.
  std::vector<StoredCluster>& clusters() { return clusters_; }
  /// Returns the squared error that all clusters leave.
  [[nodiscard]] double rest() const { return rest_; }

 private:
  /// Squared error of a row of blocks, and the offset of its low samples in the store.
  struct RowResult {
    std::uint64_t first_block = 0, low = 0;
    double rest = 0;
  };
  /// Size of the store and number of clusters before a row.
  struct RowBegin {
    std::uint64_t offset = 0;
    std::size_t clusters = 0;
  };
  std::optional<EncodeError> encode_alone(const ReadSamples& read, int last_plane);
  std::optional<EncodeError> encode_level(int level, const ReadSamples& read, int last_plane);
  std::optional<EncodeError> encode_rows(int level, RankShare rows, const ReadSamples& read, int last_plane);
  std::optional<EncodeError> read_low(int level, std::uint32_t slice, std::span<std::int32_t> to) const;
  bool restore_row(const std::string& work);
  bool finish_row(const std::string& work, int level, std::uint32_t row, const RowBegin& begin, LevelSlices& slices);
  [[nodiscard]] std::string name_of(int last_plane, int level, std::uint64_t row) const;
  bool take(std::uint64_t first, std::uint32_t count, LevelSlices& slices, int last_plane);
  bool take_part(std::uint64_t first, std::uint32_t count, LevelSlices& slices, int last_plane);
  bool cannot_store();
  void collect();

  Extent extent_;
  BlockLayout layout_;
  SpillStore& store_;
  unsigned threads_;
  Progress* progress_;
  StepCoefficients* before_;  // of a time series, or null
  SharedWork work_;
  Ranks alone_;
  Ranks& ranks_;
  std::vector<StoredCluster> clusters_;
  std::vector<RowResult> rows_;  // of this rank
  std::vector<RowResult> lows_;  // of all ranks: the level before
  double rest_ = 0;
  std::optional<LeastRank> least_;  // null without a limited size
  std::optional<EncodeError> problem_;
};

}  // namespace gs::qnv::values
