#pragma once

#include "qnv/codecs/octree/packed.h"
#include "qnv/container/container.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::qnv {

constexpr std::uint32_t kNoNode = 0xffffffff;
/// Typical number of children of a voxel: a plane intersects about four of the eight.
constexpr std::uint32_t kTypicalChildren = 4;

/// Cone of directions around an axis.
struct NormalCone {
  glm::vec3 axis{0, 0, 1};
  float cosine = -1;  // cosine of the largest angle to the axis; -1 means any direction
};

/// State of a cluster in the cuts of the viewports. Stored in the node, so that a cut reads one place per cluster.
struct CutMarks {
  std::uint16_t chosen_by = 0;  // one bit per viewport: the viewport's last cut contains the cluster
  bool ready = false;  // in the current cut: is decoded, or will be
  bool visible = false;  // in the current cut: its splats may be visible
};

/// Description of one cluster, which exists before the cluster is decoded.
struct LodNode {
  std::uint64_t offset = 0;  // byte offset of its chunk
  std::uint32_t bytes = 0;  // size of its chunk, including the chunk header
  std::uint32_t parent = kNoNode, first_child = kNoNode, next_sibling = kNoNode;
  std::uint32_t voxels = 0;  // number of voxels; claimed or estimated until decoded
  std::uint32_t discs = 0, replaced = 0;  // after decoding: own splats; splats of the parent that they replace
  std::uint32_t arrival = 0;  // serial number of reception
  std::uint16_t first = 0, count = 0;  // voxels of the parent that it divides; count 0 until the header is read
  std::uint8_t level = 0;  // level of its voxels
  bool present = false;  // its chunk is received
  bool known = false;  // it is decoded and valid
  bool broken = false;                    // neither it nor its descendants can be drawn
  bool claimed = false;  // a directory lists it, with its number of voxels
  bool boxed = false;                     // `box` is exact
  CutMarks marks;
  Box box;  // bounds of its voxels, units of the stream
  NormalCone cone;  // normals of its splats, after decoding
};

/// Properties of a cluster that its decoding gives.
struct ClusterFacts {
  std::uint16_t first = 0, count = 0;  // voxels of the parent that it divides
  std::uint32_t voxels = 0, discs = 0, replaced = 0;  // its voxels and splats; splats of the parent that they replace
  NormalCone cone;
};

/// Tree of the clusters of a stream, from its directory or its chunks. Node indices never change. All input is
/// untrusted: rejects contradictions, or marks nodes as `broken`. One thread at a time.
class LodTree {
 public:
  /// Adds the directory of a complete stream. The identifier of a cluster is its index in the directory. Returns the
  /// number of invalid entries.
  std::size_t set_directory(std::span<const DirectoryEntry> entries, std::uint64_t stream_bytes);
  /// Adds the directory of a growing stream; some chunks may have been received before. Returns the number of invalid
  /// entries.
  std::size_t expect(std::span<const DirectoryEntry> entries);
  /// Adds the cluster of a received chunk. Returns kNoNode if it contradicts other clusters; `why` then has the reason.
  std::uint32_t arrive(const ClusterHeader& header, std::uint64_t offset, std::uint32_t bytes, std::string& why);

  /// Returns the reason why a chunk's cluster header contradicts its node; empty if it does not.
  [[nodiscard]] std::string misfit(std::uint32_t node, const ClusterHeader& header) const;

  [[nodiscard]] std::uint32_t root() const { return root_; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] std::size_t present() const { return present_; }
  [[nodiscard]] const LodNode& operator[](std::uint32_t node) const { return nodes_[node]; }
  [[nodiscard]] CutMarks& marks(std::uint32_t node) { return nodes_[node].marks; }
  /// Marks a cluster as broken: neither the cluster nor its descendants can be drawn.
  void reject(std::uint32_t node) { nodes_[node].broken = true; }
  /// Marks a cluster as decoded.
  void settle(std::uint32_t node, const ClusterFacts& facts);
  /// Sets the bounds of a cluster's voxels. `exact` means that they need no later correction.
  void set_box(std::uint32_t node, const Box& box, bool exact);

  /// Returns when a cluster was received: 0 for the first one, 1 for the last one, between them for others.
  [[nodiscard]] float age(std::uint32_t node) const;

 private:
  std::uint32_t make(std::uint32_t id);
  void link(std::uint32_t node, std::uint32_t id, std::uint32_t parent_id);
  void attach(std::uint32_t node, std::uint32_t parent);
  [[nodiscard]] std::uint32_t index_of(std::uint32_t id) const;

  std::vector<LodNode> nodes_;
  bool dense_ = false;  // cluster identifiers are node indices
  std::unordered_map<std::uint32_t, std::uint32_t> indices_;  // node index of each identifier, unless dense_
  std::unordered_multimap<std::uint32_t, std::uint32_t> orphans_;  // children by the identifier of their unknown parent
  std::uint32_t root_ = kNoNode;
  std::size_t present_ = 0;
};

}  // namespace gs::qnv
