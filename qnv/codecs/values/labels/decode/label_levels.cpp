#include "qnv/codecs/values/labels/decode/label_levels.h"

#include "qnv/codecs/values/cube_runs.h"

#include <algorithm>
#include <utility>

namespace gs::qnv::values {

namespace {

// A level is shown if it has at most this many voxels, or if one of so many cubes is received.
constexpr std::uint64_t kQuickVoxels = std::uint64_t{1} << 20, kShownShare = 16;

}  // namespace

LabelLevels::LabelLevels(Extent extent, std::uint32_t count, int finest) : count_(count), finest_(finest) {
  for (int level = 0; level <= level_count(extent); ++level) {
    Level one;
    one.extent = low_extent(extent, level);
    const Extent cubes = cube_extent(one.extent);
    one.cubes = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
    all_.push_back(std::move(one));
  }
  finest_ = std::clamp(finest_, 0, levels());
}

std::size_t LabelLevels::number(const Level& level, const Extent& cube) {
  const Extent& cubes = level.order->cubes();
  return (std::size_t{cube[2]} * cubes[1] + cube[1]) * cubes[0] + cube[0];
}

AddedLabels LabelLevels::add(const LabelRun& run) {
  if (run.level >= all_.size()) return AddedLabels::refused;
  if (run.level < finest_) return AddedLabels::dropped;
  Level& level = all_[run.level];
  if (!level.order) level.order.emplace(level.extent);
  if (run.first >= level.order->codes() || run.count > level.order->codes() - run.first) return AddedLabels::refused;
  // Valid runs do not overlap; the limit bounds the work for invalid streams.
  if (level.work + run.count > 4 * level.order->codes()) return AddedLabels::refused;
  level.work += run.count;
  if (level.received.empty()) {
    level.received.assign(level.cubes, false);
    level.grid =
        std::make_shared<LabelGrid>(LabelGrid{level.extent, std::vector<std::uint32_t>(sample_count(level.extent), 0)});
  }
  // Labels that were returned never change.
  if (level.grid.use_count() > 1) level.grid = std::make_shared<LabelGrid>(*level.grid);
  const std::uint64_t before = level.known;
  const auto [nx, ny, nz] = level.extent;
  const bool good =
      decode_label_run(run, *level.order, level.extent, count_,
                       [&, nx = nx, ny = ny, nz = nz](const Extent& cube, const CubeLabels& labels) {
                         const std::uint32_t x = cube[0] * kCubeEdge, y = cube[1] * kCubeEdge, z = cube[2] * kCubeEdge;
                         for (std::uint32_t k = 0; k < std::min(kCubeEdge, nz - z); ++k)
                           for (std::uint32_t j = 0; j < std::min(kCubeEdge, ny - y); ++j)
                             std::copy_n(labels.labels + k * labels.slice + j * labels.row, std::min(kCubeEdge, nx - x),
                                         &level.grid->labels[((std::size_t{z} + k) * ny + y + j) * nx + x]);
                         const std::size_t at = number(level, cube);
                         level.known += level.received[at] ? 0 : 1;
                         level.received[at] = true;
                       });
  if (!good) return AddedLabels::refused;
  return level.known > before ? AddedLabels::taken : AddedLabels::repeated;
}

void LabelLevels::begin_step() {
  for (Level& level : all_) level.work = 0;
}

int LabelLevels::level() const {
  for (int level = finest_; level < levels(); ++level) {
    const Level& one = all_[static_cast<std::size_t>(level)];
    if (std::uint64_t{one.extent[0]} * one.extent[1] * one.extent[2] <= kQuickVoxels ||
        one.known * kShownShare >= one.cubes)
      return level;
  }
  return levels();
}

void LabelLevels::refine(const LabelGrid& coarse, LabelGrid& fine) {
  std::uint32_t* to = fine.labels.data();
  for (std::uint32_t z = 0; z < fine.extent[2]; ++z)
    for (std::uint32_t y = 0; y < fine.extent[1]; ++y) {
      const std::uint32_t* const row =
          coarse.labels.data() + (std::size_t{z / 2} * coarse.extent[1] + y / 2) * coarse.extent[0];
      for (std::uint32_t x = 0; x < fine.extent[0]; ++x) *to++ = row[x / 2];
    }
}

void LabelLevels::copy_received(const Level& level, LabelGrid& to) {
  if (level.known == level.cubes) {
    to.labels = level.grid->labels;
    return;
  }
  if (level.known == 0) return;
  const auto [nx, ny, nz] = level.extent;
  const Extent cubes = level.order->cubes();
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t cube = 0; cube < cubes[0]; ++cube) {
        if (!level.received[number(level, {cube, y / kCubeEdge, z / kCubeEdge})]) continue;
        const std::size_t at = (std::size_t{z} * ny + y) * nx + std::size_t{cube} * kCubeEdge;
        std::copy_n(level.grid->labels.begin() + static_cast<std::ptrdiff_t>(at),
                    std::min(kCubeEdge, nx - cube * kCubeEdge), to.labels.begin() + static_cast<std::ptrdiff_t>(at));
      }
}

std::shared_ptr<const LabelGrid> LabelLevels::labels(int level, std::uint32_t none) const {
  level = std::clamp(level, 0, levels());
  // Levels above the coarsest whole one do not matter.
  int from = level;
  while (from < levels() && all_[static_cast<std::size_t>(from)].known < all_[static_cast<std::size_t>(from)].cubes)
    ++from;
  const Level& top = all_[static_cast<std::size_t>(from)];
  if (from == level && top.known == top.cubes) return top.grid;
  LabelGrid grid{top.extent, std::vector<std::uint32_t>(sample_count(top.extent), none)};
  copy_received(top, grid);
  for (int i = from - 1; i >= level; --i) {
    const Level& one = all_[static_cast<std::size_t>(i)];
    LabelGrid fine{one.extent, std::vector<std::uint32_t>(sample_count(one.extent))};
    refine(grid, fine);
    copy_received(one, fine);
    grid = std::move(fine);
  }
  return std::make_shared<const LabelGrid>(std::move(grid));
}

}  // namespace gs::qnv::values
