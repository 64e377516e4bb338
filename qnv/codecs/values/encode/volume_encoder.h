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

/// Minimum rank of a cluster that belongs to the best `max_bytes` bytes of the clusters so far. It only grows.
class LeastRank {
 public:
  explicit LeastRank(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  [[nodiscard]] float rank() const { return rank_; }
  void add(std::span<const StoredCluster> clusters);
  /// Raises the minimum rank to that of the clusters added so far.
  void update();

 private:
  std::size_t max_bytes_;
  float rank_ = 0;
  std::vector<std::pair<float, std::size_t>> kept_;  // rank and bytes
};

/// Encoder of all blocks of a volume. A single process transforms all levels in one pass over the volume. Several ranks
/// transform one level after the other. Each rank encodes some rows of blocks, from their samples and a halo. It keeps
/// the low samples of its rows in the store, where all ranks read them for the next level.
class VolumeEncoder {
 public:
  /// With `max_bytes`, leaves out clusters that do not fit. Rank 0 then encodes all blocks, because each block depends
  /// on the earlier blocks.
  VolumeEncoder(Extent extent, const ValuesLimit& limit, SpillStore& store, unsigned threads, Progress* progress,
                const EncodedStep* step, const SharedWork& work);

  [[nodiscard]] std::uint64_t blocks() const { return layout_.count(); }
  [[nodiscard]] const BlockLayout& layout() const { return layout_; }
  /// Encodes bit planes down to `last_plane`, and more planes of coarse levels. All ranks return the same.
  std::optional<EncodeError> encode(const ReadSamples& read, int last_plane);
  /// Returns the clusters of all ranks.
  std::vector<StoredCluster>& clusters() { return clusters_; }
  /// Returns the squared error that remains after all clusters.
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
  bool restore_row(const std::string& work, int level, std::uint64_t row);
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
  StepCoefficients* before_;  // previous step of a time series, or null
  SharedWork work_;
  Ranks alone_;
  Ranks& ranks_;
  std::vector<StoredCluster> clusters_;
  std::vector<RowResult> rows_;  // of this rank
  std::vector<RowResult> lows_;  // of all ranks, for the previous level
  double rest_ = 0;
  std::optional<LeastRank> least_;  // null without a limited size
  std::optional<EncodeError> problem_;
};

}  // namespace gs::qnv::values
