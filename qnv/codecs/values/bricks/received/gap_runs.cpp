#include "qnv/codecs/values/bricks/received/gap_runs.h"

#include <algorithm>
#include <utility>

namespace gs::qnv::values {

bool GapRuns::add(CubeRun run) {
  const Extent cubes = cube_extent(extent_);
  const std::uint64_t all = std::uint64_t{cubes[0]} * cubes[1] * cubes[2];
  if (run.first >= all || run.count > all - run.first || run.count > 2 * all - cubes_) return false;
  const auto at = std::ranges::lower_bound(runs_, run.first, {}, &CubeRun::first);
  if (at != runs_.end() && (at->first == run.first || ++late_ > kMostLate)) return false;
  cubes_ += run.count;
  runs_.insert(at, std::move(run));
  return true;
}

bool GapRuns::mark(const SampleBox& box, std::int32_t number, std::span<std::int32_t> to) const {
  if (runs_.empty()) return false;
  const Extent cubes = cube_extent(extent_);
  const auto cube_of = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (std::uint64_t{z / kCubeEdge} * cubes[1] + y / kCubeEdge) * cubes[0] + x / kCubeEdge;
  };
  Extent last{};
  for (std::size_t a = 0; a < 3; ++a) last[a] = box.first[a] + box.size[a] - 1;
  const std::uint64_t first_cube = cube_of(box.first[0], box.first[1], box.first[2]),
                      last_cube = cube_of(last[0], last[1], last[2]);
  const auto write = [&](std::uint64_t cube, std::uint64_t missing) {
    if (missing == 0 || cube < first_cube || cube > last_cube) return;
    const Extent at{static_cast<std::uint32_t>(cube % cubes[0] * kCubeEdge),
                    static_cast<std::uint32_t>(cube / cubes[0] % cubes[1] * kCubeEdge),
                    static_cast<std::uint32_t>(cube / cubes[0] / cubes[1] * kCubeEdge)};
    Extent begin{}, end{};
    for (std::size_t a = 0; a < 3; ++a) {
      begin[a] = std::max(at[a], box.first[a]);
      end[a] = std::min(at[a] + kCubeEdge, last[a] + 1);
    }
    for (std::uint32_t z = begin[2]; z < end[2]; ++z)
      for (std::uint32_t y = begin[1]; y < end[1]; ++y)
        for (std::uint32_t x = begin[0]; x < end[0]; ++x)
          if ((missing >> ((x - at[0]) + kCubeEdge * ((y - at[1]) + kCubeEdge * (z - at[2]))) & 1) != 0)
            to[((z - box.first[2]) * std::size_t{box.size[1]} + (y - box.first[1])) * box.size[0] +
               (x - box.first[0])] = number;
  };
  for (const CubeRun& run : runs_) {
    if (run.first > last_cube) break;
    if (run.first + run.count <= first_cube) continue;
    // Runs follow rows of cubes. Those between two rows of the box do not touch it.
    bool touches = false;
    for (std::uint32_t z = box.first[2] / kCubeEdge; !touches && z <= last[2] / kCubeEdge; ++z)
      for (std::uint32_t y = box.first[1] / kCubeEdge; !touches && y <= last[1] / kCubeEdge; ++y) {
        const std::uint64_t row = cube_of(box.first[0], y * kCubeEdge, z * kCubeEdge),
                            end = row + (last[0] / kCubeEdge - box.first[0] / kCubeEdge) + 1;
        touches = run.first < end && run.first + run.count > row;
      }
    if (touches) (void)decode_gap_cubes(run, extent_, write);
  }
  return true;
}

}  // namespace gs::qnv::values
