#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/values/cluster.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::qnv::values {

/// Place of a cluster's chunk in a stream.
struct ClusterPlace {
  std::uint64_t offset = 0;  // of the chunk header
  std::uint32_t bytes = 0;   // including the chunk header
  std::uint32_t index = 0;   // of the cluster in its block
};

/// Places of the clusters of each block, and their chunks: those of a file, or received ones. Drops received chunks
/// beyond the limit; they can be received again. One thread at a time.
class ClusterChunks : NonCopyable {
 public:
  /// Uses the chunks of a file, and reads them whenever they are needed.
  explicit ClusterChunks(std::shared_ptr<const ChunkSource> source) : source_(std::move(source)) {}
  /// Keeps received chunks of at most `most_bytes` together.
  explicit ClusterChunks(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Notes where a cluster is. Ignores other places of known clusters, those after the first kMaxDirectoryEntries, and
  /// clusters that no block needs. Returns false for ignored places.
  bool note(std::uint64_t block, const ClusterPlace& place);
  /// Keeps a received chunk. Its place must be known.
  void keep(std::uint64_t block, std::uint64_t offset, std::span<const std::byte> payload);
  /// Drops received chunks of blocks without `used`(block), while there are too many bytes.
  void trim(const std::function<bool(std::uint64_t block)>& used);
  void set_most_bytes(std::size_t most_bytes) { most_bytes_ = most_bytes; }

  /// Returns the clusters of a block that can be decoded one after the other, from index 0 on.
  [[nodiscard]] std::span<const ClusterPlace> of(std::uint64_t block) const;
  /// Returns the payload of a cluster; nullopt if it is not received, cannot be read or is damaged. Any thread, while
  /// no other thread changes this.
  [[nodiscard]] std::optional<Cluster> read(const ClusterPlace& place) const;
  [[nodiscard]] bool has(const ClusterPlace& place) const { return source_ || kept_.contains(place.offset); }
  /// Reports whether the chunk was received and dropped.
  [[nodiscard]] bool was_dropped(const ClusterPlace& place) const { return dropped_.contains(place.offset); }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  struct Kept {
    std::uint64_t block = 0;
    std::vector<std::byte> payload;
  };
  std::shared_ptr<const ChunkSource> source_;
  std::size_t most_bytes_ = 0, bytes_ = 0, count_ = 0;
  std::unordered_map<std::uint64_t, std::vector<ClusterPlace>> places_;  // by block, ascending index
  std::map<std::uint64_t, Kept> kept_;                                   // by offset
  std::unordered_set<std::uint64_t> dropped_;                            // offsets
};

}  // namespace gs::qnv::values
