#pragma once

#include "qnv/codecs/octree/packed_layout.h"
#include "qnv/entropy/rans.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Decodes the voxels of a cluster from those of its parent, or from `root`. The header of the cluster must be set.
///
/// `divide(rans, voxels, first, count, level, next, most)` divides the voxels of one level. It returns false for more
/// than `most` children, or for a voxel without children. Returns the first problem, or nullopt.
template <class Cluster, class Voxels, class Divide>
std::optional<PackedError> divide_cluster(std::span<const std::byte> payload, std::size_t header_bytes,
                                          const Cluster* parent, Voxels root, Cluster& cluster, Divide divide) {
  const ClusterHeader& header = cluster.header;
  Voxels from = header.parent == kNoParent ? std::move(root) : Voxels{};
  const Voxels* source = &from;
  if (header.parent != kNoParent) {
    if (!parent) return PackedError{"a cluster without its parent"};
    source = &parent->voxels;
    if (parent->level() != header.level) return PackedError{"a cluster of another level than its parent"};
    if (static_cast<std::size_t>(header.first) + header.count > source->size())
      return PackedError{"a cluster divides voxels " + std::to_string(header.first) + " to " +
                         std::to_string(header.first + header.count - 1) + " of " + std::to_string(source->size())};
  }
  // Copies the bytes, so that the entropy decoder may read past the end.
  std::vector<std::byte> bits(payload.begin() + static_cast<std::ptrdiff_t>(header_bytes), payload.end());
  const std::size_t size = bits.size();
  bits.resize(size + RansDecoder::kPadding);
  RansDecoder rans(std::span<const std::byte>{bits.data(), size});
  std::size_t first = header.first, count = header.count;
  const std::size_t most = std::min(payload.size() * kVoxelsPerByte, kMaxVoxels);
  if (count > most)
    return PackedError{"a cluster of " + std::to_string(payload.size()) + " bytes divides " + std::to_string(count) +
                       " voxels; expected " + std::to_string(most) + " at most"};
  for (int level = header.level + 1; level <= cluster.level(); ++level) {
    Voxels next;
    if (!divide(rans, *source, first, count, level, next, most))
      return PackedError{"a cluster with too many voxels, or one without children"};
    cluster.voxels = std::move(next);
    if (level == cluster.level()) break;
    from = std::move(cluster.voxels);
    source = &from;
    first = 0;
    count = source->size();
  }
  if (!rans.finished()) return PackedError{"the bits of a cluster do not end at a byte"};
  return std::nullopt;
}

}  // namespace gs::qnv
