#include "qnv/codecs/gaussians/encode/harmonics_chunks.h"

#include "qnv/codecs/gaussians/harmonics_code.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Coded bytes of harmonics at which a chunk ends. One Gaussian adds less than the difference to kMostClusterBytes.
constexpr std::size_t kHarmonicsEnd = 900;
// Merged Gaussians with at most this many leaves have no own harmonics, because harmonics of leaves are more useful.
constexpr std::uint32_t kFewHarmonicLeaves = 16;
// Weight of errors by missing harmonics, relative to errors of shapes and colours. Found by measurement.
constexpr double kGain = 0.5;

bool finite_coefficient(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Returns the mean squared change of a colour over all directions, if its coefficients change from `b` to `a`. An
/// empty `b` means zeros.
double change_of(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const glm::dvec3 change = glm::dvec3(a[k]) - (b.empty() ? glm::dvec3(0) : glm::dvec3(b[k]));
    sum += glm::dot(change, change);
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace

MeanHarmonics::MeanHarmonics(const MergeTree& tree, const Gaussians& source, std::vector<glm::vec3> known)
    : per_(harmonic_count(source.degree)), all_(std::move(known)) {
  const std::size_t first = per_ > 0 ? all_.size() / per_ : 0;
  all_.resize(per_ * tree.size());
  for (std::size_t i = first; i < tree.size() && per_ > 0; ++i) {
    const MergedNode& node = tree[static_cast<std::uint32_t>(i)];
    glm::vec3* const own = all_.data() + per_ * i;
    if (node.leaf()) {
      for (std::size_t k = 0; k < per_; ++k) {
        const glm::vec3& v = source.harmonics[node.right * per_ + k];
        own[k] = finite_coefficient(v) ? v : glm::vec3(0);
      }
      continue;
    }
    const float share = node.blob.weight > 0 ? tree[node.right].blob.weight / node.blob.weight : 0.5f;
    const auto left = of(node.left), right = of(node.right);
    for (std::size_t k = 0; k < per_; ++k) own[k] = left[k] * (1 - share) + right[k] * share;
  }
}

std::vector<EncodedHarmonics> encode_harmonics(const EncodedCluster& cluster, const MergeTree& tree,
                                               const MeanHarmonics& means, int degree, const Precision& precision) {
  std::vector<EncodedHarmonics> chunks;
  for (const bool leaves : {true, false}) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < cluster.nodes.size(); ++i)
      if (cluster.nodes[i].leaf == leaves && cluster.places[i] != cluster.parents[i]) all.push_back(i);
    for (std::size_t first = 0; first < all.size();) {
      BinaryEncoder encoder;
      Writer writer{&encoder};
      HarmonicModels models;
      EncodedHarmonics chunk;
      chunk.type = leaves ? ChunkType::harmonics : ChunkType::coarse_harmonics;
      bool any = leaves;
      std::size_t last = first;
      for (; last < all.size() && encoder.size() < kHarmonicsEnd; ++last) {
        const std::uint32_t place = cluster.places[all[last]], parent = cluster.parents[all[last]];
        const auto own = means.of(place);
        std::array<std::array<int, 3>, harmonic_count(Gaussians::kMaxDegree)> codes{};
        if (leaves || tree[place].leaves > kFewHarmonicLeaves) {
          const double step = harmonic_step(cluster.nodes[all[last]], precision);
          for (std::size_t k = 0; k < own.size(); ++k) codes[k] = color_code(own[k], step);
          const bool root = parent == MergedNode::kNone;
          chunk.gain +=
              kGain * tree.energy(place) * change_of(own, root ? std::span<const glm::vec3>() : means.of(parent));
        }
        any = code_harmonics(writer, models, degree, codes) || any;
      }
      chunk.first = static_cast<std::uint32_t>(first);
      chunk.count = static_cast<std::uint32_t>(last - first);
      chunk.bytes = encoder.finish();
      if (any) chunks.push_back(std::move(chunk));
      first = last;
    }
  }
  return chunks;
}

}  // namespace gs::qnv::gaussians
