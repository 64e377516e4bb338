#pragma once

#include "base/parallel.h"
#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "qnv/codecs/gaussians/fit/fit_painter.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv::gaussians {

/// Fitted Gaussians for nodes of a tree. Their pictures resemble those of the leaves. Nodes without one keep their
/// moments.
class FittedNodes {
 public:
  void set(std::uint32_t node, const FitGaussian& look);
  /// Returns null if the node keeps its moments.
  [[nodiscard]] const FitGaussian* of(std::uint32_t node) const {
    return node < slots_.size() && slots_[node] > 0 ? &looks_[slots_[node] - 1] : nullptr;
  }

 private:
  std::vector<std::uint32_t> slots_;  // 1 + index in looks_, by node; 0 means none
  std::vector<FitGaussian> looks_;
};

/// Nodes from which levels start, and options of the fit.
struct FitStart {
  /// Nodes above the first level to fit, each with the maximum error of the nodes that replace it. They are not
  /// fitted. If the list is empty, the first level is the first cut of the whole tree.
  std::vector<std::pair<std::uint32_t, float>> nodes;
  bool antialiased = false;  // as in Gaussians
  std::size_t most = 0;      // maximum Gaussians of the stream; 0 means unlimited
};

/// Fits the merged Gaussians of the coarse levels, level by level. Returns nullopt if it is cancelled. Gives equal
/// results for any number of threads.
[[nodiscard]] std::optional<FittedNodes> fit_nodes(const MergeTree& tree, const FitStart& start, unsigned threads,
                                                   Progress* progress);

}  // namespace gs::qnv::gaussians
