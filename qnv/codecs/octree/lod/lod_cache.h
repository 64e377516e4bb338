#pragma once

#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/octree/lod/lod_tree.h"
#include "qnv/codecs/octree/packed.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Result of decoding one cluster, before it is added to the tree.
struct DecodedCluster {
  std::unique_ptr<Cluster> cluster;  // nullptr on failure; see `problem`
  std::string problem;
  NormalCone cone;
  std::uint32_t discs = 0, replaced = 0;  // its own splats; those of its parent that they replace
};

/// Decoded data of a stream's clusters: voxels, which children need, and splats, which are drawn. Clusters of one
/// parent with splats made at the same time share arrays, which keeps the number of arrays low. Call from one
/// thread; it uses others internally.
class LodCache {
 public:
  /// `tree` and `header` belong to the stream. `keep_voxels` keeps even the voxels of clusters without known children.
  LodCache(LodTree& tree, const StreamHeader& header, std::size_t most_bytes, bool keep_voxels)
      : tree_(tree), header_(header), most_bytes_(most_bytes), keep_voxels_(keep_voxels) {}

  void set_most_bytes(std::size_t most_bytes) { most_bytes_ = most_bytes; }

  /// Problems with their byte offsets.
  using Problems = std::vector<StreamProblem>;

  [[nodiscard]] bool has_voxels(std::uint32_t node) const { return entry(node) && entry(node)->voxels; }
  [[nodiscard]] bool has_discs(std::uint32_t node) const { return entry(node) && entry(node)->discs; }
  [[nodiscard]] bool has(std::uint32_t node) const { return has_voxels(node) || has_discs(node); }

  /// Decodes the voxels of clusters. Every parent must be decoded or in `nodes`. Marks clusters as broken if they are
  /// invalid or do not match their description.
  void decode(const ChunkSource& source, std::vector<std::uint32_t> nodes, std::uint64_t now, Problems& problems);
  /// Decodes one cluster without storing it. `parent` is its parent's, or nullptr for the root. Pure.
  [[nodiscard]] DecodedCluster decode_one(const ChunkSource& source, std::uint32_t node, const Cluster* parent) const;
  /// Computes a box for a cluster without one, from its parent's voxels if available.
  void find_box(std::uint32_t node);
  /// Makes the splats of clusters that have voxels.
  void make_discs(std::vector<std::uint32_t> nodes, std::uint64_t now);

  /// Splats of some voxels of a cluster, in their shared arrays.
  struct Discs {
    std::uint64_t order = 0;  // sequence number of the arrays
    std::shared_ptr<const Splats> splats;
    std::size_t first = 0, last = 0;
  };
  /// Returns splats of a node. `node` must have splats.
  [[nodiscard]] Discs discs(std::uint32_t node, std::size_t first_voxel, std::size_t last_voxel) const;

  /// Mark data as used now.
  void use_voxels(std::uint32_t node, std::uint64_t now);
  void use_discs(std::uint32_t node, std::uint64_t now);
  /// Pin data that a viewport's last cut needs. `pin_discs` pins splats that it shows, `pin` the data of a cluster that
  /// the cut needs but does not show.
  void pin_discs(std::uint32_t node, std::uint64_t now);
  void pin(std::uint32_t node, std::uint64_t now);
  /// Frees the least recently used data until the limit holds, except data pinned now.
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
    std::vector<bool> divided;           // voxels divided by known children
    std::uint64_t used = 0, pinned = 0;  // of the voxels
    Group* discs = nullptr;              // group that holds the splats
    std::size_t first_disc = 0;          // in the group
    std::vector<std::uint32_t> disc_of;  // first splat of every voxel, and one more; empty if each has one splat
  };
  struct Family;

  [[nodiscard]] const Entry* entry(std::uint32_t node) const {
    return node < entries_.size() ? entries_[node].get() : nullptr;
  }
  Entry& made_entry(std::uint32_t node);
  [[nodiscard]] std::string take(std::uint32_t node, DecodedCluster decoded, std::uint64_t now);
  [[nodiscard]] Box box_of_run(const PackedVoxels& voxels, int level, std::size_t first, std::size_t count) const;
  [[nodiscard]] std::unique_ptr<Group> make_group(const Family& family) const;
  void forget_voxels(std::uint32_t node);
  void forget_group(std::size_t group);

  LodTree& tree_;
  const StreamHeader& header_;
  std::size_t most_bytes_, bytes_ = 0, disc_count_ = 0;
  bool keep_voxels_;
  std::vector<std::unique_ptr<Entry>> entries_;  // by node
  std::vector<std::unique_ptr<Group>> groups_;
  std::uint64_t groups_made_ = 0;
};

}  // namespace gs::qnv
