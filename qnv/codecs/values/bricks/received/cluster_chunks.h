#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/values/bricks/received/kept_payloads.h"
#include "qnv/codecs/values/cluster.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::qnv::values {

/// Place of a cluster's chunk in a stream.
struct ClusterPlace {
  std::uint64_t offset = 0;  // of the chunk header
  std::uint32_t bytes = 0;   // including the chunk header
  std::uint32_t index = 0;   // of the cluster in its block
};

/// Steps of a time series that one step refers to, or a single volume. Blocks are numbered over all steps.
struct StepChain {
  std::uint64_t blocks = 1, cubes = 1;  // of a step
  std::uint32_t first = 0, last = 0;    // steps; 0 for a single volume
  bool series = false;

  [[nodiscard]] bool has(std::uint64_t step) const { return step >= first && step <= last; }
  [[nodiscard]] std::uint64_t number(std::uint32_t step, std::uint64_t block) const { return step * blocks + block; }
  /// Parses a cluster, with the number of its block in its step. Returns nullopt if it is invalid, or of another step.
  /// Sets `step` if it is not null.
  [[nodiscard]] std::optional<Cluster> parse(std::span<const std::byte> payload, std::uint32_t* step = nullptr) const;
};

/// Places of the clusters of each block, and their chunks: those of a file, or received ones. One thread at a time.
class ClusterChunks : NonCopyable {
 public:
  /// Uses the chunks of a file, and reads them whenever they are needed. Without a file, uses the kept ones. `chain`
  /// must stay valid.
  ClusterChunks(std::shared_ptr<const ChunkSource> source, KeptPayloads& kept, const StepChain& chain)
      : source_(std::move(source)), kept_(kept), chain_(chain) {}

  /// Notes where a cluster is. Ignores other places of known clusters, those after the first kMaxDirectoryEntries, and
  /// clusters that no block needs. Returns false for ignored places.
  bool note(std::uint64_t block, const ClusterPlace& place);
  /// Keeps a received chunk. Its place must be known.
  void keep(std::uint64_t block, std::uint64_t offset, std::span<const std::byte> payload) {
    kept_.keep(offset, block, payload);
  }

  /// Returns the clusters of a block that can be decoded one after the other, from index 0 on.
  [[nodiscard]] std::span<const ClusterPlace> of(std::uint64_t block) const;
  /// Returns the number of clusters of a block with a known place.
  [[nodiscard]] std::size_t known(std::uint64_t block) const;
  /// Returns a cluster of a block; nullopt if it is not received, cannot be read or is damaged. Any thread, while no
  /// other thread changes this.
  [[nodiscard]] std::optional<Cluster> read(std::uint64_t block, const ClusterPlace& place) const;
  [[nodiscard]] bool has(const ClusterPlace& place) const { return source_ || kept_.has(place.offset); }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::shared_ptr<const ChunkSource> source_;
  KeptPayloads& kept_;
  const StepChain& chain_;
  std::size_t count_ = 0;
  std::unordered_map<std::uint64_t, std::vector<ClusterPlace>> places_;  // by block, ascending index
};

}  // namespace gs::qnv::values
