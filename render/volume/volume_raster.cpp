#include "render/volume/volume_raster.h"

#include "base/parallel.h"
#include "render/volume/volume_lens.h"
#include "render/volume/volume_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kPreparedRange = 16384;              // vectors per preparation task
constexpr std::size_t kMaxEntries = std::size_t{1} << 22;  // maximum tile entries that are sorted at once
constexpr unsigned kDepthDigitBits = 11, kDepthDigits = 1u << kDepthDigitBits;

/// Prepares the vectors of a volume that are in view.
class Preparer {
 public:
  /// Prepares for an item, which must have a volume and a model.
  Preparer(const VolumeItem& item, const SplatView& view)
      : volume_(*item.volume), model_(*item.model), near_plane_(view.near_plane), options_(item.options) {
    const std::optional<VolumeLens> lens = volume_lens(view, item.camera_from_node);
    if (!lens) return;
    lens_ = *lens;
    count_ = std::min({item.count, volume_.size(), model_.spacing.size()});
  }

  /// Returns the number of vectors to examine. Returns 0 if nothing is visible.
  [[nodiscard]] std::size_t count() const { return count_; }

  void run(std::size_t first, std::size_t last, std::vector<VolumeSplat>& out) const {
    for (std::size_t i = first; i < last; ++i) {
      VolumeSplat splat;
      if (!place(i, splat)) continue;
      shade(i, splat);
      out.push_back(splat);
    }
  }

  /// Computes the splat of a vector, except its colour. Returns false if the vector is invisible.
  bool place(std::size_t i, VolumeSplat& splat) const {
    splat.alpha = volume_alpha(volume_, model_, options_, i);
    if (!(splat.alpha >= kVolumeLeastAlpha)) return false;
    const glm::vec3 seen(lens_.camera_from_node * glm::vec4(volume_.positions[i], 1.0f));
    splat.depth = -seen.z;
    const float spacing = model_.spacing[i] * lens_.scale;
    if (!(splat.depth > near_plane_ && splat.depth > spacing)) return false;
    const float near = 1 / splat.depth;
    const float pixels = std::sqrt(lens_.pixels_x * lens_.pixels_y) * near;
    float area = kVolumeFootprint * spacing * spacing * pixels * pixels;
    if (area < kVolumePixel) {
      splat.alpha *= area / kVolumePixel;
      area = kVolumePixel;
      if (!(splat.alpha >= kVolumeLeastAlpha)) return false;
    }
    splat.reach = kVolumeCut * std::sqrt(area);
    splat.x = seen.x * near * lens_.pixels_x + lens_.middle_x - 0.5f;
    splat.y = seen.y * near * lens_.pixels_y + lens_.middle_y - 0.5f;
    if (!(splat.x + splat.reach >= 0 && splat.y + splat.reach >= 0)) return false;
    if (!(splat.x - splat.reach <= static_cast<float>(lens_.width - 1)) ||
        !(splat.y - splat.reach <= static_cast<float>(lens_.height - 1)) || !std::isfinite(splat.reach))
      return false;
    return true;
  }

 private:
  void shade(std::size_t i, VolumeSplat& splat) const {
    const glm::vec3 seen(lens_.camera_from_node * glm::vec4(volume_.positions[i], 1.0f));
    const glm::vec3 color = volume_shade(options_, volume_color(volume_, model_, options_, i), seen,
                                         lens_.normal_matrix * volume_.normals[i]);
    const auto byte = [](float c) { return static_cast<std::uint32_t>(c * 255 + 0.5f); };
    splat.color = byte(color.x) | byte(color.y) << 8 | byte(color.z) << 16;
  }

  const qnv::Volume& volume_;
  const VolumeModel& model_;
  VolumeLens lens_{};
  float near_plane_;
  const VolumeOptions& options_;
  std::size_t count_ = 0;
};

