#pragma once

#include "qnv/codecs/gaussians/splat_code.h"
#include "qnv/codecs/gaussians/splat_models.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Maximum size of the payload of a chunk.
inline constexpr std::size_t kMostClusterBytes = 1200;
/// Maximum number of Gaussians of a cluster.
inline constexpr std::size_t kMostNodes = 1 << 14;

/// Start of a cluster: the children of Gaussians `first` to `first + count` - 1 of another one.
struct ClusterHead {
  static constexpr std::uint32_t kNoParent = 0xffffffff;

  std::uint32_t id = 0, parent = kNoParent;  // the first cluster has no parent
  std::uint32_t first = 0, count = 1;
  std::uint32_t level = 0;  // number of ancestors
};

/// Cluster as the payload of a chunk, in two parts.
struct PackedCluster {
  ClusterHead head;
  std::span<const std::byte> bytes;
};
[[nodiscard]] std::vector<std::byte> pack(const ClusterHead& head, std::span<const std::byte> bytes);
/// Parses a payload. Returns nullopt if its head is invalid. Safe for untrusted bytes.
[[nodiscard]] std::optional<PackedCluster> parse_cluster(std::span<const std::byte> payload);

/// Harmonics of leaves `first` to `first + count` - 1 of a cluster, as the payload of a chunk. Coarse harmonics are
/// those of the Gaussians that are neither leaves nor unchanged.
struct HarmonicsHead {
  std::uint32_t cluster = 0, first = 0, count = 0;
};
struct PackedHarmonics {
  HarmonicsHead head;
  std::span<const std::byte> bytes;
};
[[nodiscard]] std::vector<std::byte> pack(const HarmonicsHead& head, std::span<const std::byte> bytes);
[[nodiscard]] std::optional<PackedHarmonics> parse_harmonics(std::span<const std::byte> payload);

/// Relation of a decoded Gaussian to those that its cluster replaces.
struct NodeOrigin {
  std::uint16_t parent = 0;  // index among the replaced ones
  bool unchanged = false;    // equal to its parent
};

/// Decodes the children of `parents` to `nodes`; leaves have none. The parent of the first cluster is root_node(),
/// which is always replaced (`may_stay` is false). `models` are those at the end of their cluster, and become those at
/// the end of this one. `origins` gets one entry per Gaussian. Returns false if the bytes end early, or if there are
/// too many Gaussians or none.
[[nodiscard]] bool decode_nodes(std::span<const std::byte> bytes, std::span<const SplatNode> parents, bool may_stay,
                                SplatModels& models, const Precision& precision, std::vector<SplatNode>& nodes,
                                std::vector<NodeOrigin>* origins = nullptr);

/// Returns the Gaussian that the first cluster replaces. It fills the box.
[[nodiscard]] SplatNode root_node(const Box& box);

}  // namespace gs::qnv::gaussians
