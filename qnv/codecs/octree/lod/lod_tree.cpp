#include "qnv/codecs/octree/lod/lod_tree.h"

#include "qnv/codecs/octree/packed_layout.h"

#include <algorithm>
#include <utility>

namespace gs::qnv {
namespace {

// Maximum number of clusters. More clusters would mean billions of vectors.
constexpr std::size_t kMaxNodes = std::size_t{1} << 22;

std::uint32_t possible_voxels(std::uint64_t claimed, std::uint32_t bytes) {
  const std::uint64_t most = std::min<std::uint64_t>(kMaxVoxels, std::uint64_t{kVoxelsPerByte} * bytes);
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(claimed, 1, std::max<std::uint64_t>(most, 1)));
}

bool possible(const DirectoryEntry& entry) {
  return entry.bytes >= kChunkHeaderBytes + kClusterHeaderSize && entry.level >= 1 && entry.level <= kDeepestLevel &&
         entry.offset <= ~std::uint64_t{0} - entry.bytes && !entry.box.empty();
}

void describe(const DirectoryEntry& entry, LodNode& node) {
  node.offset = entry.offset;
  node.bytes = entry.bytes;
  node.level = entry.level;
  node.voxels = possible_voxels(entry.vectors, entry.bytes);
  node.box = entry.box;
  node.boxed = node.claimed = true;
}

}  // namespace

std::size_t LodTree::set_directory(std::span<const DirectoryEntry> entries, std::uint64_t stream_bytes) {
  entries = entries.first(std::min(entries.size(), kMaxNodes));
  dense_ = true;
  nodes_.assign(entries.size(), {});
  std::size_t senseless = 0;
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    LodNode& node = nodes_[i];
    describe(entries[i], node);
    node.arrival = i;
    node.broken = !possible(entries[i]) || entries[i].offset + entries[i].bytes > stream_bytes;
    node.present = !node.broken;
    if (!node.broken && entries[i].parent == kNoParent && root_ == kNoNode) root_ = i;
  }
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    const std::uint32_t parent = entries[i].parent;
    LodNode& node = nodes_[i];
    // Requires a higher level than the parent's, which excludes cycles.
    if (parent < nodes_.size() && !node.broken && nodes_[parent].level < node.level)
      attach(i, parent);
    else
      node.broken = node.broken || i != root_;
    senseless += node.broken ? 1 : 0;
  }
  present_ = nodes_.size() - senseless;
  return senseless;
}

std::size_t LodTree::expect(std::span<const DirectoryEntry> entries) {
  entries = entries.first(std::min(entries.size(), kMaxNodes));
  std::size_t senseless = 0;
  for (std::uint32_t id = 0; id < entries.size(); ++id) {
    const DirectoryEntry& entry = entries[id];
    std::uint32_t index = index_of(id);
    const bool fits = index == kNoNode || (nodes_[index].offset == entry.offset && nodes_[index].bytes == entry.bytes &&
                                           nodes_[index].level == entry.level);
    if (!possible(entry) || !fits || (index == kNoNode && nodes_.size() >= kMaxNodes)) {
      ++senseless;
      continue;
    }
    if (index == kNoNode) {
      index = make(id);
      describe(entry, nodes_[index]);
      link(index, id, entry.parent);
    } else if (!nodes_[index].known) {
      describe(entry, nodes_[index]);
    }
  }
  return senseless;
}

std::uint32_t LodTree::arrive(const ClusterHeader& header, std::uint64_t offset, std::uint32_t bytes,
                              std::string& why) {
  std::uint32_t index = index_of(header.id);
  if (index != kNoNode) {
    LodNode& node = nodes_[index];
    if (node.present || node.offset != offset || node.bytes != bytes) {
      why = "two clusters have the same number; the first one is used";
      return kNoNode;
    }
    why = misfit(index, header);
    if (!why.empty()) {
      node.broken = true;
      return kNoNode;
    }
  } else {
    if (nodes_.size() >= kMaxNodes) {
      why = "more clusters than " + std::to_string(kMaxNodes);
      return kNoNode;
    }
    if (header.parent == kNoParent && root_ != kNoNode) {
      why = "a second cluster without a parent";
      return kNoNode;
    }
    index = make(header.id);
    nodes_[index].offset = offset;
    nodes_[index].bytes = bytes;
    nodes_[index].level = static_cast<std::uint8_t>(header.level + header.levels);
    nodes_[index].voxels = possible_voxels(std::uint64_t{header.count} * kTypicalChildren, bytes);
    link(index, header.id, header.parent);
  }
  LodNode& node = nodes_[index];
  node.first = header.first;
  node.count = header.count;
  node.present = true;
  node.arrival = static_cast<std::uint32_t>(present_++);
  return index;
}

std::string LodTree::misfit(std::uint32_t index, const ClusterHeader& header) const {
  const LodNode& node = nodes_[index];
  const bool top = node.parent == kNoNode;
  if (index_of(header.id) != index) return "the number of a cluster differs from the directory";
  if (top ? header.parent != kNoParent : header.parent == kNoParent || index_of(header.parent) != node.parent)
    return "the parent of a cluster differs from the directory";
  if (header.level + header.levels != node.level || (!top && header.level != nodes_[node.parent].level))
    return "the level of a cluster differs from the directory";
  return {};
}

void LodTree::settle(std::uint32_t index, const ClusterFacts& facts) {
  LodNode& node = nodes_[index];
  node.known = true;
  node.first = facts.first;
  node.count = facts.count;
  node.voxels = facts.voxels;
  node.discs = facts.discs;
  node.replaced = facts.replaced;
  node.cone = facts.cone;
}

void LodTree::set_box(std::uint32_t index, const Box& box, bool exact) {
  nodes_[index].box = box;
  nodes_[index].boxed = nodes_[index].boxed || exact;
}

float LodTree::age(std::uint32_t node) const {
  const std::size_t last = dense_ ? nodes_.size() : present_;
  return last < 2 ? 0 : static_cast<float>(nodes_[node].arrival) / static_cast<float>(last - 1);
}

std::uint32_t LodTree::make(std::uint32_t id) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  indices_.emplace(id, index);
  return index;
}

// Links a node to its parent, if the parent is known, and to children that waited for this node.
void LodTree::link(std::uint32_t index, std::uint32_t id, std::uint32_t parent_id) {
  if (parent_id == kNoParent) {
    if (root_ == kNoNode)
      root_ = index;
    else
      nodes_[index].broken = true;
  } else if (const std::uint32_t parent = index_of(parent_id); parent != kNoNode) {
    attach(index, parent);
  } else {
    orphans_.emplace(parent_id, index);
  }
  const auto [first, last] = orphans_.equal_range(id);
  for (auto orphan = first; orphan != last; ++orphan) attach(orphan->second, index);
  orphans_.erase(first, last);
}

void LodTree::attach(std::uint32_t index, std::uint32_t parent) {
  LodNode& node = nodes_[index];
  if (nodes_[parent].level >= node.level) {
    node.broken = true;
    return;
  }
  node.parent = parent;
  node.next_sibling = nodes_[parent].first_child;
  nodes_[parent].first_child = index;
}

std::uint32_t LodTree::index_of(std::uint32_t id) const {
  if (dense_) return id < nodes_.size() ? id : kNoNode;
  const auto found = indices_.find(id);
  return found == indices_.end() ? kNoNode : found->second;
}

}  // namespace gs::qnv