std::vector<Preparer> preparers_of(std::span<const VolumeItem> items, const SplatView& view) {
  std::vector<Preparer> preparers;
  for (const VolumeItem& item : items)
    if (item.volume && item.model) preparers.emplace_back(item, view);
  return preparers;
}

/// Sorts splats from front to back, stably. Depths that differ by less than a few millionths count as equal.
class Sorter {
 public:
  std::span<const std::uint32_t> sort(std::span<const VolumeSplat> splats) {
    const std::size_t count = splats.size();
    keys_.resize(count);
    order_.resize(count);
    other_.resize(count);
    // The bits of positive floats, as integers, have the order of the floats.
    std::uint32_t least = 0xFFFFFFFFu, most = 0;
    for (std::size_t i = 0; i < count; ++i) {
      keys_[i] = std::bit_cast<std::uint32_t>(splats[i].depth);
      least = std::min(least, keys_[i]);
      most = std::max(most, keys_[i]);
      order_[i] = static_cast<std::uint32_t>(i);
    }
    const auto bits = static_cast<unsigned>(std::bit_width(most - least));
    const unsigned shift = bits > 2 * kDepthDigitBits ? bits - 2 * kDepthDigitBits : 0;
    for (auto& key : keys_) key = (key - least) >> shift;
    if (count < 128) {
      std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return keys_[a] < keys_[b]; });
      return order_;
    }
    pass(0);
    pass(kDepthDigitBits);
    return order_;
  }

 private:
  void pass(unsigned shift) {
    std::array<std::uint32_t, kDepthDigits> places{};
    for (const std::uint32_t key : keys_) ++places[key >> shift & (kDepthDigits - 1)];
    std::uint32_t next = 0;
    for (auto& place : places) next += std::exchange(place, next);
    for (const std::uint32_t i : order_) other_[places[keys_[i] >> shift & (kDepthDigits - 1)]++] = i;
    order_.swap(other_);
  }

  std::vector<std::uint32_t> keys_, order_, other_;
};

/// Sorts visible splats by tile and draws the image.
class Painter {
 public:
  Painter(const std::vector<std::vector<VolumeSplat>>& parts, const SplatView& view, const VolumeStops& stops,
          VolumeLayer& layer)
      : parts_(parts),
        view_(view),
        stops_(stops),
        layer_(layer),
        columns_((view.width + kVolumeTile - 1) / kVolumeTile),
        tiles_(static_cast<std::size_t>(columns_) *
               static_cast<std::size_t>((view.height + kVolumeTile - 1) / kVolumeTile)),
        counts_(parts.size()) {}

  void run() {
    parallel_for(
        parts_.size(),
        [&](std::size_t r) {
          counts_[r].assign(tiles_, 0);
          for (const VolumeSplat& splat : parts_[r]) for_tiles(splat, [&](std::size_t tile) { ++counts_[r][tile]; });
        },
        view_.threads);
    // Process as many tiles at once as the memory limit permits, at least one. A tile has at most all vectors.
    std::size_t first = 0;
    while (first < tiles_) {
      std::size_t last = first, entries = 0;
      for (; last < tiles_; ++last) {
        const std::size_t more = in_tile(last);
        if (last > first && entries + more > kMaxEntries) break;
        entries += more;
      }
      if (entries > 0) some(first, last, entries);
      first = last;
    }
  }

 private:
  template <class Body>
  void for_tiles(const VolumeSplat& splat, Body body) const {
    const auto tile_of = [](float at, int size) {
      return static_cast<int>(std::clamp(at, 0.0f, static_cast<float>(size - 1))) / kVolumeTile;
    };
    const int x1 = tile_of(splat.x + splat.reach, view_.width), y1 = tile_of(splat.y + splat.reach, view_.height);
    const int x0 = tile_of(splat.x - splat.reach, view_.width);
    for (int y = tile_of(splat.y - splat.reach, view_.height); y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) body(static_cast<std::size_t>(y * columns_ + x));
  }

