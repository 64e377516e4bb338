#pragma once

#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/shared/decoder.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Received clusters of an octree. Clusters may be received in any order; each waits for its parent. `Cluster` must
/// have a header (ClusterHeader), a member `voxels` with size(), and level(). One thread at a time. Safe for untrusted
/// bytes.
template <class Cluster>
class ClusterForest {
 public:
  struct Held {
    Cluster cluster;
    std::vector<bool> refined;  // one flag per voxel: its children were received
  };
  /// Functions that depend on the payload.
  struct Codec {
    std::variant<ClusterHeader, PackedError> (*read_header)(std::span<const std::byte> payload);
    /// Returns the number of vectors of voxels `first` to `first + count` - 1.
    std::uint32_t (*vectors_of)(const Cluster& cluster, std::size_t first, std::size_t count);
  };

  explicit ClusterForest(const Codec& codec) : codec_(codec) {}

  /// Adds a cluster. `decode(payload, parent)` must return the cluster or an error. Rejects it if more than
  /// `most_vectors` vectors would be visible.
  template <class Decode>
  void add(std::span<const std::byte> payload, std::size_t most_vectors, const Decode& decode) {
    const auto read = codec_.read_header(payload);
    const auto* header = std::get_if<ClusterHeader>(&read);
    if (!header || clusters_.contains(header->id)) {
      ++count_.refused;
      return;
    }
    Held* parent = nullptr;
    if (header->parent != kNoParent) {
      const auto found = clusters_.find(header->parent);
      if (found == clusters_.end()) return wait(*header, payload);
      parent = &found->second;
    }
    auto decoded = decode(payload, parent ? &parent->cluster : nullptr);
    auto* cluster = std::get_if<Cluster>(&decoded);
    // Rejects a second division of a voxel, and a second root.
    bool again = !parent && rooted_;
    for (std::size_t i = 0; cluster && parent && i < cluster->header.count; ++i)
      again = again || parent->refined[cluster->header.first + i];
    if (!cluster || again) {
      ++count_.refused;
      return;
    }
    // Keeps refined voxels in memory, because other clusters may refine the rest of the same cluster.
    const std::size_t voxels = cluster->voxels.size();
    if (vectors_ + codec_.vectors_of(*cluster, 0, voxels) > most_vectors || (voxels_ + voxels) / 2 > most_vectors) {
      count_.full = true;
      ++count_.refused;
      return;
    }
    const std::uint32_t id = header->id;
    take(std::move(*cluster), parent);
    // Decodes the clusters that waited for this one.
    std::vector<std::vector<std::byte>> ready;
    const auto [first, last] = orphans_.equal_range(id);
    for (auto i = first; i != last; ++i) {
      waiting_bytes_ -= cost(i->second);
      ready.push_back(std::move(i->second));
    }
    orphans_.erase(first, last);
    for (const auto& early : ready) add(early, most_vectors, decode);
  }

  [[nodiscard]] const DecodeCount& count() const { return count_; }
  /// Returns the number of visible vectors.
  [[nodiscard]] std::size_t vectors() const { return vectors_; }

  /// Calls visit(cluster, first, count) for each run of voxels that has no finer voxels.
  template <class Visit>
  void visit_shown(Visit&& visit) const {
    for (const auto& [id, held] : clusters_) {
      const std::size_t size = held.refined.size();
      for (std::size_t i = 0; i < size;) {
        std::size_t end = i;
        while (end < size && held.refined[end] == held.refined[i]) ++end;
        if (!held.refined[i]) visit(held.cluster, i, end - i);
        i = end;
      }
    }
  }

 private:
  // Limit in bytes of the chunks that wait for a parent, which may never be received.
  static constexpr std::size_t kMaxWaitingBytes = std::size_t{64} << 20;
  /// Returns the approximate memory of a waiting chunk, in bytes.
  static std::size_t cost(std::span<const std::byte> payload) { return payload.size() + 128; }

  void wait(const ClusterHeader& header, std::span<const std::byte> payload) {
    if (waiting_bytes_ + cost(payload) > kMaxWaitingBytes) {
      ++count_.refused;
      return;
    }
    waiting_bytes_ += cost(payload);
    orphans_.emplace(header.parent, std::vector<std::byte>(payload.begin(), payload.end()));
  }

  void take(Cluster cluster, Held* parent) {
    const ClusterHeader header = cluster.header;
    if (parent) {
      vectors_ -= codec_.vectors_of(parent->cluster, header.first, header.count);
      std::fill_n(parent->refined.begin() + header.first, header.count, true);
    } else {
      rooted_ = true;
    }
    const std::size_t voxels = cluster.voxels.size();
    vectors_ += codec_.vectors_of(cluster, 0, voxels);
    voxels_ += voxels;
    ++count_.taken;
    Held& held = clusters_[header.id];
    held.refined.resize(voxels);
    held.cluster = std::move(cluster);
  }

  Codec codec_;
  DecodeCount count_;
  std::size_t vectors_ = 0, waiting_bytes_ = 0;
  std::size_t voxels_ = 0;  // voxels of all clusters, including refined voxels
  bool rooted_ = false;     // the cluster without a parent was received
  std::map<std::uint32_t, Held> clusters_;
  std::multimap<std::uint32_t, std::vector<std::byte>> orphans_;  // payloads by the identifier of the missing parent
};

}  // namespace gs::qnv
