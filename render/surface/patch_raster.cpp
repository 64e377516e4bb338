#include "render/surface/patch_raster.h"

#include "qnv/base/parallel.h"
#include "render/surface/patch_prepare.h"
#include "render/surface/patch_screen.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <vector>

// Without fused multiplications and additions: a vertex that two patches share must come out the same in both.
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off")
#endif

namespace gs::render {
namespace {

constexpr std::size_t kTaskVertices = 32768;  // that one task prepares, about

/// The samples of one tile, row by row.
struct PatchTile {
  std::array<float, kTile * kTile> inverse;  // of the depth; 0: nothing
  std::array<glm::vec3, kTile * kTile> normal, color;
};

class PatchTileDrawing {
 public:
  PatchTileDrawing(int left, int bottom, const PatchGrid& grid, bool mirrors, bool colored, PatchTile& tile)
      : left_(left),
        bottom_(bottom),
        right_(std::min(left + kTile, grid.width) - 1),
        top_(std::min(bottom + kTile, grid.height) - 1),
        mirrors_(mirrors),
        colored_(colored),
        tile_(tile) {}

  void draw(const PatchTask& task, const ScreenTriangle& triangle) {
    std::array<std::uint32_t, 3> n = triangle.corners;
    const auto corner = [&](std::size_t k) -> const ScreenVertex& { return task.vertices[n[k]]; };
    const std::int64_t area = area_of(corner(0), corner(1), corner(2));
    if (area < 0) std::swap(n[1], n[2]);
    SampleBox box(corner(0), corner(1), corner(2));
    // Differences of less than 64 samples have products that fit 32 bits.
    const bool small = box.x1 - box.x0 < 60 && box.y1 - box.y0 < 60;
    box.limit(left_, right_, bottom_, top_);
    if (box.empty()) return;
    const Corners corners{{&corner(0), &corner(1), &corner(2)}, n, &task, (area < 0) != mirrors_};
    const float share = 1 / static_cast<float>(std::abs(area));
    if (small)
      fill<std::int32_t>(corners, share, box);
    else
      fill<std::int64_t>(corners, share, box);
  }

 private:
  struct Corners {
    std::array<const ScreenVertex*, 3> v;
    std::array<std::uint32_t, 3> numbers;
    const PatchTask* task;
    bool back;  // is seen
  };

  template <class Number>
  void fill(const Corners& t, float share, const SampleBox& box) {
    const Number x = static_cast<Number>(box.x0) * kSubsamples, y = static_cast<Number>(box.y0) * kSubsamples;
    EdgeFunction<Number> a(*t.v[1], *t.v[2], x, y), b(*t.v[2], *t.v[0], x, y), c(*t.v[0], *t.v[1], x, y);
    const glm::vec3 scale = share * glm::vec3(t.v[0]->inverse, t.v[1]->inverse, t.v[2]->inverse);
    for (int row = box.y0; row <= box.y1; ++row, a.at += a.up, b.at += b.up, c.at += c.up) {
      Number at_a = a.at, at_b = b.at, at_c = c.at;
      int sample = (row - bottom_) * kTile + box.x0 - left_;
      for (int column = box.x0; column <= box.x1;
           ++column, ++sample, at_a += a.right, at_b += b.right, at_c += c.right) {
        if (at_a < a.least || at_b < b.least || at_c < c.least) continue;
        const glm::vec3 weights = scale * glm::vec3(at_a, at_b, at_c);
        const float now = weights.x + weights.y + weights.z;
        float& nearest = tile_.inverse[static_cast<std::size_t>(sample)];
        if (now <= nearest) continue;
        nearest = now;
        write(t, weights, static_cast<std::size_t>(sample));
      }
    }
  }

  [[gnu::always_inline]] void write(const Corners& t, const glm::vec3& weights, std::size_t sample) {
    const glm::vec3 normal = qnv::unpack_direction(t.v[0]->normal) * weights.x +
                             qnv::unpack_direction(t.v[1]->normal) * weights.y +
                             qnv::unpack_direction(t.v[2]->normal) * weights.z;
    tile_.normal[sample] = t.back ? -normal : normal;
    if (!colored_) return;
    const auto color = [&](std::size_t k) { return unpacked_color(t.task->colors[t.numbers[k]]); };
    tile_.color[sample] =
        (color(0) * weights.x + color(1) * weights.y + color(2) * weights.z) / (weights.x + weights.y + weights.z);
  }

  int left_, bottom_, right_, top_;
  bool mirrors_, colored_;
  PatchTile& tile_;
};

/// The means of the samples of each pixel of a tile.
class PatchTileResolve {
 public:
  PatchTileResolve(const PatchTile& tile, const glm::mat3& normal_matrix, int left, int bottom, int supersample,
                   SplatLayer& layer)
      : tile_(tile),
        normal_matrix_(normal_matrix),
        left_(left / supersample),
        bottom_(bottom / supersample),
        supersample_(supersample),
        layer_(layer) {}

