#pragma once

#include "base/budget.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::app {

/// Rest of a budget, by resource, for a child that imports with it.
using BudgetLeft = std::array<std::uint64_t, kResources.size()>;

[[nodiscard]] inline BudgetLeft left_of(const Budget& budget) {
  BudgetLeft left{};
  for (std::size_t i = 0; i < kResources.size(); ++i) left[i] = budget.left(kResources[i].resource);
  return left;
}

/// Returns limits under which a budget has at least `left` of each resource.
[[nodiscard]] inline Limits limits_of(const BudgetLeft& left) {
  constexpr std::uint64_t kLeast = 1 << 20;
  Limits limits;
  std::uint64_t memory = 0;
  for (std::size_t i = 0; i < kResources.size(); ++i)
    if (kResources[i].held) memory = std::max(memory, left[i] * kResources[i].cost * 32 / kResources[i].share);
  limits.memory = static_cast<std::size_t>(std::max(memory, kLeast));
  return limits;
}

}  // namespace gs::app
