#include "qnv/codecs/values/lifting.h"

#include "qnv/codecs/values/lifting_kernel.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace gs::qnv::values {

namespace {

// Number of columns that are lifted side by side: a strip of them fits into the processor's cache.
constexpr std::size_t kStripColumns = 32;

// Row of the transformed strip for sample i of n: low bands come first.
std::size_t band_row(std::size_t i, std::size_t n) { return i % 2 == 0 ? i / 2 : (n + 1) / 2 + i / 2; }

// Lifts `columns` <= kStripColumns adjacent columns of n samples, `stride` apart.
void lift_strip(std::int32_t* first, std::size_t n, std::size_t stride, std::size_t columns, bool undo,
                std::int32_t* rows) {
  const std::size_t bytes = columns * sizeof(std::int32_t);
  for (std::size_t i = 0; i < n; ++i)
    std::memcpy(rows + i * kStripColumns, first + (undo ? band_row(i, n) : i) * stride, bytes);
  for (std::size_t s = 0; s < 4; ++s) {
    const std::size_t step = undo ? 3 - s : s;
    for (std::size_t i = step % 2 == 0 ? 1 : 0; i < n; i += 2) {
      const std::size_t before = i > 0 ? i - 1 : 1;
      const std::size_t after = i + 1 < n ? i + 1 : i - 1;
      lift(rows + i * kStripColumns, rows + before * kStripColumns, rows + after * kStripColumns, columns, step, undo);
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    std::memcpy(first + (undo ? i : band_row(i, n)) * stride, rows + i * kStripColumns, bytes);
}

// Lifts one line of n adjacent samples. `line` has room for n + 2 samples.
void lift_line(std::int32_t* samples, std::size_t n, bool undo, std::int32_t* line) {
  const std::size_t lows = (n + 1) / 2, highs = n / 2;
  // The low samples, with a copy of the last one behind them if n is even; then the high ones, with a copy of the first
  // one before them, and of the last one behind them if n is odd: lines continue by reflection.
  std::int32_t* const low = line;
  std::int32_t* const high = line + lows + 2;
  if (undo) {
    std::memcpy(low, samples, lows * sizeof(std::int32_t));
    std::memcpy(high, samples + lows, highs * sizeof(std::int32_t));
  } else {
    for (std::size_t i = 0; i < highs; ++i) {
      low[i] = samples[2 * i];
      high[i] = samples[2 * i + 1];
    }
    if (lows > highs) low[highs] = samples[n - 1];
  }
  for (std::size_t s = 0; s < 4; ++s) {
    const std::size_t step = undo ? 3 - s : s;
    if (step % 2 == 0) {
      low[lows] = low[lows - 1];
      lift(high, low, low + 1, highs, step, undo);
    } else {
      high[-1] = high[0];
      high[highs] = high[highs - 1];
      lift(low, high - 1, high, lows, step, undo);
    }
  }
  if (undo) {
    for (std::size_t i = 0; i < highs; ++i) {
      samples[2 * i] = low[i];
      samples[2 * i + 1] = high[i];
    }
    if (lows > highs) samples[n - 1] = low[highs];
  } else {
    std::memcpy(samples, low, lows * sizeof(std::int32_t));
    std::memcpy(samples + lows, high, highs * sizeof(std::int32_t));
  }
}

// Lifts the samples of `part` along an axis.
void lift_axis(std::int32_t* samples, Extent extent, Extent part, std::size_t axis, bool undo,
               std::vector<std::int32_t>& rows) {
  const std::size_t n = part[axis];
  if (n < 2) return;
  rows.resize(std::max(rows.size(), std::max(n * kStripColumns, n + 8)));
  const std::size_t row = extent[0], slice = row * extent[1];
  if (axis == 0) {
    for (std::size_t z = 0; z < part[2]; ++z)
      for (std::size_t y = 0; y < part[1]; ++y) lift_line(samples + z * slice + y * row, n, undo, rows.data());
    return;
  }
  for (std::size_t j = 0; j < part[axis == 1 ? 2 : 1]; ++j)
    for (std::size_t x = 0; x < part[0]; x += kStripColumns)
      lift_strip(samples + j * (axis == 1 ? slice : row) + x, n, axis == 1 ? row : slice,
                 std::min<std::size_t>(kStripColumns, part[0] - x), undo, rows.data());
}

}  // namespace

Extent low_extent(Extent extent, int level) {
  for (std::uint32_t& n : extent)
    for (int i = 0; i < level; ++i) n = n / 2 + n % 2;
  return extent;
}

int level_count(Extent extent) {
  int levels = 0;
  while (std::ranges::max(low_extent(extent, levels)) > 16) ++levels;
  return levels;
}

std::size_t sample_count(Extent extent) { return std::size_t{extent[0]} * extent[1] * extent[2]; }

void transform(std::span<std::int32_t> samples, Extent extent, int levels) {
  std::vector<std::int32_t> rows;
  for (int level = 0; level < levels; ++level)
    for (std::size_t axis = 0; axis < 3; ++axis)
      lift_axis(samples.data(), extent, low_extent(extent, level), axis, false, rows);
}

void restore(std::span<std::int32_t> samples, Extent extent, int levels, int to) {
  std::vector<std::int32_t> rows;
  for (int level = levels; level-- > to;)
    for (std::size_t axis = 3; axis-- > 0;)
      lift_axis(samples.data(), extent, low_extent(extent, level), axis, true, rows);
}

}  // namespace gs::qnv::values
