#include "render/gaussians/gaussian_raster.h"

#include "base/parallel.h"
#include "render/gaussians/gaussian_arrays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kProjectedRange = 8192;                       // splats per projection task
constexpr std::size_t kListedRange = 4096, kLeastListedRange = 64;  // splats per task that makes lists of regions
constexpr std::size_t kMostCounts = std::size_t{1} << 22;           // counts of entries (one per region and range)
constexpr std::size_t kMostEntries = std::size_t{1} << 21;          // entries in the lists of all regions, per batch
constexpr int kRegionTiles = 4;                                     // tiles along the side of a region
constexpr int kRegion = kRegionTiles * kGaussianTile;               // pixels along the side of a region
constexpr std::size_t kPrefetched = 16;                             // splats between a prefetch and its use
constexpr std::size_t kGatheredSplats = 512;                        // splats of a region to blend together
constexpr std::uint32_t kFirstColumn = 0x1111;                      // bits of the first tile in each row of a region
static_assert(kRegionTiles == 4);

TileRange tiles_of(const GaussianSplat& splat, const SplatView& view) {
  const auto tile = [](float pixel, int count) {
    return static_cast<std::uint16_t>(static_cast<int>(std::clamp(pixel, 0.0f, static_cast<float>(count - 1))) /
                                      kGaussianTile);
  };
  return {tile(splat.left, view.width), tile(splat.right, view.width), tile(splat.bottom, view.height),
          tile(splat.top, view.height)};
}

/// Projects all splats, in tasks of kProjectedRange input splats. A task may have splats of several items. Returns the
/// number of tasks. Keeps further parts, so that a later picture with more splats reuses them.
std::size_t project_all(std::span<const GaussianItem> items, const SplatView& view, std::vector<ProjectedPart>& parts) {
  struct Run {
    std::size_t item, first, last;
  };
  std::vector<Run> runs;
  std::vector<std::size_t> tasks{0};  // first run of each task, then the end
  std::size_t listed = 0;             // input splats of the last task so far
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::size_t count = items[i].gaussians ? std::min(items[i].count, items[i].gaussians->size()) : 0;
    for (std::size_t first = 0, last = 0; first < count; first = last) {
      last = std::min(count, first + kProjectedRange - listed);
      runs.push_back({i, first, last});
      listed += last - first;
      if (listed < kProjectedRange) continue;
      tasks.push_back(runs.size());
      listed = 0;
    }
  }
  if (listed > 0) tasks.push_back(runs.size());
  const std::size_t count = tasks.size() - 1;
  if (parts.size() < count) parts.resize(count);
  parallel_for(
      count,
      [&](std::size_t t) {
        ProjectedPart& part = parts[t];
        part.clear();
        for (std::size_t run = tasks[t]; run < tasks[t + 1]; ++run)
          project_gaussians(items[runs[run].item], view, runs[run].first, runs[run].last, part.projected);
        part.places.reserve(part.projected.splats.size());
        auto index = static_cast<std::uint32_t>(t * kProjectedRange);
        for (const GaussianSplat& splat : part.projected.splats)
          part.places.push_back({tiles_of(splat, view), splat.depth, index++});
      },
      view.threads);
  return count;
}

KeptGaussianArrays& kept_arrays() {
  static KeptGaussianArrays kept;
  return kept;
}

