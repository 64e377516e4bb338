#include "render/draw/layer_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gs::render {

std::optional<LayerPart> part_of(const vrml::ClipBoundary& boundary, const Camera& camera, const DrawOptions& options) {
  LayerPart layer{camera, options};
  const auto cut = [](double lower, double upper, double& low, double& high, int& at, int& pixels) {
    // The layer, and the drawn part of the picture, from -1 to 1 over the whole picture.
    const double first = 2 * lower - 1, last = 2 * upper - 1, scale = pixels / (high - low);
    const double begin = std::max(first, low), end = std::min(last, high);
    const int from = static_cast<int>(std::lround((begin - low) * scale)),
              to = static_cast<int>(std::lround((end - low) * scale));
    if (!(begin < end) || from >= to) return false;
    low = (begin - first) / (last - first) * 2 - 1;
    high = (end - first) / (last - first) * 2 - 1;
    at += from;
    pixels = to - from;
    return true;
  };
  PicturePart& part = layer.camera.part;
  if (!cut(boundary[0], boundary[1], part.left, part.right, layer.options.x, layer.options.width) ||
      !cut(boundary[2], boundary[3], part.bottom, part.top, layer.options.y, layer.options.height))
    return std::nullopt;
  return layer;
}

Camera lens_of(const RenderLayer& layer, const Camera& camera, const DrawOptions& options) {
  Camera lens = layer.camera;
  lens.part = camera.part;
  if (layer.extent.x > 0) {
    const vrml::ClipBoundary& boundary = layer.list->boundary;
    const glm::dvec2 whole(whole_size(camera, glm::vec2(options.width, options.height)));
    const glm::dvec2 size(whole.x * (boundary[1] - boundary[0]), whole.y * (boundary[3] - boundary[2]));
    const double smaller = std::min(size.x, size.y);
    lens.height = std::max(layer.extent.x * smaller / size.x, layer.extent.y * smaller / size.y);
  }
  return lens;
}

DrawOptions options_of(const RenderLayer& layer, std::size_t index, const DrawOptions& options) {
  constexpr std::uint32_t kViewports = 1u << 16;  // more than a window has: each layer has a level of detail of its own
  DrawOptions result = options;
  result.headlight = layer.list->navigation.headlight;
  result.headlight_towards = {0, 0, 1};
  result.viewport += kViewports * (static_cast<std::uint32_t>(index) + 1);
  result.guides = nullptr;
  result.unit = 1;
  return result;
}

void add_to(FrameStatistics& sum, const FrameStatistics& layer) {
  sum.triangles += layer.triangles;
  sum.items += layer.items;
  sum.draw_calls += layer.draw_calls;
  sum.vectors += layer.vectors;
  if (layer.vectors > 0) sum.splats = layer.splats;
  sum.pending = sum.pending || layer.pending;
  sum.given_up = sum.given_up || layer.given_up;
}

}  // namespace gs::render
