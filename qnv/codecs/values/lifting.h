#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Number of samples per axis, x first.
using Extent = std::array<std::uint32_t, 3>;

/// Returns the extent of the low band after `level` steps. Odd axes round up.
[[nodiscard]] Extent low_extent(Extent extent, int level);
/// Returns the number of steps of a volume: until no axis has more than 16 samples.
[[nodiscard]] int level_count(Extent extent);
[[nodiscard]] std::size_t sample_count(Extent extent);

// CDF 9/7 by integer lifting, without the final scaling: reversible, and equal on all machines. Arithmetic wraps at 32
// bits, so that every input is restored exactly. FORMAT.md, "Values payload", defines the steps.

/// Transforms the whole volume in place. Low bands come first on every axis.
void transform(std::span<std::int32_t> samples, Extent extent, int levels);
/// Transforms a line of n adjacent samples; the low band comes first. `from` and `to` may be equal, but must not
/// overlap otherwise. `line` is a buffer. join_line() reverts it.
void split_line(const std::int32_t* from, std::int32_t* to, std::size_t n, std::vector<std::int32_t>& line);
void join_line(const std::int32_t* from, std::int32_t* to, std::size_t n, std::vector<std::int32_t>& line);

/// Parts of a line in a buffer: the low samples, with room for one behind them, and the high ones, with room for one
/// before and one behind them. Lines continue by reflection.
struct LineHalves {
  std::int32_t *low, *high;
  std::size_t lows, highs;
};
/// Applies one of the four steps to a line with high samples, or reverts it.
void lift_halves(const LineHalves& line, std::size_t step, bool undo);

/// Reverts steps from `levels` down to `to`: the samples of low_extent(extent, to), at the strides of `extent`.
void restore(std::span<std::int32_t> samples, Extent extent, int levels, int to = 0);

}  // namespace gs::qnv::values
