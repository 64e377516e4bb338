#include "qnv/codecs/gaussians/encode/fitted_nodes.h"

#include "qnv/codecs/gaussians/encode/tree_cuts.h"
#include "qnv/codecs/gaussians/fit/fit_views.h"
#include "qnv/codecs/gaussians/fit/gaussian_fit.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <vector>

namespace gs::qnv::gaussians::fitted_nodes_test {
namespace {

FitGaussian look_of(const MergeTree& tree, std::uint32_t node, const FittedNodes& fitted) {
  if (const FitGaussian* known = fitted.of(node)) return *known;
  const BlobLook look = tree.look(node);
  return {tree[node].blob.mean, look.covariance, look.opacity, tree[node].blob.color};
}

/// Returns the squared error of a picture of some nodes, from a camera that no fit uses.
double error_of(const MergeTree& tree, const std::vector<std::uint32_t>& nodes, const FittedNodes& fitted) {
  FitCamera camera;
  camera.eye = {0.7f, 0.4f, -5};
  camera.tangent = 0.5f;
  camera.near_plane = 0.01f;
  std::vector<FitGaussian> leaves, shown;
  for (std::uint32_t i = 0; i < tree.size(); ++i)
    if (tree[i].leaf()) leaves.push_back(look_of(tree, i, {}));
  for (const std::uint32_t node : nodes) shown.push_back(look_of(tree, node, fitted));
  FitPainter painter(128, {}, 2);
  FitPixels target;
  painter.paint(leaves, camera, target);
  std::vector<FitGradient> gradient;
  return painter.differentiate(shown, camera, target, gradient);
}

/// Returns walls, floor and ceiling of a room.
std::vector<FitGaussian> room() {
  std::vector<FitGaussian> all;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      for (int i = 0; i < 400; ++i) {
        FitGaussian one;
        one.mean[axis] = side;
        one.mean[(axis + 1) % 3] = static_cast<float>(i % 20) / 10 - 0.95f;
        one.mean[(axis + 2) % 3] = static_cast<float>(i / 20) / 10 - 0.95f;
        one.covariance = covariance_of(glm::vec3(0.06f), {0, 0, 0, 1});
        one.opacity = 0.95f;
        one.color = glm::vec3(0.5f);
        all.push_back(one);
      }
  return all;
}

}  // namespace

TEST_CASE("fitted Gaussians reduce the error of other pictures") {
  const auto tree = MergeTree::build(test::splat_cloud(3000), 2, nullptr);
  REQUIRE(tree);
  const auto fitted = fit_nodes(*tree, {}, 2, nullptr);
  REQUIRE(fitted);
  const std::vector<std::uint32_t> first = parts_of(*tree, tree->root(), 0, kFirstNodes);
  for (const std::uint32_t node : first) CHECK((fitted->of(node) != nullptr) != (*tree)[node].leaf());
  const double moments = error_of(*tree, first, {}), better = error_of(*tree, first, *fitted);
  INFO(moments << " becomes " << better);
  CHECK(moments > 1);
  CHECK(better < 0.9 * moments);
}

TEST_CASE("fitted Gaussians do not depend on the number of threads") {
  const auto tree = MergeTree::build(test::splat_cloud(2000), 2, nullptr);
  REQUIRE(tree);
  const auto one = fit_nodes(*tree, {}, 1, nullptr), several = fit_nodes(*tree, {}, 4, nullptr);
  REQUIRE((one && several));
  std::size_t found = 0;
  bool equal = true;
  for (std::uint32_t i = 0; i < tree->size(); ++i) {
    const FitGaussian *a = one->of(i), *b = several->of(i);
    equal = equal && (a == nullptr) == (b == nullptr);
    if (!a || !b) continue;
    ++found;
    equal = equal && std::memcmp(a, b, sizeof *a) == 0;
  }
  CHECK(found > 50);
  CHECK(equal);
}

TEST_CASE("only levels below given Gaussians are fitted") {
  const auto tree = MergeTree::build(test::splat_cloud(2000), 2, nullptr);
  REQUIRE(tree);
  FitStart start;
  float error = 0;
  for (const std::uint32_t node : parts_of(*tree, tree->root(), 0, kFirstNodes))
    error = std::max(error, (*tree)[node].error);
  for (const std::uint32_t node : parts_of(*tree, tree->root(), 0, kFirstNodes))
    start.nodes.emplace_back(node, error_below(error, 0));
  const auto fitted = fit_nodes(*tree, start, 2, nullptr);
  REQUIRE(fitted);
  std::size_t below = 0;
  for (const auto& [node, next] : start.nodes) {
    CHECK(!fitted->of(node));
    for (const std::uint32_t part : parts_of(*tree, node, next, kUsualChildren)) below += fitted->of(part) ? 1u : 0u;
  }
  CHECK(below > 20);
}

TEST_CASE("fits end when they are cancelled, and leave small trees as they are") {
  const auto tree = MergeTree::build(test::splat_cloud(500), 1, nullptr);
  REQUIRE(tree);
  Progress progress;
  progress.cancelled = true;
  CHECK(!fit_nodes(*tree, {}, 1, &progress));
  const auto few = MergeTree::build(test::splat_cloud(20), 1, nullptr);
  REQUIRE(few);
  const auto fitted = fit_nodes(*few, {}, 1, nullptr);
  REQUIRE(fitted);
  for (std::uint32_t i = 0; i < few->size(); ++i) CHECK(!fitted->of(i));
}

TEST_CASE("some views of a room are inside, those of an object are not") {
  const auto inside = [](const std::vector<FitGaussian>& leaves) {
    const FitViews views(leaves, 1000, false, 2, nullptr);
    std::size_t count = 0;
    for (const FitCamera& camera : views.cameras())
      count += std::abs(camera.eye.x) < 1 && std::abs(camera.eye.y) < 1 && std::abs(camera.eye.z) < 1 ? 1u : 0u;
    CHECK(views.cameras().size() >= 12);
    return count;
  };
  CHECK(inside(room()) >= 4);
  std::vector<FitGaussian> object = room();
  object.resize(400);
  CHECK(inside(object) == 0);
}

TEST_CASE("fits accept extreme Gaussians") {
  std::vector<FitGaussian> leaves = room();
  leaves[0].covariance = {1e38f, 0, 0, 1e38f, 0, 1e38f};
  leaves[1].mean = {1e30f, 1e30f, -1e30f};
  leaves[2].color = {1e30f, 0, 1e30f};
  leaves[3].covariance = {};
  const FitViews views(leaves, 1000, true, 2, nullptr);
  std::vector<FitGaussian> shown(leaves.begin(), leaves.begin() + 40);
  std::vector<std::uint32_t> free;
  for (std::uint32_t i = 0; i < shown.size(); ++i) free.push_back(i);
  REQUIRE(fit_gaussians(shown, free, views, 0.001f, 2, nullptr));
  for (const FitGaussian& one : shown) {
    CHECK(std::isfinite(one.mean.x + one.mean.y + one.mean.z + one.color.x + one.color.y + one.color.z));
    CHECK((one.opacity > 0 && one.opacity < 1));
  }
}

}  // namespace gs::qnv::gaussians::fitted_nodes_test
