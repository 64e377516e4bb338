#pragma once

#include "qnv/codecs/octree/lod/lod_chunks.h"
#include "qnv/codecs/octree/packed.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gs::qnv {

/// Decoded data of a stream's clusters: voxels, which children need, and splats, which are drawn. Clusters of one
/// parent with splats made at the same time share arrays, which keeps the number of arrays low. Call from one
/// thread; it uses others internally.
class LodCache {
 public:
  /// `chunks` must outlive this object. If they grow, also keeps the voxels of clusters without known children, because
  /// children may be received later.
  LodCache(LodChunks& chunks, std::size_t most_bytes)
      : chunks_(chunks), tree_(chunks.tree()), header_(chunks.header()), most_bytes_(most_bytes) {}

  void set_most_bytes(std::size_t most_bytes) { most_bytes_ = most_bytes; }

  [[nodiscard]] bool has_voxels(std::uint32_t node) const { return entry(node) && entry(node)->voxels; }
  [[nodiscard]] bool has_discs(std::uint32_t node) const { return entry(node) && entry(node)->discs; }
  [[nodiscard]] bool has(std::uint32_t node) const { return has_voxels(node) || has_discs(node); }

  /// Decodes the voxels of the clusters `nodes`. The parent of each cluster must be decoded already or be in `nodes`.
  /// Rejects invalid clusters, and clusters that do not match their description.
  void decode(std::vector<std::uint32_t> nodes, std::uint64_t now);
  /// Computes the box of a cluster without one. Uses the voxels of the parent if they are available.
  void find_box(std::uint32_t node);
  /// Makes the splats of clusters that have voxels.
  void make_discs(std::vector<std::uint32_t> nodes, std::uint64_t now);

  /// Splats of some voxels of a cluster, in their shared arrays.
  struct Discs {
    std::uint64_t order = 0;  // sequence number of the arrays
    std::shared_ptr<const Splats> splats;
    std::size_t first = 0, last = 0;
  };
  /// Returns the splats of the voxels from `first_voxel` up to `last_voxel`, which is excluded. The node must have
  /// splats.
  [[nodiscard]] Discs discs(std::uint32_t node, std::size_t first_voxel, std::size_t last_voxel) const;

  /// Marks voxels as used at the time `now`; use_discs() does this for splats.
  void use_voxels(std::uint32_t node, std::uint64_t now);
  void use_discs(std::uint32_t node, std::uint64_t now);
  /// Marks a cluster's splats as needed by the cut at `now`, so that shrink() keeps them. pin() marks all data of a
  /// cluster that the cut needs without drawing its splats.
  void pin_discs(std::uint32_t node, std::uint64_t now);
  void pin(std::uint32_t node, std::uint64_t now);
  /// Frees the least recently used data until the limit is met. Keeps the data that was pinned at `now`.
  void shrink(std::uint64_t now);

  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t disc_count() const { return disc_count_; }

 private:
  struct Group {
    std::shared_ptr<const Splats> splats;
    std::vector<std::uint32_t> members;
    std::uint64_t order = 0, used = 0, pinned = 0;
    std::size_t bytes = 0;
  };
  struct Entry {
    std::unique_ptr<Cluster> voxels;
    std::vector<bool> divided;  // one flag per voxel: a known child divides it
    std::uint64_t used = 0, pinned = 0;  // times of the last use and pin of the voxels
    Group* discs = nullptr;  // group that contains the splats
    std::size_t first_disc = 0;  // index of the first splat in the group
    std::vector<std::uint32_t> disc_of;  // first splat of each voxel, then the end; empty if one each
  };
  struct Family;

  [[nodiscard]] const Entry* entry(std::uint32_t node) const {
    return node < entries_.size() ? entries_[node].get() : nullptr;
  }
  Entry& made_entry(std::uint32_t node);
  [[nodiscard]] std::string take(std::uint32_t node, DecodedCluster decoded, std::uint64_t now);
  [[nodiscard]] std::unique_ptr<Group> make_group(const Family& family) const;
  void forget_voxels(std::uint32_t node);
  void forget_group(std::size_t group);

  LodChunks& chunks_;
  LodTree& tree_;  // of chunks_
  const StreamHeader& header_;  // of chunks_
  std::size_t most_bytes_, bytes_ = 0, disc_count_ = 0;
  std::vector<std::unique_ptr<Entry>> entries_;  // one entry per node
  std::vector<std::unique_ptr<Group>> groups_;
  std::uint64_t groups_made_ = 0;
};

}  // namespace gs::qnv
