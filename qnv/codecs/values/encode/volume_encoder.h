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
/// the low samples of its rows in the store, where all ranks read them for the next level. If a level has few rows,
/// several ranks transform the same row, and each of them encodes other blocks of it.
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
  /// Squared error of a piece of a row of blocks. The first piece of a row has the offset of the row's low samples in
  /// the store.
  struct PieceResult {
    std::uint64_t first_block = 0, low = 0;
    double rest = 0;
  };
  /// State before a piece: size of the store, and numbers of pieces and of clusters.
  struct PieceBegin {
    std::uint64_t offset = 0;
    std::size_t pieces = 0, clusters = 0;
  };
  /// Pieces of the rows of a level: blocks that one rank encodes together.
  struct LevelPieces {
    std::uint64_t first_block = 0;                // of the level
    std::uint32_t rows = 0, in_row = 0;           // number of rows, and of blocks in a row
    [[nodiscard]] std::uint64_t per_row() const;  // pieces
    [[nodiscard]] std::uint64_t size() const { return rows * per_row(); }
    /// Returns the first block of a piece, and its number of blocks.
    [[nodiscard]] std::uint64_t first_of(std::uint64_t piece) const;
    [[nodiscard]] std::uint32_t count_of(std::uint64_t piece) const;
  };
  [[nodiscard]] LevelPieces pieces_of(int level) const;
  [[nodiscard]] RankShare share_of_level(const LevelPieces& pieces) const;
  std::optional<EncodeError> encode_alone(const ReadSamples& read, int last_plane);
  std::optional<EncodeError> encode_level(int level, const ReadSamples& read, int last_plane);
  std::optional<EncodeError> encode_pieces(int level, RankShare pieces, const ReadSamples& read, int last_plane);
  std::optional<EncodeError> read_low(int level, std::uint32_t slice, std::span<std::int32_t> to) const;
  bool restore_piece(const std::string& work, const LevelPieces& pieces, std::uint64_t piece);
  bool finish_piece(const std::string& work, int level, std::optional<std::uint32_t> row, const PieceBegin& begin,
                    LevelSlices& slices);
  [[nodiscard]] std::string name_of(int last_plane, int level, std::uint64_t piece) const;
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
  std::vector<PieceResult> pieces_;  // of this rank
  std::vector<PieceResult> lows_;    // first pieces of all rows of the previous level, for read_low()
  double rest_ = 0;
  std::optional<LeastRank> least_;  // null without a limited size
  std::optional<EncodeError> problem_;
};

}  // namespace gs::qnv::values
