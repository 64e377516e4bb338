#pragma once

#include "qnv/codecs/values/block.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Maximum size of a cluster as the payload of a chunk, and the size of its coded bits at which an encoder ends it. One
/// step adds less than the difference.
inline constexpr std::size_t kMaxClusterBytes = 1200, kClusterEnd = 1060;
/// Maximum size of a payload with the number of a component, which may take another byte.
inline constexpr std::size_t kMaxComponentBytes = kMaxClusterBytes + 1;

/// Coded steps of one block. A block's clusters are decoded in order; clusters of other blocks do not matter.
struct Cluster {
  std::uint32_t block = 0;       // number of the block in BlockLayout
  std::uint32_t index = 0;       // position in the block, from 0
  std::uint32_t steps = 0;       // number of cubes
  std::uint8_t plane = 0;        // of the first step of the block; only cluster 0 has it
  std::vector<std::byte> bytes;  // of a BinaryEncoder, which each cluster restarts; models continue
  bool differs = false;          // the block is a difference to that of the step before; only cluster 0 states it
};

/// Decodes consecutive clusters of a block. Returns the number of decoded steps.
std::size_t decode(std::span<const Cluster> clusters, Block& block, BlockScratch& scratch);

/// Highest bit plane of a coefficient.
inline constexpr std::uint8_t kHighestPlane = 30;
/// Maximum magnitude of a sample. Coefficients then fit into planes 0 to kHighestPlane.
inline constexpr std::int32_t kMostSample = 1 << 26;
/// Maximum number of samples of a volume.
inline constexpr std::size_t kMostSamples = std::size_t{1} << 31;

/// Returns a cluster as the payload of a chunk, and back. Differences are invalid unless `may_differ`. Parsing is safe
/// for untrusted bytes.
[[nodiscard]] std::vector<std::byte> pack(const Cluster& cluster);
[[nodiscard]] std::optional<Cluster> parse_cluster(std::span<const std::byte> payload, bool may_differ = false);

}  // namespace gs::qnv::values
