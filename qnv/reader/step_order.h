#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Step of a time series that a view shows, and the direction in which it plays.
struct PlayedStep {
  std::uint32_t step = 0;
  bool backwards = false;
};
/// Reports whether a view of `steps` steps plays backwards, after it showed the step `before` and now shows `step`.
[[nodiscard]] bool plays_backwards(std::uint32_t before, std::uint32_t step, std::size_t steps);

/// Order in which views need the chunks of a time series: those of the shown steps with their chains, then those of the
/// next steps in the direction of play, then the others.
class StepOrder {
 public:
  static constexpr std::uint32_t kAhead = 8;           // next steps that come before the others
  static constexpr std::uint32_t kOther = kAhead + 1;  // rank of the others

  StepOrder(std::size_t steps, std::span<const PlayedStep> shown);
  /// Returns 0 for chunks of shown steps, k for those that the k-th next step also needs, or kOther. `cluster` states
  /// that later steps of the chain need the chunk, too.
  [[nodiscard]] std::uint32_t rank(std::uint32_t step, bool cluster) const;

 private:
  void need(std::uint32_t step, std::uint32_t rank);
  std::vector<std::uint8_t> clusters_, own_;  // ranks by step: of clusters, and of other chunks
};

}  // namespace gs::qnv