/// Sorts the splats by ascending distance from the eye. The sort is stable.
void put_in_order(GaussianArrays& arrays, const SplatView& view) {
  const std::span<const ProjectedPart> parts = std::span(arrays.parts).first(arrays.used_parts);
  std::vector<GaussianKey>& keys = arrays.keys;
  std::vector<PlacedGaussian>& ordered = arrays.ordered;
  std::vector<std::size_t> starts;
  std::size_t count = 0;
  for (const ProjectedPart& part : parts) {
    starts.push_back(count);
    count += part.places.size();
  }
  keys.resize(count);
  parallel_for(
      parts.size(),
      [&](std::size_t p) {
        GaussianKey* to = keys.data() + starts[p];
        auto index = static_cast<std::uint32_t>(p * kProjectedRange);
        // The bits of positive floats, as integers, have the order of the floats. Distances are at least 0.
        for (const float distance : parts[p].projected.distances)
          *to++ = {std::bit_cast<std::uint32_t>(distance + 0.0f), index++};
      },
      view.threads);
  sort_gaussians(keys, arrays.moved_keys, view.threads);
  ordered.resize(count);
  parallel_for((count + kListedRange - 1) / kListedRange,
               [&](std::size_t t) {
                 const std::size_t last = std::min(count, (t + 1) * kListedRange);
                 const auto place_of = [&](std::size_t i) {
                   const std::uint32_t index = keys.data()[i].index;
                   return parts.data()[index / kProjectedRange].places.data() + index % kProjectedRange;
                 };
                 for (std::size_t i = t * kListedRange; i < last; ++i) {
                   __builtin_prefetch(place_of(std::min(i + kPrefetched, last - 1)));
                   ordered.data()[i] = *place_of(i);
                 }
               },
               view.threads);
}

/// Sets the least depths of all splats.
void set_least_depths(std::span<ProjectedPart> parts, std::span<const PlacedGaussian> ordered) {
  float least = std::numeric_limits<float>::max();
  for (auto place = ordered.rbegin(); place != ordered.rend(); ++place) {
    least = std::min(least, place->depth);
    parts[place->index / kProjectedRange].projected.splats[place->index % kProjectedRange].least_depth = least;
  }
}

/// Pixels of a region. The index of a tile is kRegionTiles * row + column.
struct GaussianRegion {
  static constexpr std::size_t kTiles = std::size_t{kRegionTiles} * kRegionTiles;
  std::array<GaussianTile, kTiles> tiles;
  std::uint32_t open = (1u << kTiles) - 1, used = 0;  // one bit per tile
};

