#include "render/surface/patch_raster.h"

#include "base/parallel.h"
#include "render/surface/patch_kernel.h"
#include "render/surface/patch_prepare.h"
#include "render/surface/patch_screen.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::render {
namespace {

constexpr std::size_t kTaskVertices = 16384;  // approximate vertices per task

/// Tiles that contain samples.
struct UsedTiles {
  UsedTiles(std::span<const PatchTask> tasks, const PatchGrid& grid) : used(grid.size()) {
    left = grid.columns;
    bottom = grid.rows;
    for (std::size_t t = 0; t < used.size(); ++t) {
      for (const PatchTask& task : tasks)
        used[t] = used[t] || task.run_begin[t] < task.run_begin[t + 1] || task.begin[t] < task.begin[t + 1];
      if (!used[t]) continue;
      const int column = static_cast<int>(t) % grid.columns, row = static_cast<int>(t) / grid.columns;
      left = std::min(left, column);
      right = std::max(right, column + 1);
      bottom = std::min(bottom, row);
      top = std::max(top, row + 1);
    }
  }
  std::vector<char> used;
  int left, right = 0, bottom, top = 0;
};

/// Writes the samples of small triangles to a tile, if they are nearer than its samples.
void put_samples(const PatchTask& task, std::size_t number, bool colored, PatchTile& tile) {
  const SampleKey* const keys = task.keys.data();
  const std::uint32_t *const samples = task.samples.data(), *const colors = task.colors.data();
  for (std::uint32_t i = task.run_begin[number]; i < task.run_begin[number + 1]; ++i) {
    const SampleRun& run = task.runs[task.run_order[i]];
    for (std::size_t k = run.first; k < run.last; ++k) {
      const std::size_t at = samples[k] & (kTile * kTile - 1);
      SampleKey& nearest = tile.nearest[at];
      if (colored && keys[k] > nearest) tile.color[at] = colors[k];
      nearest = std::max(nearest, keys[k]);
    }
  }
}

/// Returns the supersampling: a power of two for which all samples are inside the guard band.
int supersample_for(const SplatView& view) {
  int s = static_cast<int>(std::bit_floor(static_cast<unsigned>(std::clamp(view.supersample, 1, 8))));
  while (s > 1 && std::max(view.width, view.height) > kGuard / s) s /= 2;
  return s;
}

/// Returns the tasks of an image. Reuses their memory for later images: new memory would take as long as preparing the
/// vertices.
std::span<PatchTask> tasks_of(const qnv::SurfaceCut& cut) {
  thread_local std::vector<PatchTask> tasks;
  std::size_t in_task = 0, used = 1;
  if (tasks.empty()) tasks.emplace_back();
  tasks[0].first = 0;
  for (std::size_t i = 0; i < cut.patches.size(); ++i) {
    const std::size_t count = qnv::patch_vertices(cut.patches[i].level);
    if (in_task > 0 && in_task + count > kTaskVertices) {
      tasks[used - 1].last = i;
      if (++used > tasks.size()) tasks.emplace_back();
      tasks[used - 1].first = i;
      in_task = 0;
    }
    in_task += count;
  }
  tasks[used - 1].last = cut.patches.size();
  tasks.resize(used);  // drop tasks of a larger image
  return tasks;
}

}  // namespace

SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const SplatView& view,
                             const PatchRasterOptions& options) {
  return rasterize_patches(surface, cut, view, options, patch_kernels().front());
}

SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const SplatView& wanted,
                             const PatchRasterOptions& options, const PatchKernel& kernel) {
  SplatLayer layer;
  SplatView view = wanted;
  view.supersample = supersample_for(wanted);
  if (cut.patches.empty() || view.width < 1 || view.height < 1 || std::max(view.width, view.height) > kGuard)
    return layer;
  const auto camera = splat_camera(view);
  if (!camera) return layer;
  const PatchLens lens(*camera, view);
  const PatchGrid grid(*camera);
  const bool colored =
      options.color_by != ColorBy::own ||
      std::any_of(surface.parts.begin(), surface.parts.end(), [](const auto& part) { return part->colored(); });
  const PatchLook look{options.two_sided, lens.mirrors, colored};
  const std::span<PatchTask> tasks = tasks_of(cut);
  parallel_for(
      tasks.size(), [&](std::size_t i) { prepare_patches(surface, cut, lens, grid, options, look, kernel, tasks[i]); },
      view.threads);
  for (const PatchTask& task : tasks) {
    layer.discs += task.vertices;
    layer.drawn += task.drawn;
  }
  const UsedTiles tiles(tasks, grid);
  if (tiles.right <= tiles.left) return layer;
  const int side = kTile / view.supersample;
  layer.x = tiles.left * side;
  layer.y = tiles.bottom * side;
  layer.width = std::min(tiles.right * side, view.width) - layer.x;
  layer.height = std::min(tiles.top * side, view.height) - layer.y;
  const auto pixels = static_cast<std::size_t>(layer.width) * static_cast<std::size_t>(layer.height);
  layer.depth.resize(pixels);
  layer.normals.resize(4 * pixels);
  if (colored) layer.colors.resize(4 * pixels);
  const SplatTarget target{layer.width,        layer.height,         view.supersample,
                           layer.depth.data(), layer.normals.data(), colored ? layer.colors.data() : nullptr};
  const int across = tiles.right - tiles.left;
  parallel_for(
      static_cast<std::size_t>(across) * static_cast<std::size_t>(tiles.top - tiles.bottom),
      [&](std::size_t i) {
        const int column = static_cast<int>(i) % across, row = static_cast<int>(i) / across;
        const auto t = static_cast<std::size_t>((tiles.bottom + row) * grid.columns + tiles.left + column);
        if (!tiles.used[t]) return kernel.leave_empty(column * kTile, row * kTile, target);
        thread_local const auto tile = std::make_unique<PatchTile>();
        tile->nearest.fill(0);
        for (const PatchTask& task : tasks) {
          put_samples(task, t, colored, *tile);
          for (std::uint32_t k = task.begin[t]; k < task.begin[t + 1]; ++k)
            kernel.draw_large(task.triangles[task.order[k]], (tiles.left + column) * kTile,
                              (tiles.bottom + row) * kTile, grid, look, *tile);
        }
        kernel.resolve(*tile, camera->normal_matrix, column * kTile, row * kTile, target);
      },
      view.threads);
  return layer;
}

}  // namespace gs::render
