#include "qnv/codecs/gaussians/lod/splat_tree.h"

#include <algorithm>

namespace gs::qnv::gaussians {
namespace {

constexpr std::uint32_t kTypicalBytes = 8;  // of a Gaussian
// Maximum number of chunks of harmonics of a cluster. Encoders need fewer, because they fill most chunks.
constexpr std::uint16_t kMostHarmonics = 1024;
// Maximum number of chunks of harmonics that wait for their clusters, and maximum number of clusters.
constexpr std::size_t kMostWaiting = std::size_t{1} << 16, kMostClusters = std::size_t{1} << 22;

}  // namespace

std::uint32_t SplatTree::make(std::uint32_t id) {
  const auto [found, fresh] = indices_.try_emplace(id, static_cast<std::uint32_t>(clusters_.size()));
  if (!fresh) return found->second;
  clusters_.emplace_back().id = id;
  return found->second;
}

void SplatTree::describe(std::uint32_t index, std::uint64_t offset, std::uint32_t bytes, std::uint8_t level,
                         std::uint32_t parent_id) {
  SplatCluster& cluster = clusters_[index];
  cluster.offset = offset;
  cluster.bytes = bytes;
  cluster.level = level;
  link(index, parent_id);
  const auto [first, last] = orphans_.equal_range(cluster.id);
  std::vector<std::uint32_t> children;
  for (auto orphan = first; orphan != last; ++orphan) children.push_back(orphan->second);
  orphans_.erase(first, last);
  std::ranges::sort(children);
  for (const std::uint32_t child : children) attach(child, index);
  const auto [first_chunk, last_chunk] = waiting_.equal_range(cluster.id);
  for (auto chunk = first_chunk; chunk != last_chunk; ++chunk) (void)add_harmonics(index, chunk->second);
  waiting_.erase(first_chunk, last_chunk);
}

std::uint32_t SplatTree::find(std::uint32_t id) const {
  const auto found = indices_.find(id);
  return found == indices_.end() ? kNoCluster : found->second;
}

void SplatTree::link(std::uint32_t cluster, std::uint32_t parent_id) {
  if (parent_id == ClusterHead::kNoParent) {
    if (root_ == kNoCluster) root_ = cluster;
    if (root_ != cluster) clusters_[cluster].broken = true;
  } else if (const auto parent = indices_.find(parent_id);
             parent != indices_.end() && clusters_[parent->second].bytes != 0) {
    attach(cluster, parent->second);
  } else {
    orphans_.emplace(parent_id, cluster);
  }
}

void SplatTree::attach(std::uint32_t cluster, std::uint32_t parent) {
  // Levels that rise by one exclude cycles. Each child replaces other Gaussians, so there cannot be more children.
  if (clusters_[cluster].level != clusters_[parent].level + 1 || clusters_[parent].children == kMostNodes) {
    clusters_[cluster].broken = true;
    return;
  }
  ++clusters_[parent].children;
  clusters_[cluster].parent = parent;
  clusters_[cluster].next_sibling = clusters_[parent].first_child;
  clusters_[parent].first_child = cluster;
  if (clusters_[cluster].boxed) add_box(parent, clusters_[cluster].box);
}

void SplatTree::add_box(std::uint32_t cluster, const Box& box) {
  if (box.empty()) return;
  for (std::uint32_t i = cluster; i != kNoCluster; i = clusters_[i].parent) {
    SplatCluster& one = clusters_[i];
    if (i != cluster && !one.boxed) continue;
    const Box before = one.box;
    one.box.add(box.lower);
    one.box.add(box.upper);
    const bool same = one.boxed && before.lower == one.box.lower && before.upper == one.box.upper;
    one.boxed = true;
    if (same) return;
  }
}

std::size_t SplatTree::add_directory(std::span<const DirectoryEntry> entries, std::uint64_t stream_bytes,
                                     bool all_present) {
  std::size_t invalid = 0;
  std::uint32_t next = 0;  // identifier of the next cluster
  for (const DirectoryEntry& entry : entries) {
    const bool fits = entry.bytes > kChunkHeaderBytes && entry.bytes <= kChunkHeaderBytes + kMostClusterBytes &&
                      entry.offset <= stream_bytes && entry.bytes <= stream_bytes - entry.offset;
    if (entry.vectors == 0) {
      const auto cluster = indices_.find(entry.parent);
      if (!fits || cluster == indices_.end() ||
          !add_harmonics(cluster->second, {entry.offset, entry.bytes, kNoCluster, all_present}))
        ++invalid;
      continue;
    }
    const std::uint32_t id = next++;
    if (!fits || entry.vectors > kMostNodes || entry.level == 255) {
      ++invalid;
      continue;
    }
    const std::uint32_t index = make(id);
    if (clusters_[index].bytes == 0) describe(index, entry.offset, entry.bytes, entry.level, entry.parent);
    SplatCluster& cluster = clusters_[index];
    if (!cluster.known) cluster.splats = entry.vectors;
    if (all_present && !cluster.present) ++present_;
    cluster.present = cluster.present || all_present;
    add_box(index, entry.box);
  }
  return invalid;
}

// Returns false if the cluster has too many chunks.
bool SplatTree::add_harmonics(std::uint32_t cluster, const HarmonicsChunk& chunk) {
  std::uint32_t* place = &clusters_[cluster].harmonics;
  for (; *place != kNoCluster; place = &harmonics_[*place].next)
    if (harmonics_[*place].offset == chunk.offset) {
      harmonics_[*place].present = harmonics_[*place].present || chunk.present;
      return true;
    }
  if (clusters_[cluster].own_harmonics == kMostHarmonics) return false;
  ++clusters_[cluster].own_harmonics;
  *place = static_cast<std::uint32_t>(harmonics_.size());
  harmonics_.push_back(chunk);
  return true;
}

bool SplatTree::note_head(std::uint32_t index, const ClusterHead& head) {
  SplatCluster& cluster = clusters_[index];
  const bool is_root = head.parent == ClusterHead::kNoParent;
  const bool fits = head.id == cluster.id && head.level == cluster.level &&
                    (is_root ? cluster.parent == kNoCluster
                             : cluster.parent != kNoCluster && clusters_[cluster.parent].id == head.parent);
  if (!fits) {
    cluster.broken = true;
    return false;
  }
  cluster.first = static_cast<std::uint16_t>(head.first);
  cluster.count = static_cast<std::uint16_t>(head.count);
  return true;
}

std::uint32_t SplatTree::arrive(const ClusterHead& head, std::uint64_t offset, std::uint32_t bytes, std::string& why) {
  if (head.level >= 255) {
    why = "a cluster has level " + std::to_string(head.level) + "; expected less than 255";
    return kNoCluster;
  }
  if (clusters_.size() == kMostClusters && find(head.id) == kNoCluster) {
    why = "a stream has more than " + std::to_string(kMostClusters) + " clusters";
    return kNoCluster;
  }
  const std::uint32_t index = make(head.id);
  if (clusters_[index].present) return index;
  if (clusters_[index].bytes == 0) {  // not in a directory
    describe(index, offset, bytes, static_cast<std::uint8_t>(head.level), head.parent);
    clusters_[index].splats = bytes / kTypicalBytes;
    clusters_[index].first = static_cast<std::uint16_t>(head.first);
    clusters_[index].count = static_cast<std::uint16_t>(head.count);
  } else if (!note_head(index, head)) {
    why = "a cluster contradicts the directory";
    return kNoCluster;
  }
  SplatCluster& cluster = clusters_[index];
  if (cluster.broken) {
    why = "a cluster contradicts its parent";
    return kNoCluster;
  }
  cluster.offset = offset;
  cluster.bytes = bytes;
  cluster.present = true;
  cluster.arrival = static_cast<std::uint32_t>(present_++);
  return index;
}

bool SplatTree::arrive(const HarmonicsHead& head, std::uint64_t offset, std::uint32_t bytes, std::string& why) {
  const HarmonicsChunk chunk{offset, bytes, kNoCluster, true};
  const std::uint32_t index = find(head.cluster);
  if (index == kNoCluster) {
    if (waiting_.size() == kMostWaiting) {
      why = "a chunk of harmonics is left out, because too many wait for their clusters";
      return false;
    }
    waiting_.emplace(head.cluster, chunk);
    return true;
  }
  for (std::uint32_t i = clusters_[index].harmonics; i != kNoCluster; i = harmonics_[i].next)
    if (harmonics_[i].offset == offset && harmonics_[i].present) return false;
  return add_harmonics(index, chunk);
}

}  // namespace gs::qnv::gaussians
