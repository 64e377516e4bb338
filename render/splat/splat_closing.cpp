#include "render/splat/splat_closing.h"

#include "base/parallel.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace gs::render {
namespace {

constexpr int kMinClosing = 2, kMaxClosing = 12;  // minimum and maximum of closing_for(), pixels
constexpr std::size_t kClosingSurvey = 2048;  // splats that are sampled
constexpr int kTaskRows = 16;                     // rows per task
constexpr std::uint16_t kWhole = 65535;

/// New values of a pixel that is closed.
struct Closed {
  std::size_t at = 0;
  std::uint16_t coverage = 0;
  std::array<std::size_t, 4> from{};  // indexes of the pixels to average
  int count = 0;
};

class PinholeCloser {
 public:
  PinholeCloser(const SplatLayer& layer, const SplatView& view, int closing)
      : layer_(layer), viewport_{view.width, view.height}, closing_(closing) {}

  void row(int y, std::vector<Closed>& out) const {
    for (int x = 0; x < layer_.width; ++x) {
      Closed closed;
      closed.at = index(x, y);
      const std::uint16_t own = coverage(closed.at);
      if (own == kWhole) continue;
      std::uint16_t least = kWhole;
      // One call per side: GCC 12 miscompiles a loop over the sides; see Extrusion::sides.
      const auto look = [&](int dx, int dy) {
        if (least > own) least = std::min(least, beside(x, y, dx, dy, closed));
      };
      look(1, 0);
      look(-1, 0);
      look(0, 1);
      look(0, -1);
      if (least <= own || (own == 0 && closed.count == 0)) continue;
      closed.coverage = least;
      if (own > 0) closed.count = 0;
      out.push_back(closed);
    }
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(layer_.width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::uint16_t coverage(std::size_t at) const { return layer_.normals[4 * at + 3]; }

  // Returns the maximum coverage of the pixels on one side, up to closing_ pixels away. Records the nearest covered
  // pixel.
  std::uint16_t beside(int x, int y, int dx, int dy, Closed& closed) const {
    std::uint16_t most = 0;
    for (int i = 1; i <= closing_ && most < kWhole; ++i) {
      const int there_x = x + dx * i, there_y = y + dy * i;
      if (there_x + layer_.x < 0 || there_y + layer_.y < 0 || there_x + layer_.x >= viewport_[0] ||
          there_y + layer_.y >= viewport_[1])
        return kWhole;
      if (there_x < 0 || there_y < 0 || there_x >= layer_.width || there_y >= layer_.height) break;
      const std::size_t at = index(there_x, there_y);
      if (most == 0 && coverage(at) > 0) closed.from[static_cast<std::size_t>(closed.count++)] = at;
      most = std::max(most, coverage(at));
    }
    return most;
  }

  const SplatLayer& layer_;
  std::array<int, 2> viewport_;
  int closing_;
};

void apply(const Closed& closed, SplatLayer& layer) {
  layer.normals[4 * closed.at + 3] = closed.coverage;
  if (closed.count == 0) return;
  glm::vec3 normal(0), color(0);
  float depth = 0;
  for (int i = 0; i < closed.count; ++i) {
    const std::size_t from = closed.from[static_cast<std::size_t>(i)];
    const std::uint16_t* n = &layer.normals[4 * from];
    normal += glm::vec3(n[0], n[1], n[2]) * (1 / 32767.5f) - 1.0f;
    depth += layer.depth[from];
    if (!layer.colors.empty())
      color += glm::vec3(layer.colors[4 * from], layer.colors[4 * from + 1], layer.colors[4 * from + 2]);
  }
  const float part = 1 / static_cast<float>(closed.count), length = std::sqrt(glm::dot(normal, normal));
  normal = length > 0 ? normal / length : glm::vec3(0, 0, 1);
  layer.depth[closed.at] = depth * part;
  for (int c = 0; c < 3; ++c) {
    const auto i = 4 * closed.at + static_cast<std::size_t>(c);
    layer.normals[i] = static_cast<std::uint16_t>(std::lround((normal[c] * 0.5f + 0.5f) * 65535));
    if (!layer.colors.empty()) layer.colors[i] = static_cast<std::uint8_t>(std::lround(color[c] * part));
  }
}

}  // namespace

int closing_for(std::span<const SharedSplatPiece> shared, const SplatView& view) {
  if (shared.empty() || shared.front().splats->cells.empty()) return kMinClosing;
  std::vector<SplatPiece> pieces;
  for (const SharedSplatPiece& p : shared) pieces.push_back({p.splats.get(), p.first, p.count, p.growth, p.tint});
  const SurfaceMeasure survey = measure_surface(pieces, view, kClosingSurvey);
  if (survey.discs == 0) return kMinClosing;
  // The bounding box of a splat is about 2.7 voxel edges wide.
  const double edge = std::sqrt(survey.samples / static_cast<double>(survey.discs)) / 2.7 / view.supersample;
  // The pixels at both ends of a hole belong to its width.
  return static_cast<int>(std::clamp(std::ceil(edge / 2), double{kMinClosing}, double{kMaxClosing}));
}

void close_pinholes(SplatLayer& layer, const SplatView& view, int closing) {
  if (layer.empty()) return;
  const PinholeCloser closer(layer, view, closing);
  std::vector<std::vector<Closed>> found(static_cast<std::size_t>((layer.height + kTaskRows - 1) / kTaskRows));
  parallel_for(
      found.size(),
      [&](std::size_t task) {
        const int first = static_cast<int>(task) * kTaskRows;
        for (int y = first; y < std::min(first + kTaskRows, layer.height); ++y) closer.row(y, found[task]);
      },
      view.threads);
  // Change pixels only after the search, so that a closed pixel does not close its neighbours.
  for (const auto& rows : found)
    for (const Closed& closed : rows) apply(closed, layer);
}

}  // namespace gs::render
