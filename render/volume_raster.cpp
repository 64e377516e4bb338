#include "render/volume_raster.h"

#include "qnv/parallel.h"
#include "render/volume_tile.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kRange = 16384;                       // vectors that one task prepares
constexpr std::size_t kMostEntries = std::size_t{1} << 22;  // splats of tiles that are copied at a time
constexpr float kLeastAlpha = 1 / 1024.0f;                  // fainter vectors are left out
constexpr unsigned kDigitBits = 11, kDigits = 1u << kDigitBits;

struct Lens {
  glm::mat4 camera_from_node;
  glm::mat3 normal_matrix;
  float scale;               // of lengths, node to camera
  float pixels_x, pixels_y;  // at depth 1
  int width, height;
};

bool lens_of(const SplatView& view, Lens& lens) {
  lens.camera_from_node = view.camera_from_node;
  const glm::mat3 linear(view.camera_from_node);
  const float determinant = glm::determinant(linear);
  if (!(std::abs(determinant) > 1e-30f) || !std::isfinite(determinant)) return false;
  lens.normal_matrix = glm::transpose(glm::inverse(linear));
  lens.scale = std::cbrt(std::abs(determinant));
  lens.pixels_x = static_cast<float>(view.width) / (2 * view.tangents.x);
  lens.pixels_y = static_cast<float>(view.height) / (2 * view.tangents.y);
  lens.width = view.width;
  lens.height = view.height;
  return view.width > 0 && view.height > 0 && lens.pixels_x > 0 && lens.pixels_y > 0;
}

/// The vectors of one range of a cloud that are in view.
class Preparer {
 public:
  Preparer(const qnv::Cloud& cloud, const VolumeModel& model, const Lens& lens, float near_plane,
           const VolumeOptions& options)
      : cloud_(cloud), model_(model), lens_(lens), near_plane_(near_plane), options_(options) {}

  void run(std::size_t first, std::size_t last, std::vector<VolumeSplat>& out) const {
    for (std::size_t i = first; i < last; ++i) {
      VolumeSplat splat;
      if (prepare(i, splat)) out.push_back(splat);
    }
  }

 private:
  bool prepare(std::size_t i, VolumeSplat& splat) const {
    splat.alpha = volume_alpha(cloud_, model_, options_, i);
    if (!(splat.alpha >= kLeastAlpha)) return false;
    const glm::vec3 seen(lens_.camera_from_node * glm::vec4(cloud_.positions[i], 1.0f));
    splat.depth = -seen.z;
    const float spacing = model_.spacing[i] * lens_.scale;
    if (!(splat.depth > near_plane_ && splat.depth > spacing)) return false;
    const float near = 1 / splat.depth;
    const float pixels = std::sqrt(lens_.pixels_x * lens_.pixels_y) * near;
    float area = kVolumeFootprint * spacing * spacing * pixels * pixels;
    if (area < kVolumePixel) {
      splat.alpha *= area / kVolumePixel;
      area = kVolumePixel;
      if (!(splat.alpha >= kLeastAlpha)) return false;
    }
    splat.reach = kVolumeCut * std::sqrt(area);
    splat.x = seen.x * near * lens_.pixels_x + 0.5f * static_cast<float>(lens_.width) - 0.5f;
    splat.y = seen.y * near * lens_.pixels_y + 0.5f * static_cast<float>(lens_.height) - 0.5f;
    if (!(splat.x + splat.reach >= 0 && splat.y + splat.reach >= 0)) return false;
    if (!(splat.x - splat.reach <= static_cast<float>(lens_.width - 1)) ||
        !(splat.y - splat.reach <= static_cast<float>(lens_.height - 1)) || !std::isfinite(splat.reach))
      return false;
    const glm::vec3 color = volume_shade(options_, volume_color(cloud_, model_, options_, i), seen,
                                         lens_.normal_matrix * cloud_.normals[i]);
    const auto byte = [](float c) { return static_cast<std::uint32_t>(c * 255 + 0.5f); };
    splat.color = byte(color.x) | byte(color.y) << 8 | byte(color.z) << 16;
    return true;
  }

  const qnv::Cloud& cloud_;
  const VolumeModel& model_;
  const Lens& lens_;
  float near_plane_;
  const VolumeOptions& options_;
};

/// Front to back, splats of one depth in their order. Depths that differ by less than a few millionths are one.
class Sorter {
 public:
  std::span<const std::uint32_t> sort(std::span<const VolumeSplat> splats) {
    const std::size_t count = splats.size();
    keys_.resize(count);
    order_.resize(count);
    other_.resize(count);
    // A positive float's bits, read as an integer, are in the order of the floats.
    std::uint32_t least = 0xFFFFFFFFu, most = 0;
    for (std::size_t i = 0; i < count; ++i) {
      keys_[i] = std::bit_cast<std::uint32_t>(splats[i].depth);
      least = std::min(least, keys_[i]);
      most = std::max(most, keys_[i]);
      order_[i] = static_cast<std::uint32_t>(i);
    }
    const auto bits = static_cast<unsigned>(std::bit_width(most - least));
    const unsigned shift = bits > 2 * kDigitBits ? bits - 2 * kDigitBits : 0;
    for (auto& key : keys_) key = (key - least) >> shift;
    if (count < 128) {
      std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return keys_[a] < keys_[b]; });
      return order_;
    }
    pass(0);
    pass(kDigitBits);
    return order_;
  }

 private:
  void pass(unsigned shift) {
    std::array<std::uint32_t, kDigits> places{};
    for (const std::uint32_t key : keys_) ++places[key >> shift & (kDigits - 1)];
    std::uint32_t next = 0;
    for (auto& place : places) next += std::exchange(place, next);
    for (const std::uint32_t i : order_) other_[places[keys_[i] >> shift & (kDigits - 1)]++] = i;
    order_.swap(other_);
  }

  std::vector<std::uint32_t> keys_, order_, other_;
};

