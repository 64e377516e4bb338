#include "render/gaussians/gaussian_raster.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kProjectedRange = 8192;               // splats per projection task
constexpr std::size_t kMostEntries = std::size_t{1} << 22;  // of all tiles that are kept at once
constexpr unsigned kRadixDigitBits = 11, kRadixDigits = 1u << kRadixDigitBits;

/// Projects all splats, in tasks of kProjectedRange input splats.
ProjectedGaussians project_all(std::span<const GaussianItem> items, const SplatView& view) {
  struct Task {
    std::size_t item, first, last;
  };
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::size_t count = items[i].gaussians ? std::min(items[i].count, items[i].gaussians->size()) : 0;
    for (std::size_t first = 0; first < count; first += kProjectedRange)
      tasks.push_back({i, first, std::min(count, first + kProjectedRange)});
  }
  std::vector<ProjectedGaussians> parts(tasks.size());
  parallel_for(
      tasks.size(),
      [&](std::size_t t) { project_gaussians(items[tasks[t].item], view, tasks[t].first, tasks[t].last, parts[t]); },
      view.threads);
  ProjectedGaussians all;
  std::vector<std::size_t> starts, first_surfels;
  std::size_t count = 0, surfels = 0;
  for (const ProjectedGaussians& part : parts) {
    starts.push_back(count);
    first_surfels.push_back(surfels);
    count += part.splats.size();
    surfels += part.surfels.size();
  }
  all.splats.resize(count);
  all.distances.resize(count);
  all.surfels.resize(surfels);
  parallel_for(
      parts.size(),
      [&](std::size_t t) {
        for (GaussianSplat& splat : parts[t].splats)
          if (splat.surfel >= 0) splat.surfel += static_cast<std::int32_t>(first_surfels[t]);
        std::ranges::copy(parts[t].surfels, all.surfels.begin() + static_cast<std::ptrdiff_t>(first_surfels[t]));
        std::ranges::copy(parts[t].splats, all.splats.begin() + static_cast<std::ptrdiff_t>(starts[t]));
        std::ranges::copy(parts[t].distances, all.distances.begin() + static_cast<std::ptrdiff_t>(starts[t]));
        parts[t] = {};
      },
      view.threads);
  return all;
}

/// Returns the indexes of distances in ascending order; equal ones keep their order. Distances are at least 0.
std::vector<std::uint32_t> sorted(std::span<const float> distances) {
  const std::size_t count = distances.size();
  struct Entry {
    std::uint32_t key, index;
  };
  // The bits of positive floats, as integers, have the order of the floats.
  std::vector<Entry> entries(count), other(count);
  std::uint32_t least = 0xFFFFFFFFu, most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto key = std::bit_cast<std::uint32_t>(distances[i] + 0.0f);
    entries[i] = {key, static_cast<std::uint32_t>(i)};
    least = std::min(least, key);
    most = std::max(most, key);
  }
  const auto bits = count == 0 ? 0u : static_cast<unsigned>(std::bit_width(most - least));
  for (unsigned shift = 0; shift < bits; shift += kRadixDigitBits) {
    std::array<std::uint32_t, kRadixDigits> places{};
    for (const Entry& entry : entries) ++places[(entry.key - least) >> shift & (kRadixDigits - 1)];
    std::uint32_t next = 0;
    for (auto& place : places) next += std::exchange(place, next);
    for (const Entry& entry : entries) other[places[(entry.key - least) >> shift & (kRadixDigits - 1)]++] = entry;
    entries.swap(other);
  }
  std::vector<std::uint32_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = entries[i].index;
  return order;
}

/// Tiles that a splat touches.
struct TileRange {
  int left, right, bottom, top;  // inclusive
};

/// Draws sorted splats: gives tiles lists of their splats in batches, from near to far, and blends them.
class GaussianPainter {
 public:
  GaussianPainter(const ProjectedGaussians& all, std::span<const std::uint32_t> order, const SplatView& view,
                  const VolumeStops& stops)
      : splats_(all.splats),
        surfels_(all.surfels),
        order_(order),
        view_(view),
        stops_(stops),
        columns_((view.width + kGaussianTile - 1) / kGaussianTile),
        rows_((view.height + kGaussianTile - 1) / kGaussianTile),
        tiles_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  VolumeLayer paint() {
    VolumeLayer layer;
    layer.width = view_.width;
    layer.height = view_.height;
    layer.vectors = splats_.size();
    const std::size_t pixels = static_cast<std::size_t>(view_.width) * static_cast<std::size_t>(view_.height);
    layer.pixels.assign(4 * pixels, 0);
    layer.depth.assign(pixels, 0);
    if (!paint_to(layer.pixels, &layer.depth, stops_.far.empty() ? stops_.near : stops_.far)) return {};
    if (!stops_.far.empty() && !std::ranges::equal(stops_.near, stops_.far)) {
      layer.edge_pixels.assign(4 * pixels, 0);
      (void)paint_to(layer.edge_pixels, nullptr, stops_.near);
    }
    return layer;
  }

