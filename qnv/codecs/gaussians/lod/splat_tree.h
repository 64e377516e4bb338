#pragma once

#include "base/box.h"
#include "qnv/codecs/gaussians/splat_cluster.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::qnv::gaussians {

inline constexpr std::uint32_t kNoCluster = 0xffffffff;

/// Chunk with harmonics of a cluster.
struct HarmonicsChunk {
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0;          // with the chunk header
  std::uint32_t next = kNoCluster;  // next chunk of the same cluster
  bool present = false;
};

/// State of a cluster in the cuts of the viewports.
struct SplatMarks {
  std::uint16_t chosen_by = 0;  // one bit per viewport: the viewport's last cut contains the cluster
  bool ready = false;           // in the current cut: is decoded, or will be
  bool visible = false;         // in the current cut: its Gaussians may be visible
  float presence = 0;           // in the current cut: product of the weights of this cluster and its ancestors
  float weight = 0;             // in the current cut: 1 if its Gaussians replace those of the parent completely
};

/// Description of one cluster, which exists before the cluster is decoded.
struct SplatCluster {
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0;  // with the chunk header; 0 until the cluster is described
  std::uint32_t parent = kNoCluster, first_child = kNoCluster, next_sibling = kNoCluster;
  std::uint32_t harmonics = kNoCluster;  // its first chunk of harmonics
  std::uint32_t id = 0;
  std::uint32_t splats = 0;                          // number of Gaussians; claimed or estimated until decoded
  std::uint32_t arrival = 0;                         // serial number of reception
  std::uint16_t first = 0, count = 0;                // covered Gaussians of the parent; count 0 until the head is read
  std::uint16_t children = 0, own_harmonics = 0;     // number of its children, and of its chunks of harmonics
  std::uint16_t replaced_from = 0, replaced_to = 0;  // its range of the parent's inner Gaussians; set if `sized`
  std::uint8_t level = 0;
  bool present = false;                   // its chunk is received
  bool known = false;                     // it was decoded and is valid
  bool broken = false;                    // neither it nor its descendants can be drawn
  bool waits = false;                     // it is damaged, and a running repair may restore it
  bool boxed = false;                     // `box` is known
  bool sized = false;                     // `size` and `reach` are known
  float size = 0;                         // largest deviation of the replaced Gaussians, times the root of the opacity
  float reach = 0;                        // their largest deviation
  float inner_size = 0, inner_reach = 0;  // maxima for its own inner Gaussians, after decoding
  SplatMarks marks;
  Box box;  // bounds of its Gaussians and of those of its descendants
};

/// Tree of the clusters of a stream, from its directory or its chunks. Indices of clusters never change. All input is
/// untrusted: rejects contradictions, or marks clusters as `broken`. One thread at a time.
class SplatTree {
 public:
  /// Adds the directory of a stream. `all_present` means that all chunks can be read. Cluster entries have the
  /// identifiers 0, 1, 2, ... in order. Returns the number of invalid entries.
  std::size_t add_directory(std::span<const DirectoryEntry> entries, std::uint64_t stream_bytes, bool all_present);
  /// Adds the cluster of a received chunk. Returns its index, or kNoCluster if it contradicts others; `why` then has
  /// the reason.
  std::uint32_t arrive(const ClusterHead& head, std::uint64_t offset, std::uint32_t bytes, std::string& why);
  /// Adds a received chunk of harmonics. It may precede its cluster. Returns false if it was received before, or if the
  /// cluster has too many. Also returns false if too many chunks wait for unknown clusters; `why` then has the reason.
  bool arrive(const HarmonicsHead& head, std::uint64_t offset, std::uint32_t bytes, std::string& why);
  /// Notes the head of a cluster. Returns false and marks it as broken if the head contradicts the directory.
  bool note_head(std::uint32_t cluster, const ClusterHead& head);

  [[nodiscard]] std::uint32_t root() const { return root_; }
  /// Returns the index of the cluster with an identifier, or kNoCluster.
  [[nodiscard]] std::uint32_t find(std::uint32_t id) const;
  [[nodiscard]] std::size_t size() const { return clusters_.size(); }
  [[nodiscard]] std::size_t present() const { return present_; }
  [[nodiscard]] const SplatCluster& operator[](std::uint32_t cluster) const { return clusters_[cluster]; }
  [[nodiscard]] SplatCluster& at(std::uint32_t cluster) { return clusters_[cluster]; }
  [[nodiscard]] const HarmonicsChunk& harmonics(std::uint32_t chunk) const { return harmonics_[chunk]; }
  /// Enlarges the box of a cluster and of its ancestors.
  void add_box(std::uint32_t cluster, const Box& box);

 private:
  std::uint32_t make(std::uint32_t id);
  /// Sets the offset and the level of a cluster, and links it with its parent and its children.
  void describe(std::uint32_t cluster, std::uint64_t offset, std::uint32_t bytes, std::uint8_t level,
                std::uint32_t parent_id);
  void link(std::uint32_t cluster, std::uint32_t parent_id);
  void attach(std::uint32_t cluster, std::uint32_t parent);
  bool add_harmonics(std::uint32_t cluster, const HarmonicsChunk& chunk);

  std::vector<SplatCluster> clusters_;
  std::vector<HarmonicsChunk> harmonics_;
  std::unordered_map<std::uint32_t, std::uint32_t> indices_;        // by identifier
  std::unordered_multimap<std::uint32_t, std::uint32_t> orphans_;   // by the identifier of their unknown parent
  std::unordered_multimap<std::uint32_t, HarmonicsChunk> waiting_;  // by the identifier of their unknown cluster
  std::uint32_t root_ = kNoCluster;
  std::size_t present_ = 0;
};

}  // namespace gs::qnv::gaussians