/// Draws ordered splats: gives regions lists of their splats in batches, from near to far, and blends them.
class GaussianPainter {
 public:
  GaussianPainter(GaussianArrays& arrays, const SplatView& view, const VolumeStops& stops, bool with_depths)
      : parts_(arrays.parts),
        ordered_(arrays.ordered),
        counts_(arrays.counts),
        listed_(arrays.listed),
        view_(view),
        stops_(stops),
        with_depths_(with_depths),
        columns_((view.width + kRegion - 1) / kRegion),
        regions_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>((view.height + kRegion - 1) / kRegion)),
        range_(std::clamp(kMostEntries / regions_, kLeastListedRange, kListedRange)),
        ranges_((ordered_.size() + range_ - 1) / range_) {}

  VolumeLayer paint() {
    VolumeLayer layer;
    layer.width = view_.width;
    layer.height = view_.height;
    layer.vectors = ordered_.size();
    layer.used = used_box();
    const std::size_t pixels = static_cast<std::size_t>(view_.width) * static_cast<std::size_t>(view_.height);
    layer.pixels.assign(4 * pixels, 0);
    if (with_depths_) layer.depth.assign(pixels, 0);
    paint_to(layer.pixels, with_depths_ ? layer.depth.data() : nullptr, stops_.far.empty() ? stops_.near : stops_.far);
    if (!stops_.far.empty() && !std::ranges::equal(stops_.near, stops_.far)) {
      layer.edge_pixels.assign(4 * pixels, 0);
      paint_to(layer.edge_pixels, nullptr, stops_.near);
    }
    return layer;
  }

 private:
  /// Returns the box of the tiles that splats touch.
  [[nodiscard]] PixelBox used_box() const {
    TileRange all{0xFFFF, 0, 0xFFFF, 0};
    for (const PlacedGaussian& place : ordered_)
      all = {std::min(all.left, place.tiles.left), std::max(all.right, place.tiles.right),
             std::min(all.bottom, place.tiles.bottom), std::max(all.top, place.tiles.top)};
    const int left = all.left * kGaussianTile, bottom = all.bottom * kGaussianTile;
    return {left, bottom, std::min((all.right + 1) * kGaussianTile, view_.width) - left,
            std::min((all.top + 1) * kGaussianTile, view_.height) - bottom};
  }

  /// Calls use(region, row, column) for each region that a splat may touch.
  template <class Use>
  void for_regions(const TileRange& tiles, const Use& use) const {
    for (int row = tiles.bottom / kRegionTiles; row <= tiles.top / kRegionTiles; ++row)
      for (int column = tiles.left / kRegionTiles; column <= tiles.right / kRegionTiles; ++column)
        use(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column), row,
            column);
  }

  /// Returns the part of the tiles `first` to `last` in a region, as tile numbers of that region. Works along one axis.
  static std::pair<std::uint8_t, std::uint8_t> inside(int region, int first, int last) {
    return {static_cast<std::uint8_t>(std::max(first - region * kRegionTiles, 0)),
            static_cast<std::uint8_t>(std::min(last - region * kRegionTiles, kRegionTiles - 1))};
  }

  /// Calls work(first, last, counts) for each of the ranges first_range to last_range - 1, with its splats and counts.
  template <class Work>
  void for_ranges(std::size_t first_range, std::size_t last_range, const Work& work) {
    parallel_for(
        last_range - first_range,
        [&](std::size_t r) {
          const std::size_t range = first_range + r;
          work(range * range_, std::min(ordered_.size(), (range + 1) * range_), counts_of(range));
        },
        view_.threads);
  }

  /// Returns the number of splats in each region, for a counted range.
  [[nodiscard]] std::uint32_t* counts_of(std::size_t range) const {
    return counts_.data() + (range - counted_from_) * regions_;
  }

  /// Counts the splats in each region, for as many ranges from `first` on as fit into kMostCounts.
  void count_entries(std::size_t first) {
    counted_from_ = first;
    counted_to_ = std::min(ranges_, first + std::max<std::size_t>(1, kMostCounts / regions_));
    counts_.assign((counted_to_ - first) * regions_, 0);
    for_ranges(first, counted_to_, [&](std::size_t from, std::size_t to, std::uint32_t* counts) {
      for (std::size_t i = from; i < to; ++i)
        for_regions(ordered_.data()[i].tiles, [&](std::size_t region, int, int) { ++counts[region]; });
    });
  }

  void paint_to(std::vector<std::uint8_t>& pixels, float* depths, std::span<const float> stops) {
    states_.clear();
    states_.resize(regions_);
    for (std::size_t first = 0; first < ranges_;) {
      // A batch has as many ranges as fit into kMostEntries, but at least one.
      std::size_t last = first, entries = 0;
      if (first < counted_from_ || first >= counted_to_) count_entries(first);
      while (last < counted_to_) {
        const std::uint32_t* const counts = counts_of(last);
        const std::size_t more = std::accumulate(counts, counts + regions_, std::size_t{0});
        if (last > first && entries + more > kMostEntries) break;
        entries += more;
        ++last;
      }
      paint_batch(first, last, entries, {pixels.data(), depths, stops});
      first = last;
    }
  }

  struct Target {
    std::uint8_t* pixels;
    float* depths;  // may be null
    std::span<const float> stops;
  };

  /// Blends the splats of ranges first to last - 1. Writes the pixels if no ranges follow.
  void paint_batch(std::size_t first, std::size_t last, std::size_t entries, const Target& target) {
    std::vector<std::uint32_t> begins(regions_ + 1), places((last - first) * regions_);
    std::uint32_t next = 0;
    for (std::size_t region = 0; region < regions_; ++region) {
      begins[region] = next;
      for (std::size_t range = first; range < last; ++range) {
        places[(range - first) * regions_ + region] = next;
        next += counts_of(range)[region];
      }
    }
    begins[regions_] = next;
    listed_.resize(entries);
    for_ranges(first, last, [&](std::size_t from, std::size_t to, const std::uint32_t*) {
      std::uint32_t* const own = places.data() + (from / range_ - first) * regions_;
      for (std::size_t i = from; i < to; ++i) {
        const PlacedGaussian& place = ordered_.data()[i];
        for_regions(place.tiles, [&](std::size_t region, int row, int column) {
          const auto [left, right] = inside(column, place.tiles.left, place.tiles.right);
          const auto [bottom, top] = inside(row, place.tiles.bottom, place.tiles.top);
          listed_.data()[own[region]++] = {place.index, left, right, bottom, top};
        });
      }
    });
    // Blends long lists first, so that all threads end at nearly the same time.
    std::vector<std::uint32_t> sequence(regions_);
    std::iota(sequence.begin(), sequence.end(), 0u);
    std::ranges::stable_sort(sequence, std::greater{},
                             [&](std::uint32_t region) { return begins[region + 1] - begins[region]; });
    parallel_for(
        regions_,
        [&](std::size_t i) {
          const std::size_t region = sequence[i];
          const std::span<const ListedGaussian> list(listed_.data() + begins[region],
                                                     begins[region + 1] - begins[region]);
          std::unique_ptr<GaussianRegion>& kept = states_[region];
          if (!kept && list.empty()) return;
          if (!kept && first == 0 && last == ranges_) {
            GaussianRegion state;
            blend(region, list, target, state);
            write(region, state, target);
            return;
          }
          if (!kept) kept = std::make_unique_for_overwrite<GaussianRegion>();
          blend(region, list, target, *kept);
          if (last < ranges_) return;
          write(region, *kept, target);
          kept.reset();
        },
        view_.threads);
  }

  [[nodiscard]] const GaussianSplat* splat_of(std::uint32_t index) const {
    return parts_.data()[index / kProjectedRange].projected.splats.data() + index % kProjectedRange;
  }

  /// Returns the tiles of a region that a splat touches, one bit each.
  static std::uint32_t tiles_of(const ListedGaussian& listed) {
    const std::uint32_t columns = (2u << listed.right) - (1u << listed.left),
                        rows = (0x10u << kRegionTiles * listed.top) - (1u << kRegionTiles * listed.bottom);
    return rows & columns * kFirstColumn;
  }

  void blend(std::size_t region, std::span<const ListedGaussian> list, const Target& target,
             GaussianRegion& state) const {
    const int left = static_cast<int>(region % static_cast<std::size_t>(columns_)) * kRegion,
              bottom = static_cast<int>(region / static_cast<std::size_t>(columns_)) * kRegion;
    const GaussianKernel& kernel = gaussian_kernel();
    const auto draw = target.stops.empty() ? kernel.tile : kernel.stopped_tile;
    std::array<GaussianSplat, kGatheredSplats> splats;
    std::vector<GaussianSurfel> surfels;
    std::array<std::array<std::uint16_t, kGatheredSplats>, GaussianRegion::kTiles> orders;
    for (std::size_t next = 0; next < list.size() && state.open != 0;) {
      std::array<std::size_t, GaussianRegion::kTiles> counts{};
      surfels.clear();
      for (std::size_t size = 0; next < list.size() && size < kGatheredSplats; ++next) {
        const ListedGaussian& ahead = list.data()[std::min(next + kPrefetched, list.size() - 1)];
        if ((tiles_of(ahead) & state.open) != 0) __builtin_prefetch(splat_of(ahead.index));
        const ListedGaussian& listed = list.data()[next];
        std::uint32_t open = tiles_of(listed) & state.open;
        if (open == 0) continue;
        GaussianSplat& splat = splats.data()[size];
        splat = *splat_of(listed.index);
        if (splat.surfel >= 0) {
          surfels.push_back(
              parts_[listed.index / kProjectedRange].projected.surfels[static_cast<std::size_t>(splat.surfel)]);
          splat.surfel = static_cast<std::int32_t>(surfels.size() - 1);
        }
        for (; open != 0; open &= open - 1) {
          const int tile = std::countr_zero(open);
          orders.data()[tile].data()[counts.data()[tile]++] = static_cast<std::uint16_t>(size);
        }
        ++size;
      }
      for (std::size_t tile = 0; tile < GaussianRegion::kTiles; ++tile) {
        if (counts[tile] == 0) continue;
        const int x = left + static_cast<int>(tile) % kRegionTiles * kGaussianTile,
                  y = bottom + static_cast<int>(tile) / kRegionTiles * kGaussianTile;
        if ((state.used >> tile & 1) == 0) begin(state.tiles[tile], x, y, target);
        state.used |= 1u << tile;
        draw({splats.data(), surfels.data()}, {orders[tile].data(), counts[tile]}, x, y, state.tiles[tile]);
        if (state.tiles[tile].open == 0) state.open &= ~(1u << tile);
      }
    }
  }

  /// Clears a tile with the lower left pixel (left, bottom), and sets its stops.
  void begin(GaussianTile& tile, int left, int bottom, const Target& target) const {
    tile.clear_pixels();
    tile.with_depths = target.depths != nullptr;
    const std::span<const float> stops = target.stops;
    for (int y = 0; !stops.empty() && y < kGaussianTile; ++y)
      for (int x = 0; x < kGaussianTile; ++x)
        tile.blocks[GaussianTile::block_of(x, y)].channel(GaussianBlock::kStop)[GaussianTile::lane_of(x, y)] =
            stops[static_cast<std::size_t>(std::min(bottom + y, view_.height - 1)) *
                      static_cast<std::size_t>(view_.width) +
                  static_cast<std::size_t>(std::min(left + x, view_.width - 1))];
  }

  void write(std::size_t region, const GaussianRegion& state, const Target& target) const {
    const int left = static_cast<int>(region % static_cast<std::size_t>(columns_)) * kRegion,
              bottom = static_cast<int>(region / static_cast<std::size_t>(columns_)) * kRegion;
    const auto pitch = static_cast<std::size_t>(view_.width);
    const GaussianKernel& kernel = gaussian_kernel();
    for (std::size_t tile = 0; tile < GaussianRegion::kTiles; ++tile) {
      if ((state.used >> tile & 1) == 0) continue;
      const int x = left + static_cast<int>(tile) % kRegionTiles * kGaussianTile,
                y = bottom + static_cast<int>(tile) / kRegionTiles * kGaussianTile;
      const std::size_t to = static_cast<std::size_t>(y) * pitch + static_cast<std::size_t>(x);
      const auto width = static_cast<std::size_t>(std::min(kGaussianTile, view_.width - x)),
                 height = static_cast<std::size_t>(std::min(kGaussianTile, view_.height - y));
      constexpr std::size_t kWhole = kGaussianTile;
      if (width == kWhole && height == kWhole) {
        kernel.write(state.tiles[tile], target.pixels + 4 * to, target.depths ? target.depths + to : nullptr, pitch);
        continue;
      }
      std::array<std::uint8_t, 4 * kWhole * kWhole> whole;
      std::array<float, kWhole * kWhole> whole_depths;
      kernel.write(state.tiles[tile], whole.data(), whole_depths.data(), kWhole);
      for (std::size_t row = 0; row < height; ++row) {
        std::copy_n(whole.data() + 4 * row * kWhole, 4 * width, target.pixels + 4 * (to + row * pitch));
        if (target.depths) std::copy_n(whole_depths.data() + row * kWhole, width, target.depths + to + row * pitch);
      }
    }
  }

  std::span<const ProjectedPart> parts_;
  std::span<const PlacedGaussian> ordered_;
  std::vector<std::uint32_t>& counts_;
  std::vector<ListedGaussian>& listed_;
  const SplatView& view_;
  const VolumeStops& stops_;
  bool with_depths_;
  int columns_;
  std::size_t regions_, range_, ranges_;           // number of regions, splats per range, number of ranges
  std::size_t counted_from_ = 0, counted_to_ = 0;  // ranges with counts
  std::vector<std::unique_ptr<GaussianRegion>> states_;
};

}  // namespace

VolumeLayer rasterize_gaussians(std::span<const GaussianItem> items, const SplatView& view, const VolumeStops& stops,
                                bool with_depths) {
  if (view.width <= 0 || view.height <= 0) return {};
  std::unique_ptr<GaussianArrays> arrays = kept_arrays().take();
  arrays->used_parts = project_all(items, view, arrays->parts);
  put_in_order(*arrays, view);
  VolumeLayer layer;
  if (!arrays->ordered.empty()) {
    if (!stops.near.empty()) set_least_depths(arrays->parts, arrays->ordered);
    layer = GaussianPainter(*arrays, view, stops, with_depths).paint();
  }
  kept_arrays().give_back(std::move(arrays));
  return layer;
}

void note_picture_without_gaussians() { kept_arrays().note_idle(); }

}  // namespace gs::render
