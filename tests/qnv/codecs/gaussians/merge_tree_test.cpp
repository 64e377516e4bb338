#include "qnv/codecs/gaussians/encode/merge_tree.h"

#include "qnv/codecs/gaussians/ellipsoid.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace gs::qnv::gaussians::merge_tree_test {
namespace {

/// Sums of opacity x area x visibility, and of positions and colours with this weight.
struct Moments {
  double weight = 0;
  glm::dvec3 position{0}, color{0};

  void add(const Blob& blob) {
    const double share = blob.weight;
    weight += share;
    position += glm::dvec3(blob.mean) * share;
    color += glm::dvec3(blob.color) * share;
  }
};

/// Returns the nodes of the tree with at most `leaves` leaves, without their descendants.
std::vector<std::uint32_t> cut(const MergeTree& tree, std::uint32_t leaves) {
  std::vector<std::uint32_t> open{tree.root()}, found;
  while (!open.empty()) {
    const std::uint32_t i = open.back();
    open.pop_back();
    if (tree[i].leaf() || tree[i].leaves <= leaves) {
      found.push_back(i);
    } else {
      open.push_back(tree[i].left);
      open.push_back(tree[i].right);
    }
  }
  return found;
}

}  // namespace

TEST_CASE("merged Gaussians conserve visible opacity x area, positions and colours on every level") {
  const Gaussians cloud = test::splat_cloud(3000);
  const auto tree = MergeTree::build(cloud, 2, nullptr);
  REQUIRE(tree);
  CHECK((*tree)[tree->root()].leaves == 3000);
  Moments whole;
  for (const std::uint32_t i : cut(*tree, 1)) whole.add((*tree)[i].blob);
  for (const std::uint32_t leaves : {2u, 10u, 100u, 1000u, 3000u}) {
    Moments part;
    const std::vector<std::uint32_t> nodes = cut(*tree, leaves);
    for (const std::uint32_t i : nodes) part.add((*tree)[i].blob);
    INFO(nodes.size() << " nodes");
    CHECK(part.weight == Approx(whole.weight).epsilon(1e-4));
    CHECK(glm::length(part.position - whole.position) < 1e-4 * whole.weight);
    CHECK(glm::length(part.color - whole.color) < 1e-4 * whole.weight);
  }
  // A look covers as much as the blob, unless this needs more than the maximum growth.
  std::size_t kept = 0, all = 0;
  for (const std::uint32_t i : cut(*tree, 20)) {
    if ((*tree)[i].leaf()) continue;
    const BlobLook look = tree->look(i);
    const float area = area_of(look.covariance, tree->detail());
    ++all;
    kept += std::abs(look.opacity * area / (*tree)[i].blob.cover - 1) < 0.02f ? 1 : 0;
  }
  CHECK(kept > all * 3 / 4);
}

TEST_CASE("merged Gaussians cover once what their leaves cover twice") {
  Gaussians stack;
  for (int i = 0; i < 16; ++i) {
    stack.positions.emplace_back(0.001f * static_cast<float>(i), 0, 0);
    stack.scales.emplace_back(0.1f);
    stack.rotations.emplace_back(0, 0, 0, 1);
    stack.opacities.push_back(0.2f);
    stack.bases.emplace_back(1);
    stack.description.box.add(stack.positions.back());
  }
  const auto tree = MergeTree::build(stack, 1, nullptr);
  REQUIRE(tree);
  // The middle of the stack has an opacity of 1 - 0.8^16 = 0.97, its rim less than that.
  const BlobLook look = tree->look(tree->root());
  CHECK(look.opacity > 0.8f);
  CHECK(look.opacity <= 1);
  CHECK(std::sqrt(look.covariance[3]) == Approx(0.1).epsilon(0.25));
}

