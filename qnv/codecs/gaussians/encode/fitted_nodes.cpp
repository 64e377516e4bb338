#include "qnv/codecs/gaussians/encode/fitted_nodes.h"

#include "qnv/codecs/gaussians/encode/tree_cuts.h"
#include "qnv/codecs/gaussians/fit/fit_views.h"
#include "qnv/codecs/gaussians/fit/gaussian_fit.h"

#include <glm/common.hpp>

#include <algorithm>

namespace gs::qnv::gaussians {
namespace {

// Levels with more Gaussians than this share of the leaves keep their moments.
constexpr double kFittedShare = 0.2;
// Least standard deviation, relative to MergeTree::detail().
constexpr float kThinnestFit = 1.0f / 32;

/// Nodes of a level, each with the maximum error of the nodes that replace it.
using FitCut = std::vector<std::pair<std::uint32_t, float>>;

FitGaussian gaussian_of(const MergeTree& tree, std::uint32_t node, const FittedNodes& fitted) {
  if (const FitGaussian* known = fitted.of(node)) return *known;
  const BlobLook look = tree.look(node);
  return {tree[node].blob.mean, look.covariance, look.opacity, glm::max(tree[node].blob.color, glm::vec3(0))};
}

/// Reports whether the tree ends at a node.
bool ends(const MergeTree& tree, std::uint32_t node) { return tree[node].leaf() || tree[node].outside(); }

/// Returns the Gaussians at the ends of the tree below the nodes of a cut.
std::vector<FitGaussian> leaves_below(const MergeTree& tree, const FitCut& cut) {
  std::vector<FitGaussian> leaves;
  std::vector<std::uint32_t> open;
  for (const auto& [node, error] : cut) open.push_back(node);
  while (!open.empty()) {
    const std::uint32_t node = open.back();
    open.pop_back();
    if (ends(tree, node)) {
      leaves.push_back(gaussian_of(tree, node, {}));
    } else {
      open.push_back(tree[node].left);
      open.push_back(tree[node].right);
    }
  }
  return leaves;
}

FitCut first_cut(const MergeTree& tree) {
  FitCut cut;
  float error = 0;
  for (const std::uint32_t node : parts_of(tree, tree.root(), 0, kFirstNodes)) {
    cut.emplace_back(node, 0.0f);
    error = std::max(error, tree[node].error);
  }
  for (auto& [node, next] : cut) next = error_below(error, 0);
  return cut;
}

FitCut next_cut(const MergeTree& tree, const FitCut& cut) {
  FitCut next;
  for (const auto& [node, error] : cut)
    for (const std::uint32_t part : parts_of(tree, node, error, kUsualChildren))
      next.emplace_back(part, error / kErrorRatio);
  return next;
}

}  // namespace

void FittedNodes::set(std::uint32_t node, const FitGaussian& look) {
  if (node >= slots_.size()) slots_.resize(node + std::size_t{1});
  looks_.push_back(look);
  slots_[node] = static_cast<std::uint32_t>(looks_.size());
}

std::optional<FittedNodes> fit_nodes(const MergeTree& tree, const FitStart& start, unsigned threads,
                                     Progress* progress) {
  FittedNodes fitted;
  FitCut cut = start.nodes.empty() ? first_cut(tree) : start.nodes;
  std::vector<bool> fixed(tree.size());
  for (const auto& [node, error] : start.nodes) fixed[node] = true;
  if (!start.nodes.empty()) cut = next_cut(tree, cut);
  const std::vector<FitGaussian> leaves = leaves_below(tree, cut);
  const auto most = static_cast<std::size_t>(kFittedShare * static_cast<double>(leaves.size()));
  if (cut.size() > most) return fitted;
  const FitViews views(leaves, most, start.antialiased, threads, progress);
  if (is_cancelled(progress)) return std::nullopt;
  std::size_t before = 0;
  while (cut.size() <= most && cut.size() != before && (start.most == 0 || before < start.most)) {
    std::vector<FitGaussian> shown;
    std::vector<std::uint32_t> free;
    for (const auto& [node, error] : cut) {
      if (!ends(tree, node) && !fixed[node]) free.push_back(static_cast<std::uint32_t>(shown.size()));
      shown.push_back(gaussian_of(tree, node, fitted));
    }
    if (!fit_gaussians(shown, free, views, tree.detail() * kThinnestFit, threads, progress)) return std::nullopt;
    for (const std::uint32_t i : free) {
      fitted.set(cut[i].first, shown[i]);
      fixed[cut[i].first] = true;
    }
    before = cut.size();
    cut = next_cut(tree, cut);
  }
  return fitted;
}

}  // namespace gs::qnv::gaussians