/// The splats in view, tile by tile, and the picture of them.
class Painter {
 public:
  Painter(const std::vector<std::vector<VolumeSplat>>& parts, const SplatView& view, VolumeLayer& layer)
      : parts_(parts),
        view_(view),
        layer_(layer),
        columns_((view.width + kVolumeTile - 1) / kVolumeTile),
        tiles_(static_cast<std::size_t>(columns_) *
               static_cast<std::size_t>((view.height + kVolumeTile - 1) / kVolumeTile)),
        counts_(parts.size()) {}

  void run() {
    qnv::parallel_for(
        parts_.size(),
        [&](std::size_t r) {
          counts_[r].assign(tiles_, 0);
          for (const VolumeSplat& splat : parts_[r]) for_tiles(splat, [&](std::size_t tile) { ++counts_[r][tile]; });
        },
        view_.threads);
    // As many tiles at a time as bounded memory holds; one tile always, which has no more than all vectors.
    std::size_t first = 0;
    while (first < tiles_) {
      std::size_t last = first, entries = 0;
      for (; last < tiles_; ++last) {
        const std::size_t more = in_tile(last);
        if (last > first && entries + more > kMostEntries) break;
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
    qnv::parallel_for(
        parts_.size(),
        [&](std::size_t r) {
          for (const VolumeSplat& splat : parts_[r])
            for_tiles(splat, [&](std::size_t tile) {
              if (tile >= first && tile < last) splats_[places[r][tile - first]++] = splat;
            });
        },
        view_.threads);
    qnv::parallel_for(
        last - first, [&](std::size_t i) { paint(first + i, begin_[i], begin_[i + 1]); }, view_.threads);
  }

  void paint(std::size_t tile_number, std::size_t first, std::size_t last) {
    if (first == last) return;
    thread_local const auto tile = std::make_unique<VolumeTile>();
    thread_local Sorter sorter;
    const int left = static_cast<int>(tile_number) % columns_ * kVolumeTile,
              bottom = static_cast<int>(tile_number) / columns_ * kVolumeTile;
    const std::span splats(splats_.data() + first, last - first);
    volume_kernel().tile(splats.data(), sorter.sort(splats), left, bottom, *tile);
    for (int y = bottom; y < std::min(bottom + kVolumeTile, view_.height); ++y)
      for (int x = left; x < std::min(left + kVolumeTile, view_.width); ++x) {
        const auto from = static_cast<std::size_t>((y - bottom) * kVolumeTile + x - left);
        const auto to =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) + static_cast<std::size_t>(x);
        const auto byte = [](float c) { return static_cast<std::uint8_t>(std::min(c, 255.0f) + 0.5f); };
        layer_.depth[to] = tile->depth[from];
        layer_.pixels[4 * to] = byte(tile->red[from]);
        layer_.pixels[4 * to + 1] = byte(tile->green[from]);
        layer_.pixels[4 * to + 2] = byte(tile->blue[from]);
        layer_.pixels[4 * to + 3] = byte(255 - 255 * tile->clear[from]);
      }
  }

  const std::vector<std::vector<VolumeSplat>>& parts_;
  const SplatView& view_;
  VolumeLayer& layer_;
  int columns_;
  std::size_t tiles_;
  std::vector<std::vector<std::uint32_t>> counts_;  // by range and tile
  std::vector<std::size_t> begin_;
  std::vector<VolumeSplat> splats_;
};

}  // namespace

VolumeLayer rasterize_volume(const qnv::Cloud& cloud, const VolumeModel& model, const SplatView& view,
                             const VolumeOptions& options) {
  VolumeLayer layer;
  Lens lens{};
  const std::size_t count = cloud.size();
  if (model.spacing.size() != count || count == 0 || !lens_of(view, lens)) return layer;
  std::vector<std::vector<VolumeSplat>> parts((count + kRange - 1) / kRange);
  const Preparer preparer(cloud, model, lens, view.near_plane, options);
  qnv::parallel_for(
      parts.size(), [&](std::size_t r) { preparer.run(r * kRange, std::min(count, (r + 1) * kRange), parts[r]); },
      view.threads);
  for (const auto& part : parts) layer.vectors += part.size();
  if (layer.vectors == 0) return layer;
  layer.width = view.width;
  layer.height = view.height;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layer.pixels.assign(4 * pixels, 0);
  layer.depth.assign(pixels, 0);
  Painter(parts, view, layer).run();
  return layer;
}

}  // namespace gs::render