TEST_CASE("colours of hidden Gaussians do not change merged ones") {
  // A white ball around a black one.
  Gaussians ball;
  for (const float radius : {1.0f, 0.6f}) {
    for (int i = 0; i < 2000; ++i) {
      const float y = 1 - (2 * static_cast<float>(i) + 1) / 2000, turn = 2.399963f * static_cast<float>(i);
      const float r = std::sqrt(1 - y * y);
      ball.positions.push_back(radius * glm::vec3(r * std::cos(turn), y, r * std::sin(turn)));
      ball.scales.emplace_back(0.05f);
      ball.rotations.emplace_back(0, 0, 0, 1);
      ball.opacities.push_back(0.95f);
      ball.bases.emplace_back(radius > 0.9f ? 1.0f : 0.0f);
      ball.description.box.add(ball.positions.back());
    }
  }
  const auto tree = MergeTree::build(ball, 2, nullptr);
  REQUIRE(tree);
  CHECK((*tree)[tree->root()].blob.color.x > 0.75f);
}

TEST_CASE("trees of Gaussians do not depend on the number of threads") {
  const Gaussians cloud = test::splat_cloud(2500, 0, 5);
  const auto one = MergeTree::build(cloud, 1, nullptr), more = MergeTree::build(cloud, 3, nullptr);
  REQUIRE((one && more));
  REQUIRE(one->root() == more->root());
  for (std::uint32_t i = 0; i <= one->root(); ++i) {
    REQUIRE((*one)[i].left == (*more)[i].left);
    REQUIRE((*one)[i].right == (*more)[i].right);
  }
  Progress progress;
  progress.cancelled = true;
  CHECK(!MergeTree::build(cloud, 1, &progress));
}

TEST_CASE("trees of Gaussians accept degenerate input") {
  Gaussians same = test::splat_cloud(200);
  for (std::size_t i = 0; i < same.size(); ++i) {
    same.positions[i] = glm::vec3(3);
    same.scales[i] = glm::vec3(0);
  }
  same.description.box = {glm::vec3(3), glm::vec3(3)};
  const auto tree = MergeTree::build(same, 1, nullptr);
  REQUIRE(tree);
  CHECK((*tree)[tree->root()].leaves == 200);
  const auto single = MergeTree::build(test::splat_cloud(1), 1, nullptr);
  REQUIRE(single);
  CHECK(single->root() == 0);
  Gaussians far = test::splat_cloud(300);
  far.positions[7] = glm::vec3(1e15f);
  far.scales[8] = glm::vec3(1e12f);
  far.description.box.add(far.positions[7]);
  CHECK(MergeTree::build(far, 1, nullptr));
}

TEST_CASE("lines of Gaussians merge along themselves") {
  // Parallel thin lines of one colour each, closer to each other than the parts of a line.
  Gaussians lines;
  for (int line = 0; line < 4; ++line)
    for (int i = 0; i < 64; ++i) {
      lines.positions.emplace_back(0.1f * static_cast<float>(i), 0.06f * static_cast<float>(line), 0);
      lines.scales.emplace_back(0.06f, 0.003f, 0.003f);
      lines.rotations.emplace_back(0, 0, 0, 1);
      lines.opacities.push_back(0.9f);
      lines.bases.push_back(line % 2 == 0 ? glm::vec3(1, 1, 1) : glm::vec3(0, 0, 0.2f));
      lines.description.box.add(lines.positions.back());
    }
  const auto tree = MergeTree::build(lines, 1, nullptr);
  REQUIRE(tree);
  std::size_t thin = 0, all = 0;
  for (const std::uint32_t i : cut(*tree, 8)) {
    const Ellipsoid shape = ellipsoid_of(tree->look(i).covariance);
    ++all;
    thin += shape.scales.y < 0.01f && std::abs(shape.axes[0].x) > 0.99f ? 1 : 0;
  }
  CHECK(all >= 32);
  CHECK(thin == all);
}

TEST_CASE("ellipsoids restore covariances") {
  const Gaussians cloud = test::splat_cloud(100);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto covariance = covariance_of(cloud.scales[i], cloud.rotations[i]);
    const Ellipsoid shape = ellipsoid_of(covariance);
    CHECK(shape.scales.x >= shape.scales.y);
    CHECK(shape.scales.y >= shape.scales.z);
    const glm::quat q = glm::quat_cast(shape.axes);
    const auto again = covariance_of(shape.scales, {q.x, q.y, q.z, q.w});
    for (std::size_t k = 0; k < 6; ++k) CHECK(again[k] == Approx(covariance[k]).margin(1e-6));
  }
}

}  // namespace gs::qnv::gaussians::merge_tree_test
