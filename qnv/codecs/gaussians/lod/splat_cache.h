#pragma once

#include "base/noncopyable.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/gaussians/lod/splat_chunks.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::qnv::gaussians {

/// Decoded clusters of a stream: Gaussians for drawing, and states for decoding children. Call from one thread; uses
/// other threads internally.
class SplatCache : NonCopyable {
 public:
  /// Gaussians of a cluster: inner ones first, in the order of the stream, then the leaves.
  struct Block {
    std::shared_ptr<const Gaussians> splats;
    std::uint32_t inner = 0;  // number of inner Gaussians
  };

  /// `chunks` must outlive this object.
  SplatCache(SplatChunks& chunks, std::size_t most_bytes)
      : chunks_(chunks), tree_(chunks.tree()), most_bytes_(most_bytes) {}
  void set_most_bytes(std::size_t most_bytes) { most_bytes_ = most_bytes; }

  [[nodiscard]] bool has(std::uint32_t cluster) const { return entry(cluster) && entry(cluster)->block.splats; }
  [[nodiscard]] bool has_state(std::uint32_t cluster) const { return entry(cluster) && entry(cluster)->state; }
  [[nodiscard]] const Block& block(std::uint32_t cluster) const { return entries_[cluster]->block; }

  /// Decodes clusters. The parent of each must have its state or be in `clusters`. Rejects invalid
  /// clusters, or postpones them while a repair is running.
  void decode(std::vector<std::uint32_t> clusters, std::uint64_t now);
  /// Finds the Gaussians of the parent that a cluster replaces, and their size, if the parent is decoded.
  void size_up(std::uint32_t cluster);
  /// Adds the harmonics that were received since the clusters were decoded. Parents must be before their children.
  void add_harmonics(std::span<const std::uint32_t> clusters);

  /// Marks a cluster as needed by the cut at `now`, so that shrink() keeps its Gaussians.
  void pin(std::uint32_t cluster, std::uint64_t now);
  /// Marks the state of a cluster as used.
  void use_state(std::uint32_t cluster, std::uint64_t now);
  /// Frees states until they fit into their share of the memory.
  void shrink_states();
  /// Frees data until it fits into the limit: first states, then the least recently used clusters. Keeps Gaussians that
  /// were pinned at `now`.
  void shrink(std::uint64_t now);

  /// Returns the number of clusters to decode at once, so that their states do not exceed the memory.
  [[nodiscard]] std::size_t most_at_once() const;

  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t splats() const { return splats_; }

 private:
  struct Entry {
    Block block;
    std::unique_ptr<const SplatState> state;
    std::vector<std::uint16_t>
        ranks;  // number of inner Gaussians before each Gaussian in the order of the stream; empty if all are leaves
    std::vector<NodeOrigin> origins;  // in the order of the block; parents are indices in the parent's block; empty
                                      // without harmonics
    std::uint32_t harmonics = 0;      // received chunks of harmonics of the block and its ancestors
    std::uint64_t used = 0, state_used = 0;
    std::size_t bytes = 0, state_bytes = 0;
  };
  [[nodiscard]] const Entry* entry(std::uint32_t cluster) const {
    return cluster < entries_.size() ? entries_[cluster].get() : nullptr;
  }
  /// Returns the number of received chunks of harmonics of a cluster and of its ancestors.
  [[nodiscard]] std::uint32_t received_harmonics(std::uint32_t cluster) const;
  /// Sets the harmonics of a block: own ones, else those of the parents if these are decoded.
  void put_harmonics(std::uint32_t cluster, const Entry& own, Gaussians& splats);
  /// Records that a cluster replaces a range of Gaussians of `parent`. Returns false if it is empty or overlaps others.
  bool cover(std::uint32_t parent, std::uint32_t from, std::uint32_t to);
  [[nodiscard]] std::unique_ptr<Entry> made(std::uint32_t cluster, const DecodedCluster& decoded);
  void update_parents(std::span<const std::uint32_t> clusters);
  void keep(std::uint32_t cluster, std::unique_ptr<Entry> made, std::uint64_t now);
  /// Reports whether a child of a cluster is still to be decoded, which requires the state of the cluster.
  [[nodiscard]] bool is_state_needed(std::uint32_t cluster) const;
  /// Frees at least `bytes` of states, if there are as many: first states that no child needs, then the others. Both
  /// start with the least recently used ones.
  void drop_states(std::size_t bytes);
  void drop_state(std::uint32_t cluster);
  void drop(std::uint32_t cluster);

  SplatChunks& chunks_;
  SplatTree& tree_;  // of chunks_
  std::size_t most_bytes_, bytes_ = 0, state_bytes_ = 0, splats_ = 0;
  std::vector<std::unique_ptr<Entry>> entries_;  // one per cluster
  // Ranges that children replace, by parent. Maps the beginning of a range to its end. Ranges do not overlap.
  std::unordered_map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> covered_;
  std::atomic<bool> damaged_ = false;  // a chunk of harmonics was damaged
};

}  // namespace gs::qnv::gaussians
