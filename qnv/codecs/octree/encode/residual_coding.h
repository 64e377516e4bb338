#pragma once

#include "qnv/codecs/octree/packed_tables.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace gs::qnv {

// Output of the decisions and residuals of octree encoders.

/// Writes one decision to a lane.
inline void put_bit(RansEncoder& rans, std::size_t lane, std::uint32_t probability, bool bit) {
  rans.put(lane, bit ? 0 : probability, bit ? probability : kRansTotal - probability);
}

/// Frequency of each residual symbol.
using ResidualHistogram = std::array<std::uint32_t, kResidualSymbols>;

inline void count(ResidualHistogram& histogram, int value) { ++histogram[std::min(zigzag(value), kEscape)]; }

/// Returns the cost of the residuals with a model, in 1/256 bits.
inline std::uint64_t cost_of(const ResidualHistogram& histogram, std::size_t model) {
  std::uint64_t cost = 0;
  for (std::uint32_t s = 0; s < kResidualSymbols; ++s)
    cost += static_cast<std::uint64_t>(histogram[s]) * residual_models()[model].cost[s];
  return cost;
}

/// Returns the index of the model with the lowest cost.
inline std::uint8_t cheapest(const ResidualHistogram& histogram) {
  std::uint8_t best = 0;
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t m = 0; m < kResidualModels; ++m) {
    const std::uint64_t cost = cost_of(histogram, m);
    if (cost < least) {
      least = cost;
      best = static_cast<std::uint8_t>(m);
    }
  }
  return best;
}

/// Writes the residuals `of(i)` of n children in groups, one residual per lane. In each group, the symbols precede the
/// escaped values.
template <class Of, class ModelOf>
void put_residuals(RansEncoder& rans, std::size_t n, Of of, ModelOf model_of) {
  for (std::size_t i = 0; i < n; i += kRansLanes) {
    const std::size_t lanes = std::min(kRansLanes, n - i);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::uint32_t symbol = std::min(zigzag(of(i + lane)), kEscape);
      const ResidualModel::Interval interval = residual_models()[model_of(i + lane)].interval[symbol];
      rans.put(lane, interval.start, interval.frequency);
    }
    for (std::size_t lane = 0; lane < lanes; ++lane)
      if (zigzag(of(i + lane)) >= kEscape) rans.put_bits(lane, zigzag(of(i + lane)), kEscapeBits);
  }
}

}  // namespace gs::qnv
