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

LineHalves halves_of(std::vector<std::int32_t>& line, std::size_t n) {
  if (line.size() < n + 8) line.resize(n + 8);
  const std::size_t lows = (n + 1) / 2;
  return {line.data(), line.data() + lows + 2, lows, n / 2};
}

// Lifts the samples of `part` along an axis.
void lift_axis(std::int32_t* samples, Extent extent, Extent part, std::size_t axis, bool undo,
               std::vector<std::int32_t>& rows) {
  const std::size_t n = part[axis];
  if (n < 2) return;
  rows.resize(std::max(rows.size(), n * kStripColumns));
  const std::size_t row = extent[0], slice = row * extent[1];
  if (axis == 0) {
    for (std::size_t z = 0; z < part[2]; ++z)
      for (std::size_t y = 0; y < part[1]; ++y) {
        std::int32_t* const line = samples + z * slice + y * row;
        if (undo)
          join_line(line, line, n, rows);
        else
          split_line(line, line, n, rows);
      }
    return;
  }
  for (std::size_t j = 0; j < part[axis == 1 ? 2 : 1]; ++j)
    for (std::size_t x = 0; x < part[0]; x += kStripColumns)
      lift_strip(samples + j * (axis == 1 ? slice : row) + x, n, axis == 1 ? row : slice,
                 std::min<std::size_t>(kStripColumns, part[0] - x), undo, rows.data());
}

}  // namespace

void lift_halves(const LineHalves& line, std::size_t step, bool undo) {
  const auto& [low, high, lows, highs] = line;
  if (step % 2 == 0) {
    low[lows] = low[lows - 1];
    lift(high, low, low + 1, highs, step, undo);
  } else {
    high[-1] = high[0];
    high[highs] = high[highs - 1];
    lift(low, high - 1, high, lows, step, undo);
  }
}

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

void split_line(const std::int32_t* from, std::int32_t* to, std::size_t n, std::vector<std::int32_t>& line) {
  if (n < 2) {
    if (n == 1) *to = *from;
    return;
  }
  const LineHalves halves = halves_of(line, n);
  separate(from, halves.highs, halves.low, halves.high);
  if (halves.lows > halves.highs) halves.low[halves.highs] = from[n - 1];
  for (std::size_t step = 0; step < 4; ++step) lift_halves(halves, step, false);
  std::memcpy(to, halves.low, halves.lows * sizeof(std::int32_t));
  std::memcpy(to + halves.lows, halves.high, halves.highs * sizeof(std::int32_t));
}

void join_line(const std::int32_t* from, std::int32_t* to, std::size_t n, std::vector<std::int32_t>& line) {
  if (n < 2) {
    if (n == 1) *to = *from;
    return;
  }
  const LineHalves halves = halves_of(line, n);
  std::memcpy(halves.low, from, halves.lows * sizeof(std::int32_t));
  std::memcpy(halves.high, from + halves.lows, halves.highs * sizeof(std::int32_t));
  for (std::size_t step = 4; step-- > 0;) lift_halves(halves, step, true);
  interleave(halves.low, halves.high, halves.highs, to);
  if (halves.lows > halves.highs) to[n - 1] = halves.low[halves.highs];
}

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
