#pragma once

#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/slices/band_buffer.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv::values {

/// Cluster, packed in a SpillStore. The two bytes before it have its length. The clusters of a block follow each other.
struct StoredCluster {
  std::uint64_t offset = 0;
  std::uint32_t block = 0;
  std::uint16_t index = 0;        // position in the block
  std::uint16_t bytes : 15 = 0;   // packed size
  std::uint16_t differs : 1 = 0;  // the block is a difference to that of the step before
  float rank = 0;                 // gain per byte, by which clusters are ordered
  float gain = 0;                 // reduction of the squared error of the volume
};

/// Planes that an encoder of a block codes.
struct CodedPlanes {
  int last = 0;          // lowest plane
  float least_rank = 0;  // ends after a cluster that gains much less per byte
  bool all = true;       // all of them are kept; otherwise the highest ones decide about differences
};

/// Encodes blocks. Each thread reuses one.
class BlockEncoder {
 public:
  /// Encodes a block. `before` are the decoded coefficients of the step before; with them, the block becomes a
  /// difference if that takes fewer bits.
  void encode(std::uint32_t number, const BlockPlace& place, const BlockBands& bands, const CodedPlanes& planes,
              const BlockBands* before = nullptr);
  /// Moves the clusters of the last block to `clusters` and `bytes`. The offsets are relative to the begin of `bytes`.
  struct Result {
    std::vector<StoredCluster> clusters;
    std::vector<std::byte> bytes;
    double rest = 0;  // squared error that remains
  };
  [[nodiscard]] Result take() { return std::exchange(result_, {}); }

 private:
  void put_cluster(const Block::Encoded& coded, std::uint32_t number, int top, bool differs);

  Result result_;
  BlockScratch scratch_;
  BandBuffer difference_;
};

/// Decoder of the blocks of an encoder from the first clusters of its order.
class StoredBlocks {
 public:
  StoredBlocks(const SpillStore& store, std::span<const StoredCluster> order, std::uint64_t blocks);

  /// Sets the number of clusters to decode, which must not be less than before.
  void keep(std::size_t clusters);
  /// Writes the coefficients of a block that are not zero. Returns its first cluster, or null if it has none. Several
  /// threads may call it.
  const StoredCluster* write(std::uint64_t number, const BlockPlace& place, const BlockBands& bands) const;
  /// Reports whether the store could not be read.
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  struct Kept {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;  // of all clusters of the block, with their lengths
    std::uint32_t first = 0;  // place of the first one in the order
  };
  const SpillStore& store_;
  std::span<const StoredCluster> order_;
  std::vector<Kept> kept_;  // by block
  std::size_t count_ = 0;   // of clusters
  mutable std::atomic<bool> failed_{false};
};

}  // namespace gs::qnv::values
