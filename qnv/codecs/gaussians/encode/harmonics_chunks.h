#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "qnv/codecs/gaussians/encode/splat_clusters.h"
#include "qnv/container/container.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Coefficients of all nodes of a tree, harmonic_count() each. Coefficients of a merged Gaussian are the means of its
/// leaves, weighted as their colours.
class MeanHarmonics {
 public:
  /// Takes the known coefficients of the first nodes, and computes the others.
  MeanHarmonics(const MergeTree& tree, const Gaussians& source, std::vector<glm::vec3> known = {});

  [[nodiscard]] std::span<const glm::vec3> of(std::uint32_t node) const {
    return std::span(all_).subspan(per_ * node, per_);
  }

 private:
  std::size_t per_;
  std::vector<glm::vec3> all_;
};

/// Encoded harmonics of some Gaussians of one cluster.
struct EncodedHarmonics {
  ChunkType type = ChunkType::harmonics;
  std::uint32_t first = 0, count = 0;  // as in HarmonicsHead
  std::vector<std::byte> bytes;        // without the head
  double gain = 0;                     // reduction of the squared error
};

/// Encodes the harmonics of the leaves and of the merged Gaussians of a cluster.
[[nodiscard]] std::vector<EncodedHarmonics> encode_harmonics(const EncodedCluster& cluster, const MergeTree& tree,
                                                             const MeanHarmonics& means, int degree,
                                                             const Precision& precision);

}  // namespace gs::qnv::gaussians
