#pragma once

#include "qnv/lod/lod_source.h"
#include "qnv/lod/lod_tree.h"
#include "qnv/packed/packed.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {

/// What decoding one cluster gave, before it is a part of the tree.
struct DecodedCluster {
  std::unique_ptr<Cluster> cluster;  // none: the problem says why
  std::string problem;
  NormalCone cone;
  std::uint32_t discs = 0, replaced = 0;  // its own; of its parent, in whose place they are
};

/// What of a stream's clusters is decoded: voxels, which their children need, and discs, which are drawn. Clusters
/// with one parent whose discs are made at the same time share a cloud, so that there are few. One thread, which makes
/// others work for it.
class LodCache {
 public:
  /// `tree` and `header` are the stream's own. `keep_voxels`: also of clusters without children, which may come yet.
  LodCache(LodTree& tree, const StreamHeader& header, std::size_t most_bytes, bool keep_voxels)
      : tree_(tree), header_(header), most_bytes_(most_bytes), keep_voxels_(keep_voxels) {}

  void set_most_bytes(std::size_t most_bytes) { most_bytes_ = most_bytes; }

  /// A place in a stream's bytes and what is wrong there.
  using Problems = std::vector<StreamProblem>;

  [[nodiscard]] bool has_voxels(std::uint32_t node) const { return entry(node) && entry(node)->voxels; }
  [[nodiscard]] bool has_discs(std::uint32_t node) const { return entry(node) && entry(node)->discs; }
  [[nodiscard]] bool has(std::uint32_t node) const { return has_voxels(node) || has_discs(node); }

  /// Decodes the voxels of clusters, each of whose parents has its own or is among them. What cannot be decoded, or is
  /// not what it was said to be, becomes broken.
  void decode(const ChunkSource& source, std::vector<std::uint32_t> nodes, std::uint64_t now, Problems& problems);
  /// Decodes one, keeping nothing. `parent`: its parent's; null for the one without. Pure.
  [[nodiscard]] DecodedCluster decode_one(const ChunkSource& source, std::uint32_t node, const Cluster* parent) const;
  /// A box for a cluster that has none of its own, from the voxels of its parent if they are there.
  void find_box(std::uint32_t node);
  /// Makes the discs of clusters that have voxels.
  void make_discs(std::vector<std::uint32_t> nodes, std::uint64_t now);

  /// Discs that some voxels of a cluster are, in the cloud that they lie in.
  struct Discs {
    std::uint64_t order = 0;  // of its cloud among all
    std::shared_ptr<const Cloud> cloud;
    std::size_t first = 0, last = 0;
  };
  /// `node` must have discs.
  [[nodiscard]] Discs discs(std::uint32_t node, std::size_t first_voxel, std::size_t last_voxel) const;

  /// Needed now.
  void use_voxels(std::uint32_t node, std::uint64_t now);
  void use_discs(std::uint32_t node, std::uint64_t now);
  /// Needed by the last cut of a viewport: discs that it shows, or whatever there is of a cluster of which it does not.
  void pin_discs(std::uint32_t node, std::uint64_t now);
  void pin(std::uint32_t node, std::uint64_t now);
  /// Forgets what was not used for longest, as far as there is too much, but nothing that was pinned now.
  void shrink(std::uint64_t now);

  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t disc_count() const { return disc_count_; }

 private:
  struct Group {
    std::shared_ptr<const Cloud> cloud;
    std::vector<std::uint32_t> members;
    std::uint64_t order = 0, used = 0, pinned = 0;
    std::size_t bytes = 0;
  };
  struct Entry {
    std::unique_ptr<Cluster> voxels;
    std::vector<bool> divided;           // of the voxels, by children that are known
    std::uint64_t used = 0, pinned = 0;  // the voxels
    Group* discs = nullptr;              // where they lie
    std::size_t first_disc = 0;          // there
    std::vector<std::uint32_t> disc_of;  // of every voxel, and one more; empty when each has one disc
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
