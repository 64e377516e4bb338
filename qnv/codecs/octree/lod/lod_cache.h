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

/// Decoded cluster that is not added to the tree yet.
struct DecodedCluster {
  std::unique_ptr<Cluster> cluster;  // nullptr if decoding failed; `problem` is then the reason
  std::string problem;
  NormalCone cone;
  std::uint32_t discs = 0, replaced = 0;  // number of its splats, and of the parent's splats that these replace
};

/// Decoded data of a stream's clusters: voxels, which children need, and splats, which are drawn. Clusters of one
/// parent with splats made at the same time share arrays, which keeps the number of arrays low. Call from one
/// thread; it uses others internally.
class LodCache {
 public:
  /// `tree` and `header` belong to the stream and must outlive this object. If `keep_voxels`, also keeps the voxels of
  /// clusters without known children, because children may be received later.
  LodCache(LodTree& tree, const StreamHeader& header, std::size_t most_bytes, bool keep_voxels)
      : tree_(tree), header_(header), most_bytes_(most_bytes), keep_voxels_(keep_voxels) {}

  void set_most_bytes(std::size_t most_bytes) { most_bytes_ = most_bytes; }

  /// Problems of the stream with their byte offsets.
  using Problems = std::vector<StreamProblem>;

  [[nodiscard]] bool has_voxels(std::uint32_t node) const { return entry(node) && entry(node)->voxels; }
  [[nodiscard]] bool has_discs(std::uint32_t node) const { return entry(node) && entry(node)->discs; }
  [[nodiscard]] bool has(std::uint32_t node) const { return has_voxels(node) || has_discs(node); }

  /// Decodes the voxels of the clusters `nodes`. The parent of each cluster must be decoded already or be in `nodes`.
  /// Marks invalid clusters, and clusters that do not match their description, as broken.
  void decode(const ChunkSource& source, std::vector<std::uint32_t> nodes, std::uint64_t now, Problems& problems);
  /// Decodes one cluster without storing it. `parent` is the decoded parent, or nullptr for the root. Pure function.
  [[nodiscard]] DecodedCluster decode_one(const ChunkSource& source, std::uint32_t node, const Cluster* parent) const;
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
  [[nodiscard]] Box box_of_run(const PackedVoxels& voxels, int level, std::size_t first, std::size_t count) const;
  [[nodiscard]] std::unique_ptr<Group> make_group(const Family& family) const;
  void forget_voxels(std::uint32_t node);
  void forget_group(std::size_t group);

  LodTree& tree_;
  const StreamHeader& header_;
  std::size_t most_bytes_, bytes_ = 0, disc_count_ = 0;
  bool keep_voxels_;
  std::vector<std::unique_ptr<Entry>> entries_;  // one entry per node
  std::vector<std::unique_ptr<Group>> groups_;
  std::uint64_t groups_made_ = 0;
};

}  // namespace gs::qnv