  void run() const {
    const int size = kTile / supersample_;
    for (int y = bottom_; y < std::min(bottom_ + size, layer_.height); ++y)
      for (int x = left_; x < std::min(left_ + size, layer_.width); ++x)
        pixel(x, y, static_cast<std::size_t>(y) * static_cast<std::size_t>(layer_.width) + static_cast<std::size_t>(x));
  }

 private:
  void pixel(int x, int y, std::size_t at) const {
    const bool colored = !layer_.colors.empty();
    glm::vec3 normal(0), color(0);
    float nearest = 0, covered = 0;
    const int first = (y - bottom_) * supersample_ * kTile + (x - left_) * supersample_;
    for (int v = 0; v < supersample_; ++v)
      for (int u = 0; u < supersample_; ++u) {
        const auto sample = static_cast<std::size_t>(first + v * kTile + u);
        const float inverse = tile_.inverse[sample];
        if (inverse == 0) continue;
        covered += 1;
        nearest = std::max(nearest, inverse);
        const glm::vec3& n = tile_.normal[sample];
        const float square = glm::dot(n, n);
        if (square > 0) normal += n * (1 / std::sqrt(square));
        if (colored) color += tile_.color[sample];
      }
    std::uint16_t* const out = layer_.normals.data() + 4 * at;
    if (covered == 0) {
      std::memset(out, 0, 8);
      layer_.depth[at] = 0;
      if (colored) std::memset(layer_.colors.data() + 4 * at, 0, 4);
      return;
    }
    layer_.depth[at] = 1 / nearest;
    normal = normal_matrix_ * normal;
    const float square = glm::dot(normal, normal);
    normal = square > 0 ? normal * (1 / std::sqrt(square)) : glm::vec3(0, 0, 1);
    const auto level = [](float v) {
      return static_cast<std::uint16_t>(std::clamp(v * 32767.5f + 32768, 0.0f, 65535.0f));
    };
    out[0] = level(normal.x);
    out[1] = level(normal.y);
    out[2] = level(normal.z);
    out[3] = static_cast<std::uint16_t>(65535 * covered / static_cast<float>(supersample_ * supersample_));
    if (!colored) return;
    color = color / covered + 0.5f;
    std::uint8_t* const rgb = layer_.colors.data() + 4 * at;
    for (int i = 0; i < 3; ++i) rgb[i] = static_cast<std::uint8_t>(std::min(color[i], 255.0f));
    rgb[3] = 0;
  }

  const PatchTile& tile_;
  const glm::mat3& normal_matrix_;
  int left_, bottom_, supersample_;
  SplatLayer& layer_;
};

/// A power of two that keeps the samples of an edge within the guard band.
int supersample_for(const SplatView& view) {
  int s = static_cast<int>(std::bit_floor(static_cast<unsigned>(std::clamp(view.supersample, 1, 8))));
  while (s > 1 && std::max(view.width, view.height) > kGuard / s) s /= 2;
  return s;
}

/// Kept from one picture to the next: fresh memory would cost as much as the vertices do.
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
  tasks.resize(used);  // what a larger picture left behind is given back
  return tasks;
}

}  // namespace

SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const SplatView& wanted,
                             const PatchRasterOptions& options) {
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
  const std::span<PatchTask> tasks = tasks_of(cut);
  qnv::parallel_for(
      tasks.size(), [&](std::size_t i) { prepare_patches(surface, cut, lens, grid, options, colored, tasks[i]); },
      view.threads);
  for (const PatchTask& task : tasks) {
    layer.discs += task.vertices.size();
    layer.drawn += task.triangles.size();
  }
  if (layer.drawn == 0) return layer;
  layer.width = view.width;
  layer.height = view.height;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layer.depth.resize(pixels);
  layer.normals.resize(4 * pixels);
  if (colored) layer.colors.resize(4 * pixels);
  qnv::parallel_for(
      grid.size(),
      [&](std::size_t t) {
        thread_local const auto tile = std::make_unique<PatchTile>();
        tile->inverse.fill(0);
        const int left = static_cast<int>(t) % grid.columns * kTile,
                  bottom = static_cast<int>(t) / grid.columns * kTile;
        PatchTileDrawing drawing(left, bottom, grid, lens.mirrors, colored, *tile);
        for (const PatchTask& task : tasks)
          for (std::uint32_t i = task.begin[t]; i < task.begin[t + 1]; ++i)
            drawing.draw(task, task.triangles[task.order[i]]);
        PatchTileResolve(*tile, camera->normal_matrix, left, bottom, view.supersample, layer).run();
      },
      view.threads);
  return layer;
}

}  // namespace gs::render
