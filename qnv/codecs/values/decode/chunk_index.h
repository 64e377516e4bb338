#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Place of a cluster's payload in the stream.
struct FoundCluster {
  std::uint64_t offset = 0;
  std::uint32_t block = 0, index = 0, bytes = 0;
};
/// Place of the payload of a run of cubes.
struct FoundRun {
  std::uint64_t offset = 0, first = 0;
  std::uint32_t bytes = 0;
};

/// Chunks of a stream, found in one pass.
struct ChunkIndex {
  std::vector<FoundCluster> clusters;      // by block and index
  std::vector<FoundRun> gaps, remainders;  // by the first cube
  std::uint32_t received = 0;              // number of different chunks
  bool in_order = true;                    // none was lost or refused
};

/// Clusters of one component of a step, by block.
class BlockClusters {
 public:
  BlockClusters(std::vector<FoundCluster> clusters, std::uint64_t blocks)
      : clusters_(std::move(clusters)), first_(blocks + 1) {
    std::size_t at = 0;
    for (std::size_t block = 0; block < first_.size(); ++block) {
      first_[block] = at;
      while (at < clusters_.size() && clusters_[at].block == block) ++at;
    }
  }
  [[nodiscard]] std::span<const FoundCluster> of(std::uint64_t block) const {
    return std::span(clusters_).subspan(first_[block], first_[block + 1] - first_[block]);
  }

 private:
  std::vector<FoundCluster> clusters_;
  std::vector<std::size_t> first_;  // of the clusters of each block
};

/// Finds the chunks of one component of one step.
class ChunkIndexer {
 public:
  /// `later` states that this is a step which may refer to an earlier one.
  explicit ChunkIndexer(const ValueGrid& grid, bool later = false);

  [[nodiscard]] ComponentCounts counts() const { return {layout_.count(), cubes_}; }
  /// Adds a chunk. `payload` has the number in its component; in the stream, it has `bytes` bytes at `offset`.
  void add(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset, std::size_t bytes);
  void note_loss() { index_.in_order = false; }
  /// Returns the index, which has only the clusters that can be decoded.
  [[nodiscard]] ChunkIndex finish();

 private:
  bool add_cluster(std::span<const std::byte> payload, std::uint64_t offset, std::uint32_t bytes);
  bool add_run(std::span<const std::byte> payload, FoundRun place, std::vector<FoundRun>& runs,
               std::uint64_t& cubes) const;

  bool later_;
  bool gaps_, remains_;  // the stream has such chunks
  BlockLayout layout_;
  std::uint64_t cubes_ = 0, gap_cubes_ = 0, remainder_cubes_ = 0;
  ChunkIndex index_;
};

/// Finds the chunks of all components of all steps of a stream. Safe for untrusted chunks.
class ComponentIndexer {
 public:
  void add(const StreamHeader& header, ChunkType type, std::span<const std::byte> payload, std::uint64_t offset);
  /// Returns the index of a component of a step. `number` counts components, then steps.
  [[nodiscard]] ChunkIndex finish(std::size_t number) {
    return number < all_.size() ? all_[number].finish() : ChunkIndex();
  }

 private:
  std::vector<ChunkIndexer> all_;
};

}  // namespace gs::qnv::values