 private:
  [[nodiscard]] TileRange tiles_of(const GaussianSplat& splat) const {
    const auto tile = [](float pixel, int count) {
      return static_cast<int>(std::clamp(std::floor(pixel / kGaussianTile), 0.0f, static_cast<float>(count - 1)));
    };
    return {tile(splat.x - splat.reach_x, columns_), tile(splat.x + splat.reach_x, columns_),
            tile(splat.y - splat.reach_y, rows_), tile(splat.y + splat.reach_y, rows_)};
  }

  /// Calls use(tile) for each tile that the splat's ellipse may touch and that is not opaque.
  template <class Use>
  void for_tiles(const GaussianSplat& splat, const Use& use) const {
    const TileRange range = tiles_of(splat);
    const float inside = splat.peak - kGaussianLeastPower, narrow = 1 / splat.xx;
    for (int row = range.bottom; row <= range.top; ++row) {
      int left = range.left, right = range.right;
      if (splat.surfel < 0 && right - left > 1 && range.top > range.bottom) {
        // The extent of the ellipse between the rows: at the tangent point if it lies between, else at a border.
        const float low = static_cast<float>(row * kGaussianTile) - 1 - splat.y, high = low + kGaussianTile + 1;
        const float turn = splat.xy * narrow;
        const auto border = [&](float dy, float& from, float& to) {
          const float square = splat.xy * splat.xy * dy * dy - splat.xx * (splat.yy * dy * dy - inside);
          if (!(square >= 0)) return;
          const float half = std::sqrt(square) * narrow;
          from = std::min(from, -turn * dy - half);
          to = std::max(to, -turn * dy + half);
        };
        float from = std::numeric_limits<float>::max(), to = -from;
        border(low, from, to);
        border(high, from, to);
        // The points farthest left and right have dy = -xy / yy dx at dx = -reach and reach.
        const float at_right = -splat.xy / splat.yy * splat.reach_x;
        if (at_right >= low && at_right <= high) to = splat.reach_x;
        if (-at_right >= low && -at_right <= high) from = -splat.reach_x;
        if (from > to) continue;
        left = std::max(left, static_cast<int>(std::floor((splat.x + from - 1) / kGaussianTile)));
        right = std::min(right, static_cast<int>(std::floor((splat.x + to + 1) / kGaussianTile)));
      }
      for (int column = left; column <= right; ++column) {
        const auto tile =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
        if (open_[tile]) use(tile);
      }
    }
  }

  bool paint_to(std::vector<std::uint8_t>& pixels, std::vector<float>* depths, std::span<const float> stops) {
    const std::size_t tiles = tiles_;
    open_.assign(tiles, 1);
    states_.resize(tiles);
    bool any = false;
    for (std::size_t first = 0; first < order_.size();) {
      // A batch is as many splats as fit into the entries. Parts of it are counted and listed at the same time.
      constexpr std::size_t kParts = 8;
      std::size_t last = first, entries = 0;
      std::vector<std::uint32_t> counts;
      std::array<std::size_t, kParts + 1> ends{};
      last = std::min(order_.size(), first + kMostEntries / 4);
      while (true) {
        const std::size_t size = last - first;
        for (std::size_t p = 0; p <= kParts; ++p) ends[p] = first + size * p / kParts;
        counts.assign(kParts * tiles, 0);
        parallel_for(
            kParts,
            [&](std::size_t p) {
              std::uint32_t* const own = counts.data() + p * tiles;
              for (std::size_t i = ends[p]; i < ends[p + 1]; ++i)
                for_tiles(splats_[order_[i]], [&](std::size_t tile) { ++own[tile]; });
            },
            view_.threads);
        entries = 0;
        for (const std::uint32_t count : counts) entries += count;
        if (entries <= kMostEntries || size < 2 * kParts) break;
        last = first + std::max<std::size_t>(1, size * (kMostEntries / 2) / entries);
      }
      std::vector<std::uint32_t> begins(tiles + 1, 0);
      std::uint32_t next = 0;
      for (std::size_t tile = 0; tile < tiles; ++tile) {
        begins[tile] = next;
        for (std::size_t p = 0; p < kParts; ++p) next += std::exchange(counts[p * tiles + tile], next);
      }
      begins[tiles] = next;
      std::vector<std::uint32_t> listed(next);
      parallel_for(
          kParts,
          [&](std::size_t p) {
            std::uint32_t* const own = counts.data() + p * tiles;
            for (std::size_t i = ends[p]; i < ends[p + 1]; ++i)
              for_tiles(splats_[order_[i]], [&](std::size_t tile) { listed[own[tile]++] = order_[i]; });
          },
          view_.threads);
      any = any || next > 0;
      parallel_for(
          tiles,
          [&](std::size_t tile) {
            const std::span<const std::uint32_t> own(listed.data() + begins[tile], begins[tile + 1] - begins[tile]);
            if (!own.empty()) blend(tile, own, stops);
          },
          view_.threads);
      first = last;
    }
    if (!any) return false;
    parallel_for(
        tiles, [&](std::size_t tile) { write(tile, pixels, depths); }, view_.threads);
    return true;
  }

