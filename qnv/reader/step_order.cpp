#include "qnv/reader/step_order.h"

#include "qnv/container/step_table.h"

#include <algorithm>

namespace gs::qnv {

bool plays_backwards(std::uint32_t before, std::uint32_t step, std::size_t steps) {
  if (steps == 0 || step == (before + 1) % steps) return false;
  return before == (step + 1) % steps || step < before;
}

StepOrder::StepOrder(std::size_t steps, std::span<const PlayedStep> shown)
    : clusters_(steps, std::uint8_t{kOther}), own_(steps, std::uint8_t{kOther}) {
  if (steps == 0) return;
  for (const PlayedStep& played : shown) {
    // Players begin again after the last step.
    const std::size_t from = std::min<std::size_t>(played.step, steps - 1);
    for (std::size_t k = 0; k <= std::min<std::size_t>(kAhead, steps - 1); ++k)
      need(static_cast<std::uint32_t>((from + (played.backwards ? steps - k : k)) % steps),
           static_cast<std::uint32_t>(k));
  }
}

void StepOrder::need(std::uint32_t step, std::uint32_t rank) {
  const auto lower = [rank](std::uint8_t& of) { of = std::min(of, static_cast<std::uint8_t>(rank)); };
  lower(own_[step]);
  for (std::size_t s = step / kChainSteps * kChainSteps; s <= step; ++s) lower(clusters_[s]);
}

std::uint32_t StepOrder::rank(std::uint32_t step, bool cluster) const {
  const std::vector<std::uint8_t>& ranks = cluster ? clusters_ : own_;
  return step < ranks.size() ? ranks[step] : kOther;
}

}  // namespace gs::qnv