  [[nodiscard]] std::size_t in_tile(std::size_t tile) const {
    std::size_t sum = 0;
    for (const auto& range : counts_) sum += range[tile];
    return sum;
  }

  void some(std::size_t first, std::size_t last, std::size_t entries) {
    begin_.assign(last - first + 1, 0);
    std::size_t next = 0;
    std::vector<std::vector<std::size_t>> places(parts_.size());
    for (auto& place : places) place.resize(last - first);
    for (std::size_t tile = first; tile < last; ++tile) {
      begin_[tile - first] = next;
      for (std::size_t r = 0; r < parts_.size(); ++r) {
        places[r][tile - first] = next;
        next += counts_[r][tile];
      }
    }
    begin_[last - first] = next;
    if (splats_.size() < entries) splats_.resize(entries);
    parallel_for(
        parts_.size(),
        [&](std::size_t r) {
          for (const VolumeSplat& splat : parts_[r])
            for_tiles(splat, [&](std::size_t tile) {
              if (tile >= first && tile < last) splats_[places[r][tile - first]++] = splat;
            });
        },
        view_.threads);
    parallel_for(
        last - first, [&](std::size_t i) { paint(first + i, begin_[i], begin_[i + 1]); }, view_.threads);
  }

  /// Calls body(index in tile, index in viewport) for the pixels of a tile that are inside the viewport.
  template <class Body>
  void for_pixels(int left, int bottom, Body body) const {
    for (int y = bottom; y < std::min(bottom + kVolumeTile, view_.height); ++y)
      for (int x = left; x < std::min(left + kVolumeTile, view_.width); ++x)
        body(static_cast<std::size_t>((y - bottom) * kVolumeTile + x - left),
             static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) + static_cast<std::size_t>(x));
  }

  /// Sets the stops of a tile. Returns true if a stop is at or before the depth `deepest`, so that it may hide vectors.
  bool put_stops(std::span<const float> stops, int left, int bottom, float deepest, VolumeTile& tile) const {
    bool hides = false;
    tile.stop.fill(0);  // so that pixels outside of the viewport are not blended
    for_pixels(left, bottom, [&](std::size_t in_tile, std::size_t at) {
      tile.stop[in_tile] = stops[at];
      hides = hides || !(stops[at] >= deepest);
    });
    return hides;
  }

  void put_pixels(int left, int bottom, const VolumeTile& tile, std::vector<std::uint8_t>& pixels) const {
    for_pixels(left, bottom, [&](std::size_t in_tile, std::size_t at) {
      const auto byte = [](float c) { return static_cast<std::uint8_t>(std::min(c, 255.0f) + 0.5f); };
      pixels[4 * at] = byte(tile.red[in_tile]);
      pixels[4 * at + 1] = byte(tile.green[in_tile]);
      pixels[4 * at + 2] = byte(tile.blue[in_tile]);
      pixels[4 * at + 3] = byte(255 - 255 * tile.clear[in_tile]);
    });
  }

  void paint(std::size_t tile_number, std::size_t first, std::size_t last) {
    if (first == last) return;
    thread_local const auto tile = std::make_unique<VolumeTile>();
    thread_local Sorter sorter;
    const int left = static_cast<int>(tile_number) % columns_ * kVolumeTile,
              bottom = static_cast<int>(tile_number) / columns_ * kVolumeTile;
    const std::span splats(splats_.data() + first, last - first);
    const std::span<const std::uint32_t> order = sorter.sort(splats);
    float deepest = 0;
    for (const VolumeSplat& splat : splats) deepest = std::max(deepest, splat.depth);
    const auto kernel = [&](std::span<const float> stops) {
      return !stops.empty() && put_stops(stops, left, bottom, deepest, *tile) ? volume_kernel().stopped_tile
                                                                              : volume_kernel().tile;
    };
    kernel(stops_.far.empty() ? stops_.near : stops_.far)(splats.data(), order, left, bottom, *tile);
    put_pixels(left, bottom, *tile, layer_.pixels);
    for_pixels(left, bottom, [&](std::size_t in_tile, std::size_t at) { layer_.depth[at] = tile->depth[in_tile]; });
    if (layer_.edge_pixels.empty()) return;
    bool edge = false;
    for_pixels(left, bottom, [&](std::size_t, std::size_t at) { edge = edge || stops_.near[at] != stops_.far[at]; });
    if (edge) kernel(stops_.near)(splats.data(), order, left, bottom, *tile);
    put_pixels(left, bottom, *tile, layer_.edge_pixels);
  }

  const std::vector<std::vector<VolumeSplat>>& parts_;
  const SplatView& view_;
  const VolumeStops& stops_;
  VolumeLayer& layer_;
  int columns_;
  std::size_t tiles_;
  std::vector<std::vector<std::uint32_t>> counts_;  // number of splats, by range and tile
  std::vector<std::size_t> begin_;
  std::vector<VolumeSplat> splats_;
};

}  // namespace

