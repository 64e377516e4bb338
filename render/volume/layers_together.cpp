#include "render/volume/layers_together.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace gs::render {
namespace {

constexpr std::size_t kBlendedPixels = std::size_t{1} << 15;  // pixels per task

/// Premultiplied pixels, blended from near to far.
class BlendedLayers {
 public:
  explicit BlendedLayers(std::size_t pixels) : colors_(4 * pixels, 0.0f) {}

  /// Blends 8-bit pixels behind all earlier ones.
  void add(std::span<const std::uint8_t> pixels, unsigned threads) {
    for_pixels(threads, [&](std::size_t i) {
      float* const color = colors_.data() + 4 * i;
      const float clear = (1 - color[3]) / 255;
      if (pixels[4 * i + 3] == 0 || clear <= 0) return;
      for (std::size_t k = 0; k < 4; ++k) color[k] += clear * static_cast<float>(pixels[4 * i + k]);
    });
  }
  [[nodiscard]] std::vector<std::uint8_t> bytes(unsigned threads) const {
    std::vector<std::uint8_t> bytes(colors_.size());
    for_pixels(threads, [&](std::size_t i) {
      for (std::size_t k = 4 * i; k < 4 * i + 4; ++k)
        bytes[k] = static_cast<std::uint8_t>(std::clamp(colors_[k], 0.0f, 1.0f) * 255 + 0.5f);
    });
    return bytes;
  }

 private:
  template <class Use>
  void for_pixels(unsigned threads, const Use& use) const {
    const std::size_t pixels = colors_.size() / 4;
    parallel_for((pixels + kBlendedPixels - 1) / kBlendedPixels,
                 [&](std::size_t task) {
                   const std::size_t last = std::min(pixels, (task + 1) * kBlendedPixels);
                   for (std::size_t i = task * kBlendedPixels; i < last; ++i) use(i);
                 },
                 threads);
  }

  std::vector<float> colors_;  // RGBA
};

/// Limits stops to at most `farthest`. If `stops` is empty, all limited stops are `farthest`.
void limit(std::span<const float> stops, float farthest, std::vector<float>& limited) {
  for (std::size_t i = 0; i < limited.size(); ++i) limited[i] = stops.empty() ? farthest : std::min(stops[i], farthest);
}

}  // namespace

std::vector<DepthSlab> depth_slabs(const DepthRange& range, std::size_t slabs) {
  constexpr float kEndless = std::numeric_limits<float>::infinity();
  const float step = (range.farthest - range.nearest) / static_cast<float>(std::max<std::size_t>(slabs, 1));
  std::vector<DepthSlab> made;
  // Slab 0 is in front of the range, and slab `slabs` + 1 is behind it.
  for (std::size_t slab = 0; slab < slabs + 2; ++slab)
    for (std::size_t content = 0; content < 2; ++content) {
      const auto bound = [&](std::size_t i) {
        return range.nearest + step * (static_cast<float>(i) + 0.5f * static_cast<float>(content));
      };
      made.push_back({content, slab > 0 ? bound(slab - 1) : 0, slab <= slabs ? bound(slab) : kEndless});
    }
  return made;
}

VolumeLayer rasterize_together(const std::array<LayerRaster, 2>& contents, const SplatView& view,
                               const VolumeStops& stops, const DepthRange& range, std::size_t slabs) {
  VolumeLayer layer;
  if (view.width <= 0 || view.height <= 0) return layer;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  const bool has_edges = !stops.far.empty() && !std::ranges::equal(stops.near, stops.far);
  BlendedLayers blended(pixels), edges(has_edges ? pixels : 0);
  std::vector<float> near(pixels), far(has_edges ? pixels : 0);
  bool any = false;
  std::array<bool, 2> counted{};  // contents with their splats in layer.vectors
  for (const DepthSlab& slab : depth_slabs(range, slabs)) {
    SplatView part = view;
    part.near_plane = std::max(view.near_plane, slab.nearest);
    VolumeStops limited = stops;
    if (std::isfinite(slab.farthest)) {
      if (!(slab.farthest > view.near_plane)) continue;
      limit(stops.near, slab.farthest, near);
      limited.near = near;
      if (has_edges) limit(stops.far, slab.farthest, far);
      limited.far = far;
    }
    const VolumeLayer one = contents[slab.content](part, limited);
    // The first slab begins at the near plane, so it counts all splats.
    if (!std::exchange(counted[slab.content], true)) layer.vectors += one.vectors;
    if (one.empty()) continue;
    any = true;
    blended.add(one.pixels, view.threads);
    if (has_edges) edges.add(one.edge_pixels.empty() ? one.pixels : one.edge_pixels, view.threads);
  }
  if (!any) return {};
  layer.width = view.width;
  layer.height = view.height;
  layer.used = {0, 0, view.width, view.height};
  layer.pixels = blended.bytes(view.threads);
  if (has_edges) layer.edge_pixels = edges.bytes(view.threads);
  return layer;
}

}  // namespace gs::render
