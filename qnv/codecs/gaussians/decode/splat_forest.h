#pragma once

#include "qnv/codecs/gaussians/lod/stored_models.h"
#include "qnv/codecs/gaussians/splat_cluster.h"
#include "qnv/codecs/gaussians/splat_steps.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Received cluster.
struct HeldCluster {
  std::vector<SplatNode> nodes;
  std::vector<bool> replaced;          // one per Gaussian: its children were received
  std::optional<StoredModels> models;  // at its end; empty once all Gaussians are final or replaced
  std::size_t inner = 0;               // Gaussians that are neither final nor replaced
  std::uint32_t level = 0;
  std::uint32_t parent = ClusterHead::kNoParent;
  std::vector<NodeOrigin> origins;   // parents are indexes in the parent cluster; empty in streams without harmonics
  std::vector<glm::vec3> harmonics;  // harmonic_count() per Gaussian; empty until any are received
  std::vector<bool> known;           // one per Gaussian: its own harmonics were received
};

/// Received clusters of a stream of Gaussians, in any order: each waits for its parent. One thread at a time. Safe for
/// untrusted bytes.
class SplatForest {
 public:
  /// `most` limits the number of Gaussians that geometry() returns, and the memory with it.
  SplatForest(const GaussianCoding& coding, const Box& box, std::size_t most)
      : precision_(precision_of(coding, box)), degree_(coding.degree), most_(most) {}

  void add_cluster(std::span<const std::byte> payload);
  /// Adds harmonics of leaves, or those of other Gaussians if `coarse` is true.
  void add_harmonics(std::span<const std::byte> payload, bool coarse);
  [[nodiscard]] const DecodeCount& count() const { return count_; }
  /// Returns the number of Gaussians that no received ones replace.
  [[nodiscard]] std::size_t shown() const { return shown_; }
  /// Reports whether any harmonics were received.
  [[nodiscard]] bool has_harmonics() const { return harmonics_; }
  [[nodiscard]] int degree() const { return degree_; }
  [[nodiscard]] const Precision& precision() const { return precision_; }

  /// Calls visit(node, harmonics) for each Gaussian that is shown. `harmonics` are its own, else those of its nearest
  /// ancestor with harmonics, else null.
  template <class Visit>
  void visit_shown(const Visit& visit) const {
    for (const auto& [id, held] : clusters_)
      for (std::size_t i = 0; i < held.nodes.size(); ++i)
        if (!held.replaced[i]) visit(held.nodes[i], harmonics_ ? harmonics_of(held, i) : nullptr);
  }

 private:
  // Maximum bytes of the chunks that wait for a cluster. Limited, because some clusters are never received.
  static constexpr std::size_t kMostWaitingBytes = std::size_t{64} << 20;
  using Waiting = std::multimap<std::uint32_t, std::vector<std::byte>>;

  [[nodiscard]] const glm::vec3* harmonics_of(const HeldCluster& held, std::size_t node) const;

  void wait(Waiting& waiting, std::uint32_t cluster, std::span<const std::byte> payload);
  [[nodiscard]] std::vector<std::vector<std::byte>> take_waiting(Waiting& waiting, std::uint32_t cluster);
  /// Returns the Gaussians that a cluster replaces, or an empty list if that is not possible.
  [[nodiscard]] std::vector<SplatNode> parents_of(const ClusterHead& head, const HeldCluster* parent) const;

  Precision precision_;
  int degree_;
  std::size_t most_;
  DecodeCount count_;
  std::map<std::uint32_t, HeldCluster> clusters_;
  Waiting waiting_, waiting_harmonics_, waiting_coarse_;
  std::size_t waiting_bytes_ = 0, shown_ = 0, nodes_ = 0;
  bool rooted_ = false, harmonics_ = false;
};

}  // namespace gs::qnv::gaussians
