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
/// Typical number of children: a plane intersects about four of a voxel's eight.
constexpr std::uint32_t kTypicalChildren = 4;

/// Cone of directions around an axis.
struct NormalCone {
  glm::vec3 axis{0, 0, 1};
  float cosine = -1;  // of the largest angle to the axis; -1: any direction
};

/// Metadata of one cluster, independent of decoding.
struct LodNode {
  std::uint64_t offset = 0;  // of its chunk
  std::uint32_t bytes = 0;   // of its chunk, including the chunk header
  std::uint32_t parent = kNoNode, first_child = kNoNode, next_sibling = kNoNode;
  std::uint32_t voxels = 0;               // claimed or estimated until known
  std::uint32_t discs = 0, replaced = 0;  // once known: own splats, and the parent's splats that they replace
  std::uint32_t arrival = 0;              // sequence number of arrival
  std::uint16_t first = 0, count = 0;     // voxels of the parent that it divides; count 0: header not read yet
  std::uint8_t level = 0;                 // of its voxels
  std::uint16_t chosen_by = 0;            // one bit per viewport, set if the last cut contains it
  bool present = false;                   // its bytes were received
  bool known = false;                     // it was decoded and is valid
  bool broken = false;                    // neither it nor its descendants can be drawn
  bool claimed = false;                   // by a directory, with its number of voxels
  bool boxed = false;                     // `box` is exact
  bool ready = false;                     // current cut: it is decoded or will be
  bool visible = false;                   // current cut: its splats may be visible
  Box box;                                // of its voxels, units of the stream
  NormalCone cone;                        // of its splats, once known
};

/// Clusters of a stream, from its directory or its chunks. Indices are stable. All input is untrusted; contradictions
/// make nodes `broken` or are rejected. Not thread-safe.
class LodTree {
 public:
  /// Adds the directory of a complete stream; the number of a cluster is its index in the directory. Returns the number
  /// of invalid entries.
  std::size_t set_directory(std::span<const DirectoryEntry> entries, std::uint64_t stream_bytes);
  /// Adds the directory of a stream with chunks still to be received, or received already. Returns the number of
  /// invalid entries.
  std::size_t expect(std::span<const DirectoryEntry> entries);
  /// Adds a cluster found in a chunk. Returns kNoNode if it does not fit; `why` then has the reason.
  std::uint32_t arrive(const ClusterHeader& header, std::uint64_t offset, std::uint32_t bytes, std::string& why);

  /// Returns the reason why a node's chunk header contradicts the node; empty if it does not.
  [[nodiscard]] std::string misfit(std::uint32_t node, const ClusterHeader& header) const;

  [[nodiscard]] std::uint32_t root() const { return root_; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] std::size_t present() const { return present_; }
  [[nodiscard]] LodNode& operator[](std::uint32_t node) { return nodes_[node]; }
  [[nodiscard]] const LodNode& operator[](std::uint32_t node) const { return nodes_[node]; }
  /// Returns 0 for the cluster received first, 1 for the last.
  [[nodiscard]] float age(std::uint32_t node) const;

 private:
  std::uint32_t make(std::uint32_t id);
  void link(std::uint32_t node, std::uint32_t id, std::uint32_t parent_id);
  void attach(std::uint32_t node, std::uint32_t parent);
  [[nodiscard]] std::uint32_t index_of(std::uint32_t id) const;

  std::vector<LodNode> nodes_;
  bool dense_ = false;                                             // numbers are indices
  std::unordered_map<std::uint32_t, std::uint32_t> indices_;       // by number, if not dense
  std::unordered_multimap<std::uint32_t, std::uint32_t> orphans_;  // by the number of the unknown parent
  std::uint32_t root_ = kNoNode;
  std::size_t present_ = 0;
};

}  // namespace gs::qnv
