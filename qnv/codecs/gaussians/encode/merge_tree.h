#pragma once

#include "base/box.h"
#include "base/parallel.h"
#include "qnv/base/geometry.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv::gaussians {

/// Moments of one or more Gaussians, as a mixture with the weights opacity x area x visibility.
struct Blob {
  glm::vec3 mean{0};
  std::array<float, 6> covariance{};  // xx, xy, xz, yy, yz, zz
  glm::vec3 color{0};                 // mean of Gaussians::bases
  float weight = 0;                   // sum of opacity x area x visibility
  float visibility = 1;               // mean of visibility_of(), weighted by opacity x area x visibility
  float cover = 0;                    // opacity x area of the union; an area under several Gaussians counts once
};

/// Shape of a blob as it is drawn.
struct BlobLook {
  std::array<float, 6> covariance{};
  float opacity = 0;
};

/// Node of a tree of merged Gaussians.
struct MergedNode {
  static constexpr std::uint32_t kNone = 0xffffffff, kOutside = kNone - 1;

  Blob blob;
  float error = 0;  // squared error of pictures that show this node instead of its leaves; 0 for leaves
  std::uint32_t leaves = 1;
  // Children. In a leaf, `left` is kNone and `right` is the index of the Gaussian. If `left` is kOutside, the tree
  // omits the children.
  std::uint32_t left = kNone, right = kNone;

  [[nodiscard]] bool leaf() const { return left == kNone; }
  [[nodiscard]] bool outside() const { return left == kOutside; }
};

/// Trees from which MergeTree::join() starts.
struct Forest {
  std::vector<MergedNode> nodes;     // children before their parents
  std::vector<std::uint32_t> roots;  // indices of the nodes without a parent
  Box box;                           // bounds of the means
};

/// Binary tree of merged Gaussians. Each merge replaces two close Gaussians by one with little difference in pictures.
/// Pairs with similar colours, and with shapes that continue each other, merge first. So thin lines stay lines. Hidden
/// Gaussians merge with each other. Merges conserve sums of opacity x area x visibility, and the means of positions and
/// colours with this weight.
class MergeTree {
 public:
  /// Builds the tree of at least one Gaussian with finite numbers. Returns nullopt if it is cancelled. Gives equal
  /// results for any number of threads.
  static std::optional<MergeTree> build(const Gaussians& source, unsigned threads, Progress* progress);
  /// Merges the trees of a forest until at most `most` roots are left.
  static std::optional<MergeTree> join(Forest forest, float detail, std::size_t most, unsigned threads,
                                       Progress* progress);
  /// Constructs trees from their nodes and roots.
  MergeTree(std::vector<MergedNode> nodes, std::vector<std::uint32_t> roots, std::size_t given, float detail)
      : nodes_(std::move(nodes)), roots_(std::move(roots)), given_(given), detail_(detail) {}

  [[nodiscard]] const MergedNode& operator[](std::uint32_t i) const { return nodes_[i]; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] std::span<const MergedNode> nodes() const { return nodes_; }
  [[nodiscard]] std::uint32_t root() const { return roots_.front(); }
  [[nodiscard]] const std::vector<std::uint32_t>& roots() const { return roots_; }
  /// Returns the number of nodes of the initial forest. They come first.
  [[nodiscard]] std::size_t given() const { return given_; }
  /// Returns the shape and the opacity of a node. Opacities above 1 become larger shapes.
  [[nodiscard]] BlobLook look(std::uint32_t i) const;
  /// Returns the squared error of pictures without a node, as far as it is visible, for a squared contrast of 1.
  [[nodiscard]] double energy(std::uint32_t i) const;
  /// Returns the standard deviation below which details count as points.
  [[nodiscard]] float detail() const { return detail_; }

 private:
  std::vector<MergedNode> nodes_;  // children before their parents; a single root is last
  std::vector<std::uint32_t> roots_;
  std::size_t given_ = 0;
  float detail_ = 0;
};

/// Returns the standard deviation below which the details of a scene count as points. It depends on the median distance
/// from the mean, because few splats may lie far away. `box` has all positions.
[[nodiscard]] float detail_of(const Gaussians& source, const Box& box);
/// Returns a forest of leaves, one per Gaussian. `visibility` is the result of visibility_of(), one number per
/// Gaussian.
[[nodiscard]] Forest leaves_of(const Gaussians& source, const Box& box, float detail,
                               std::span<const float> visibility);
/// Returns the area of a Gaussian with this covariance, averaged over directions, if its details below `detail` are
/// blurred.
[[nodiscard]] float area_of(const std::array<float, 6>& covariance, float detail);
/// Returns the covariance of a splat.
[[nodiscard]] std::array<float, 6> covariance_of(const glm::vec3& scales, const glm::vec4& rotation);

}  // namespace gs::qnv::gaussians
