#pragma once

#include "qnv/codecs/octree/packed.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <queue>
#include <utility>
#include <vector>

namespace gs::qnv {

// Division of octree levels into clusters, and the order of these clusters in the stream. A Node has `encoded`
// (EncodedCluster), `gain` and `children` (unique_ptr to Nodes).

// Maximum size of a cluster, in bytes. With stream, UDP and IP framing, it fits into the IPv6 minimum MTU of 1,280
// bytes.
constexpr std::size_t kClusterBytes = 1200;
// Maximum number of voxels that a cluster divides. The limit keeps clusters small even on smooth surfaces, so that a
// view can add or drop a cluster in a single step.
constexpr std::size_t kMaxParents = 850;

/// Divides all `size` voxels of a node into clusters that fit into a datagram. `divide(first, count)` must encode a run
/// of voxels.
template <class Node, class Divide>
void divide_in_runs(Node& node, std::size_t size, Divide&& divide) {
  std::size_t run = std::min<std::size_t>(size, 400);
  for (std::size_t first = 0; first < size;) {
    // Divides the remaining voxels evenly, so that the runs have similar lengths.
    const std::size_t left = size - first, parts = (left + run - 1) / run;
    std::size_t count = (left + parts - 1) / parts;
    auto child = divide(first, count);
    while (child->encoded.payload.size() > kClusterBytes && count > 1) {
      const double fit = static_cast<double>(kClusterBytes) / static_cast<double>(child->encoded.payload.size());
      count = std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(count) * fit * 0.97));
      child = divide(first, count);
    }
    const double bytes_a_parent = static_cast<double>(child->encoded.payload.size()) / static_cast<double>(count);
    run = std::clamp<std::size_t>(static_cast<std::size_t>(kClusterBytes * 0.97 / bytes_a_parent), 1, kMaxParents);
    first += count;
    node.children.push_back(std::move(child));
  }
}

/// Returns the clusters in the order of sending. A parent precedes its children. Among the clusters with a sent parent,
/// the cluster with the largest gain per byte is next. Stops after `vectors` vectors, or before `max_bytes` would be
/// exceeded (0 means unlimited).
template <class Node>
std::vector<EncodedCluster> in_order(std::unique_ptr<Node> base, std::size_t vectors, std::size_t max_bytes) {
  struct Entry {
    double worth;
    std::uint64_t order;  // on equal gain, the cluster created first is next
    Node* node;
    std::uint32_t parent;
    bool operator<(const Entry& other) const {
      return worth != other.worth ? worth < other.worth : order > other.order;
    }
  };
  std::priority_queue<Entry> ready;
  std::uint64_t made = 0;
  ready.push({0, made++, base.get(), kNoParent});
  std::vector<EncodedCluster> out;
  std::size_t discs = 0, bytes = 0;
  while (!ready.empty()) {
    const Entry entry = ready.top();
    ready.pop();
    Node& node = *entry.node;
    bytes += node.encoded.payload.size();
    if (max_bytes != 0 && bytes > max_bytes && !out.empty()) break;
    const auto id = static_cast<std::uint32_t>(out.size());
    node.encoded.header.id = id;
    node.encoded.header.parent = entry.parent;
    for (std::size_t i = 0; i < 4; ++i) {
      node.encoded.payload[i] = static_cast<std::byte>(id >> (8 * i) & 255);
      node.encoded.payload[4 + i] = static_cast<std::byte>(entry.parent >> (8 * i) & 255);
    }
    for (const auto& child : node.children)
      ready.push({child->gain / static_cast<double>(child->encoded.payload.size()), made++, child.get(), id});
    // A cluster replaces the voxels that it divides.
    discs += node.encoded.voxels - node.encoded.divided;
    out.push_back(std::move(node.encoded));
    if (vectors != 0 && discs >= vectors) break;
  }
  return out;
}

}  // namespace gs::qnv
