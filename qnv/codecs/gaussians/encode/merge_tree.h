#pragma once

#include "base/parallel.h"
#include "qnv/base/geometry.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gs::qnv::gaussians {

/// Moments of one or more Gaussians: those of a mixture with the weights opacity x area.
struct Blob {
  glm::vec3 mean{0};
  std::array<float, 6> covariance{};  // xx, xy, xz, yy, yz, zz
  glm::vec3 color{0};                 // mean of Gaussians::bases
  float weight = 0;                   // sum of opacity x area
};

/// Shape of a blob as it is drawn.
struct BlobLook {
  std::array<float, 6> covariance{};
  float opacity = 0;
};

/// Node of a tree of merged Gaussians.
struct MergedNode {
  static constexpr std::uint32_t kNone = 0xffffffff;

  Blob blob;
  float error = 0;  // squared error of pictures that show this node instead of its leaves; 0 for leaves
  std::uint32_t leaves = 1;
  std::uint32_t left = kNone, right = kNone;  // of a leaf, `left` is kNone and `right` the index of the Gaussian

  [[nodiscard]] bool leaf() const { return left == kNone; }
};

/// Binary tree of merged Gaussians. Each merge replaces two close Gaussians by one with little difference in pictures.
/// Pairs with similar colours, and with shapes that continue each other, merge first. So thin lines stay lines. Merges
/// conserve sums of opacity x area, and the means of positions and colours with this weight.
class MergeTree {
 public:
  /// Builds the tree of at least one Gaussian with finite numbers. Returns nullopt if it is cancelled. Gives equal
  /// results for any number of threads.
  static std::optional<MergeTree> build(const Gaussians& source, unsigned threads, Progress* progress);

  [[nodiscard]] const MergedNode& operator[](std::uint32_t i) const { return nodes_[i]; }
  [[nodiscard]] std::uint32_t root() const { return static_cast<std::uint32_t>(nodes_.size() - 1); }
  /// Returns the shape and the opacity of a node. Opacities above 1 become larger shapes.
  [[nodiscard]] BlobLook look(std::uint32_t i) const;
  /// Returns the standard deviation below which details count as points.
  [[nodiscard]] float detail() const { return detail_; }

 private:
  std::vector<MergedNode> nodes_;  // leaves first; the root is last
  float detail_ = 0;
};

/// Returns the area of a Gaussian with this covariance, averaged over directions, if its details below `detail` are
/// blurred.
[[nodiscard]] float area_of(const std::array<float, 6>& covariance, float detail);
/// Returns the covariance of a splat.
[[nodiscard]] std::array<float, 6> covariance_of(const glm::vec3& scales, const glm::vec4& rotation);

}  // namespace gs::qnv::gaussians
