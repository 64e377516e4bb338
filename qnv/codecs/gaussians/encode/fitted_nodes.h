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

/// Merged Gaussians of a tree as they are drawn: fitted ones suit the pictures of their leaves, others have their
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

/// Nodes from which levels start, and how they are fitted.
struct FitStart {
  /// Nodes of the first level, and the largest error of the levels that follow on each of them. If it is empty, the
  /// first level is that of a whole tree, which is fitted, too.
  std::vector<std::pair<std::uint32_t, float>> nodes;
  bool antialiased = false;  // as in Gaussians
  std::size_t most = 0;      // Gaussians of the stream; 0 means unlimited
};

/// Fits the merged Gaussians of all levels that gain much. Returns nullopt if it is cancelled. Gives equal results for
/// any number of threads.
[[nodiscard]] std::optional<FittedNodes> fit_nodes(const MergeTree& tree, const FitStart& start, unsigned threads,
                                                   Progress* progress);

}  // namespace gs::qnv::gaussians
