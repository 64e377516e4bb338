#pragma once

#include "qnv/packed/packed.h"
#include "qnv/stream/container.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::qnv {

constexpr std::uint32_t kNoNode = 0xffffffff;
/// A plane meets about four of the eight children of a voxel.
constexpr std::uint32_t kTypicalChildren = 4;

/// Directions around an axis.
struct NormalCone {
  glm::vec3 axis{0, 0, 1};
  float cosine = -1;  // of the angle that none is further from the axis than; -1: any direction
};

/// What is known of one cluster without having it decoded.
struct LodNode {
  std::uint64_t offset = 0;  // of its chunk
  std::uint32_t bytes = 0;   // of its chunk, with the chunk's header
  std::uint32_t parent = kNoNode, first_child = kNoNode, next_sibling = kNoNode;
  std::uint32_t voxels = 0;               // as it is claimed, or guessed, until it is known
  std::uint32_t discs = 0, replaced = 0;  // once it is known: its own, and those of the parent in whose place they are
  std::uint32_t arrival = 0;              // when it came
  std::uint16_t first = 0, count = 0;     // the voxels of the parent that it divides; no count: its header was not read
  std::uint8_t level = 0;                 // of its voxels
  std::uint16_t chosen_by = 0;            // a bit for every viewport whose last cut it belongs to
  bool present = false;                   // its bytes have come
  bool known = false;                     // it was decoded, and was what it should be
  bool broken = false;                    // never to be drawn, and nothing below it
  bool claimed = false;                   // by a directory: its voxels were counted
  bool boxed = false;                     // the box is its own
  bool ready = false;                     // of the cut in work: it is decoded or will be
  bool visible = false;                   // of the cut in work: its discs may be seen
  Box box;                                // units of the stream; holds its voxels
  NormalCone cone;                        // of its discs, once it is known
};

/// The clusters of a stream, as its directory lists them or as they were found. An index stays what it is. Everything
/// that is told to it may be a lie; what cannot be so is `broken` or refused. One thread.
class LodTree {
 public:
  /// From the whole directory of a stream that is there: the number of a cluster is its place in the directory. How
  /// many entries make no sense.
  std::size_t set_directory(std::span<const DirectoryEntry> entries, std::uint64_t stream_bytes);
  /// Likewise of a stream of which chunks are still to come, or have come.
  std::size_t expect(std::span<const DirectoryEntry> entries);
  /// A cluster whose chunk was found. kNoNode when there is no place for it; `why` says so.
  std::uint32_t arrive(const ClusterHeader& header, std::uint64_t offset, std::uint32_t bytes, std::string& why);

  /// Why the header that a node's chunk turned out to have cannot be its own; empty when it can.
  [[nodiscard]] std::string misfit(std::uint32_t node, const ClusterHeader& header) const;

  [[nodiscard]] std::uint32_t root() const { return root_; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] std::size_t present() const { return present_; }
  [[nodiscard]] LodNode& operator[](std::uint32_t node) { return nodes_[node]; }
  [[nodiscard]] const LodNode& operator[](std::uint32_t node) const { return nodes_[node]; }
  /// 0 for the cluster that came first, 1 for the last.
  [[nodiscard]] float age(std::uint32_t node) const;

 private:
  std::uint32_t make(std::uint32_t id);
  void link(std::uint32_t node, std::uint32_t id, std::uint32_t parent_id);
  void attach(std::uint32_t node, std::uint32_t parent);
  [[nodiscard]] std::uint32_t index_of(std::uint32_t id) const;

  std::vector<LodNode> nodes_;
  bool dense_ = false;                                             // numbers are indices
  std::unordered_map<std::uint32_t, std::uint32_t> indices_;       // else, by number
  std::unordered_multimap<std::uint32_t, std::uint32_t> orphans_;  // by the number of the parent that is not known
  std::uint32_t root_ = kNoNode;
  std::size_t present_ = 0;
};

}  // namespace gs::qnv