  void blend(std::size_t tile, std::span<const std::uint32_t> order, std::span<const float> stops) {
    const int left = static_cast<int>(tile % static_cast<std::size_t>(columns_)) * kGaussianTile,
              bottom = static_cast<int>(tile / static_cast<std::size_t>(columns_)) * kGaussianTile;
    if (!states_[tile]) {
      states_[tile] = std::make_unique<GaussianTile>();
      states_[tile]->clear_pixels();
      for (int row = 0; !stops.empty() && row < kGaussianTile; ++row)
        for (int column = 0; column < kGaussianTile; ++column)
          states_[tile]->stop[static_cast<std::size_t>(row * kGaussianTile + column)] =
              stops[static_cast<std::size_t>(std::min(bottom + row, view_.height - 1)) *
                        static_cast<std::size_t>(view_.width) +
                    static_cast<std::size_t>(std::min(left + column, view_.width - 1))];
    }
    GaussianTile& state = *states_[tile];
    const GaussianKernel& kernel = gaussian_kernel();
    (stops.empty() ? kernel.tile : kernel.stopped_tile)({splats_.data(), surfels_.data()}, order, left, bottom, state);
    if (state.open == 0) open_[tile] = 0;
  }

  void write(std::size_t tile, std::vector<std::uint8_t>& pixels, std::vector<float>* depths) {
    if (!states_[tile]) return;
    const GaussianTile& state = *states_[tile];
    const int left = static_cast<int>(tile % static_cast<std::size_t>(columns_)) * kGaussianTile,
              bottom = static_cast<int>(tile / static_cast<std::size_t>(columns_)) * kGaussianTile;
    const auto byte = [](float v) { return static_cast<std::uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255 + 0.5f); };
    for (int row = 0; row < std::min(kGaussianTile, view_.height - bottom); ++row)
      for (int column = 0; column < std::min(kGaussianTile, view_.width - left); ++column) {
        const auto from = static_cast<std::size_t>(row * kGaussianTile + column);
        const std::size_t to = static_cast<std::size_t>(bottom + row) * static_cast<std::size_t>(view_.width) +
                               static_cast<std::size_t>(left + column);
        pixels[4 * to] = byte(state.red[from]);
        pixels[4 * to + 1] = byte(state.green[from]);
        pixels[4 * to + 2] = byte(state.blue[from]);
        pixels[4 * to + 3] = byte(1 - state.clear[from]);
        if (depths) (*depths)[to] = state.depth[from];
      }
    states_[tile].reset();
  }

  std::span<const GaussianSplat> splats_;
  std::span<const GaussianSurfel> surfels_;
  std::span<const std::uint32_t> order_;
  const SplatView& view_;
  const VolumeStops& stops_;
  int columns_, rows_;
  std::size_t tiles_;
  std::vector<std::uint8_t> open_;  // per tile; not bits, because threads write neighbours
  std::vector<std::unique_ptr<GaussianTile>> states_;
};

}  // namespace

VolumeLayer rasterize_gaussians(std::span<const GaussianItem> items, const SplatView& view, const VolumeStops& stops) {
  if (view.width <= 0 || view.height <= 0) return {};
  ProjectedGaussians projected = project_all(items, view);
  if (projected.splats.empty()) return {};
  const std::vector<std::uint32_t> order = sorted(projected.distances);
  float least = std::numeric_limits<float>::max();
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    least = std::min(least, projected.splats[*i].depth);
    projected.splats[*i].least_depth = least;
  }
  return GaussianPainter(projected, order, view, stops).paint();
}

}  // namespace gs::render
