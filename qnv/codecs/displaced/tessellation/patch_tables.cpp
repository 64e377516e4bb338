#include "qnv/codecs/displaced/tessellation/patch_tables.h"

#include "qnv/codecs/displaced/tessellation/patch_kernel.h"

#include <atomic>
#include <mutex>

namespace gs::qnv {
namespace {

using displaced::row_start;

PatchTable make_table(int level, const PatchTable* before) {
  PatchTable table;
  const std::size_t n = std::size_t{1} << level, half = n / 2;
  table.grid.resize(patch_vertices(level));
  const auto at = [&](std::size_t i, std::size_t j) -> PatchTable::Number& { return table.grid[row_start(j, n) + i]; };
  const auto add = [&](std::size_t i, std::size_t j) {
    const std::size_t known = level == 0 ? 0 : patch_vertices(level - 1);
    at(i, j) = static_cast<PatchTable::Number>(known + table.places.size());
    table.places.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
  };
  if (level == 0) {
    add(0, 0);
    add(1, 0);
    add(0, 1);
  } else {
    for (std::size_t j = 0; j <= half; ++j)
      for (std::size_t i = 0; i + j <= half; ++i) at(2 * i, 2 * j) = before->grid[row_start(j, half) + i];
    for (std::size_t j = 0; j <= n; ++j)
      for (std::size_t i = 0; i + j <= n; ++i) {
        if (i % 2 == 0 && j % 2 == 0) continue;
        add(i, j);
        // The new vertex is the midpoint of two vertices in the same row, column or diagonal.
        const std::size_t left = i % 2, below = j % 2;
        if (j > 0 && i > 0 && i + j < n)
          table.inside.push_back({at(i, j), left == 1 && below == 1
                                                ? std::array{at(i + 1, j - 1), at(i - 1, j + 1)}
                                                : std::array{at(i - left, j - below), at(i + left, j + below)}});
      }
  }
  for (std::size_t t = 0; t <= n; ++t) {
    table.edges[0].push_back(at(t, 0));
    table.edges[1].push_back(at(n - t, t));
    table.edges[2].push_back(at(0, n - t));
  }
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t t = 1; t < n; t += 2)
      table.on_edges[k].push_back({table.edges[k][t], {table.edges[k][t - 1], table.edges[k][t + 1]}});
  using Side = PatchTable::Side;
  const auto side = [&](bool on, std::uint8_t edge, std::size_t from) {
    return on ? Side{edge, static_cast<std::uint16_t>(from)} : Side{};
  };
  std::vector<PatchTable::Number> on_border_at;
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i + j < n; ++i) {
      const std::array corners{at(i, j), at(i + 1, j), at(i, j + 1)};
      const std::array sides{side(j == 0, 0, i), side(i + j + 1 == n, 1, j), side(i == 0, 2, n - 1 - j)};
      const bool on_border = j == 0 || i == 0 || i + j + 1 == n;
      (on_border ? table.border : table.inner).push_back(corners);
      (on_border ? on_border_at : table.turns).push_back(static_cast<PatchTable::Number>(upright_row(j, n) + i));
      if (on_border) table.sides.push_back(sides);
      if (i + j + 1 == n) continue;
      table.inner.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      table.turns.push_back(static_cast<PatchTable::Number>(turned_row(j, n) + i));
    }
  table.turns.insert(table.turns.end(), on_border_at.begin(), on_border_at.end());
  return table;
}

}  // namespace

const PatchTable& patch_table(int level) {
  static std::array<PatchTable, displaced::kDeepestPatch + 1> tables;
  static std::array<std::atomic<bool>, displaced::kDeepestPatch + 1> ready;
  static std::mutex making;
  const auto wanted = static_cast<std::size_t>(level);
  if (ready[wanted].load(std::memory_order_acquire)) return tables[wanted];
  const std::lock_guard lock(making);
  for (std::size_t l = 0; l <= wanted; ++l) {
    if (ready[l].load(std::memory_order_relaxed)) continue;
    tables[l] = make_table(static_cast<int>(l), l > 0 ? &tables[l - 1] : nullptr);
    ready[l].store(true, std::memory_order_release);
  }
  return tables[wanted];
}

}  // namespace gs::qnv