VolumeLayer rasterize_volumes(std::span<const VolumeItem> items, const SplatView& view, const VolumeStops& given) {
  VolumeLayer layer;
  const std::vector<Preparer> preparers = preparers_of(items, view);
  struct Range {
    const Preparer* preparer;
    std::size_t first, last;
  };
  std::vector<Range> ranges;
  for (const Preparer& preparer : preparers)
    for (std::size_t first = 0; first < preparer.count(); first += kPreparedRange)
      ranges.push_back({&preparer, first, std::min(preparer.count(), first + kPreparedRange)});
  std::vector<std::vector<VolumeSplat>> parts(ranges.size());
  parallel_for(
      parts.size(), [&](std::size_t r) { ranges[r].preparer->run(ranges[r].first, ranges[r].last, parts[r]); },
      view.threads);
  for (const auto& part : parts) layer.vectors += part.size();
  if (layer.vectors == 0) return layer;
  layer.width = view.width;
  layer.height = view.height;
  layer.used = {0, 0, view.width, view.height};
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layer.pixels.assign(4 * pixels, 0);
  layer.depth.assign(pixels, 0);
  VolumeStops stops;
  if (given.near.size() == pixels) stops.near = given.near;
  if (!stops.near.empty() && given.far.size() == pixels &&
      !std::equal(given.near.begin(), given.near.end(), given.far.begin())) {
    stops.far = given.far;
    layer.edge_pixels.assign(4 * pixels, 0);
  }
  Painter(parts, view, stops, layer).run();
  return layer;
}

VolumeSurvey survey_volumes(std::span<const VolumeItem> items, const SplatView& view, std::size_t most) {
  const std::vector<Preparer> preparers = preparers_of(items, view);
  std::size_t all = 0, looked = 0, seen = 0;
  for (const Preparer& preparer : preparers) all += preparer.count();
  const std::size_t step = std::max<std::size_t>(1, all / std::max<std::size_t>(most, 1));
  double pixels = 0;
  const auto along = [](float at, float reach, int size) {
    return double{std::min(at + reach, static_cast<float>(size))} - double{std::max(at - reach, 0.0f)};
  };
  for (const Preparer& preparer : preparers)
    for (std::size_t i = 0; i < preparer.count(); i += step) {
      VolumeSplat splat{};
      ++looked;
      if (!preparer.place(i, splat)) continue;
      ++seen;
      pixels += std::max(1.0, along(splat.x, splat.reach, view.width) * along(splat.y, splat.reach, view.height));
    }
  if (looked == 0) return {};
  const double share = static_cast<double>(all) / static_cast<double>(looked);
  return {static_cast<std::size_t>(static_cast<double>(seen) * share + 0.5), pixels * share};
}

}  // namespace gs::render
