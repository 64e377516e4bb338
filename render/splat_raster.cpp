#include "render/splat_raster.h"

#include "qnv/parallel.h"
#include "render/splat_camera.h"
#include "render/splat_constants.h"
#include "render/splat_tile.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

namespace gs::render {
namespace {

using namespace splat;

constexpr std::size_t kRange = 16384;  // discs that one task prepares

using Camera = SplatCamera;

std::uint32_t packed(const qnv::Rgb8& c) {
  return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 | static_cast<std::uint32_t>(c.b) << 16;
}

/// One range of a cloud: the discs of it that are in view.
class Preparer {
 public:
  Preparer(const SplatPiece& piece, const Camera& camera)
      : cloud_(*piece.cloud), growth_(std::max(piece.growth, 1.0f)), camera_(camera) {}

  /// Writes the discs in view, which are at most as many as are looked at, and returns how many they are.
  std::size_t run(std::size_t first, std::size_t last, SplatDisc* out, std::size_t step = 1) const {
    SplatDisc* next = out;
    for (std::size_t i = first; i < last; i += step) next += prepare(i, *next) ? 1 : 0;
    return static_cast<std::size_t>(next - out);
  }

 private:
  bool prepare(std::size_t i, SplatDisc& disc) const {
    const glm::vec3& position = cloud_.positions[i];
    const glm::vec3 seen(camera_.camera_from_node * glm::vec4(position, 1.0f));
    const float depth = -seen.z;
    disc.place = position - camera_.eye;
    disc.normal = cloud_.normals[i];
    disc.plane = glm::dot(disc.normal, disc.place);
    // Towards the viewer; what shows its back is hidden by what lies before it, or was meant to be seen from both
    // sides.
    if (disc.plane > 0 && !cloud_.description.two_sided) return false;
    const float distance2 = glm::dot(disc.place, disc.place);
    if (!(disc.plane * disc.plane > kGrazing * kGrazing * distance2)) return false;
    const float radius = std::sqrt(cloud_.weights[i] * growth_ * (1 / kPi));
    const float sample = depth / (camera_.pixels * camera_.scale);  // one sample there, node units
    const bool cube = !cloud_.cells.empty() && cloud_.cells[i].edge > 0;
    float bell = radius * kCubeBell, cover;
    if (cube) {
      const qnv::Cell& cell = cloud_.cells[i];
      disc.clip = disc.place - disc.normal * cell.offset;
      const float margin =
          disc.plane > 0 ? cell.edge * kBackMargin : std::max(cell.edge * kCubeMargin, sample * kSampleMargin);
      disc.reach = std::max(cell.edge * 0.5f + margin, sample * kLeastReach);
      bell = std::max({bell, 0.5f * cell.edge, sample * kLeastReach});
      cover = disc.reach * 1.7321f;  // no point of a cube is further from the foot of its centre on a plane
    } else {
      disc.clip = disc.place;
      cover = std::max(radius * kDiscCover, sample * kLeastReach);
      // Among cubes it is one as well: the inner loop knows only one kind.
      disc.reach = cloud_.cells.empty() ? cover * cover : cover;
      if (!cloud_.cells.empty()) cover *= 1.7321f;
      bell = std::max(radius * kDiscBell, sample * kLeastReach);
    }
    disc.inverse_radius2 = 1 / (bell * bell);
    if (!bound(seen, depth, 2 * bell * camera_.scale, disc.bell)) return false;
    if (!bound(seen, depth, cover * camera_.scale, disc.cover)) disc.cover = {0, 0, -1, -1};
    disc.facing = glm::dot(disc.normal, camera_.rays.origin);
    disc.facing_x = glm::dot(disc.normal, camera_.rays.right);
    disc.facing_y = glm::dot(disc.normal, camera_.rays.up);
    disc.color = cloud_.colors.empty() ? packed(cloud_.color) : packed(cloud_.colors[i]);
    return true;
  }

  // The samples in a ball around the disc's centre.
  bool bound(const glm::vec3& seen, float depth, float extent, SplatBounds& out) const {
    if (!(depth + extent > camera_.rays.near_plane) || !std::isfinite(depth) || !std::isfinite(extent)) return false;
    float x0 = 0, y0 = 0, x1 = static_cast<float>(camera_.width - 1), y1 = static_cast<float>(camera_.height - 1);
    if (depth > 2 * extent) {
      const float width = static_cast<float>(camera_.width), height = static_cast<float>(camera_.height);
      // In samples, whose centres lie at whole numbers.
      const float x = (seen.x / (depth * camera_.tangents.x) + 1) * 0.5f * width - 0.5f;
      const float y = (seen.y / (depth * camera_.tangents.y) + 1) * 0.5f * height - 0.5f;
      // Towards the edges of the view a ball is drawn out.
      const float slant = std::sqrt(1 + (seen.x * seen.x + seen.y * seen.y) / (depth * depth));
      const float around = extent * camera_.pixels / (depth - extent) * slant + 0.01f;
      // The next whole number, of one that is not negative.
      const auto up = [](float v) { return static_cast<float>(static_cast<int>(v + 0.999999f)); };
      x0 = up(std::max(x0, x - around));
      y0 = up(std::max(y0, y - around));
      x1 = std::min(x1, x + around);
      y1 = std::min(y1, y + around);
      if (!(x0 <= x1 && y0 <= y1)) return false;
    }
    out = {static_cast<std::int16_t>(x0), static_cast<std::int16_t>(y0), static_cast<std::int16_t>(x1),
           static_cast<std::int16_t>(y1)};
    return true;
  }

  const qnv::Cloud& cloud_;
  float growth_;
  const Camera& camera_;
};

/// Which discs meet which tile, in their order.
struct Bins {
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> begin, discs;
};

/// The discs that one task prepared: where they begin, and how many there are.
struct Segment {
  std::size_t first = 0, count = 0;
};

Bins bin(const SplatDisc* discs, std::span<const Segment> segments, const Camera& camera, unsigned threads) {
  Bins bins;
  bins.columns = (camera.width + kTile - 1) / kTile;
  bins.rows = (camera.height + kTile - 1) / kTile;
  const auto tiles = static_cast<std::size_t>(bins.columns) * static_cast<std::size_t>(bins.rows);
  const auto for_tiles = [&](const Segment& segment, auto body) {
    for (std::size_t i = segment.first; i < segment.first + segment.count; ++i) {
      const SplatBounds& b = discs[i].bell;
      for (int y = b.y0 / kTile; y <= b.y1 / kTile; ++y)
        for (int x = b.x0 / kTile; x <= b.x1 / kTile; ++x) body(static_cast<std::size_t>(y * bins.columns + x), i);
    }
  };
  // Counts by segment first, so that every one knows its places.
  std::vector<std::vector<std::uint32_t>> places(segments.size());
  qnv::parallel_for(
      segments.size(),
      [&](std::size_t r) {
        places[r].assign(tiles, 0);
        for_tiles(segments[r], [&](std::size_t tile, std::size_t) { ++places[r][tile]; });
      },
      threads);
  bins.begin.assign(tiles + 1, 0);
  std::uint32_t next = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    bins.begin[tile] = next;
    for (auto& segment : places) next += std::exchange(segment[tile], next);
  }
  bins.begin[tiles] = next;
  bins.discs.resize(next);
  qnv::parallel_for(
      segments.size(),
      [&](std::size_t r) {
        for_tiles(segments[r], [&](std::size_t tile, std::size_t i) {
          bins.discs[places[r][tile]++] = static_cast<std::uint32_t>(i);
        });
      },
      threads);
  return bins;
}

/// Memory for the discs of a picture, kept from one to the next: fresh memory would cost as much as the discs do.
SplatDisc* disc_memory(std::size_t count) {
  thread_local std::unique_ptr<SplatDisc[]> memory;
  thread_local std::size_t size = 0;
  if (count > size) {
    memory.reset();  // before there is more
    memory.reset(new SplatDisc[count]);
    size = count;
  }
  return memory.get();
}

double width_of(const SplatBounds& bounds) { return 1 + bounds.x1 - bounds.x0; }

/// The normal of one sample, node space, of any length: that of the surface where the mean of the heights over the
/// discs' planes, weighted by their bells, is zero.
glm::vec3 sample_normal(const SplatTile& tile, std::size_t at, bool smooth) {
  const glm::vec3 n(tile.normal_x[at], tile.normal_y[at], tile.normal_z[at]);
  if (!smooth) return n;
  const float height = tile.height[at] / tile.weight[at];
  const glm::vec3 slope(tile.slope_x[at], tile.slope_y[at], tile.slope_z[at]);
  const glm::vec3 tilt(tile.tilt_x[at], tile.tilt_y[at], tile.tilt_z[at]);
  return n + kSmoothing * (tilt - slope * height);
}

/// Averages the samples of each pixel of a tile.
void resolve(const SplatTile& tile, int left, int bottom, const SplatView& view, const Camera& camera,
             const SplatKind& kind, SplatLayer& layer) {
  const int s = view.supersample, pixels = kTile / s;
  for (int ty = 0; ty < pixels; ++ty)
    for (int tx = 0; tx < pixels; ++tx) {
      const int x = left / s + tx, y = bottom / s + ty;
      if (x >= view.width || y >= view.height) continue;
      glm::vec3 normal(0), color(0);
      float depth = 1e30f;
      int covered = 0;
      for (int sy = 0; sy < s; ++sy)
        for (int sx = 0; sx < s; ++sx) {
          const auto at = static_cast<std::size_t>((ty * s + sy) * kTile + tx * s + sx);
          const float weight = tile.weight[at];
          if (!(weight > 0)) continue;
          ++covered;
          depth = std::min(depth, tile.depth[at]);
          const glm::vec3 n = camera.normal_matrix * sample_normal(tile, at, kind.smooth);
          const float length = std::sqrt(glm::dot(n, n));
          if (length > 0) normal += n * ((tile.side[at] > 0 ? -1.0f : 1.0f) / length);
          if (kind.colored) color += glm::vec3(tile.red[at], tile.green[at], tile.blue[at]) / weight;
        }
      if (covered == 0) continue;
      const auto at = static_cast<std::size_t>(y * view.width + x);
      layer.depth[at] = depth;
      const float length = std::sqrt(glm::dot(normal, normal));
      normal = length > 0 ? normal / length : glm::vec3(0, 0, 1);
      for (int i = 0; i < 3; ++i)
        layer.normals[4 * at + static_cast<std::size_t>(i)] =
            static_cast<std::uint16_t>(std::lround((normal[i] * 0.5f + 0.5f) * 65535));
      layer.normals[4 * at + 3] = static_cast<std::uint16_t>(covered * 65535 / (s * s));
      if (!kind.colored) continue;
      for (int i = 0; i < 3; ++i)
        layer.colors[4 * at + static_cast<std::size_t>(i)] =
            static_cast<std::uint8_t>(std::lround(color[i] / static_cast<float>(covered)));
    }
}

}  // namespace

SplatLayer rasterize_surface(const qnv::Cloud& cloud, const SplatView& view) {
  const SplatPiece whole{&cloud, 0, cloud.size()};
  return rasterize_surface(std::span(&whole, 1), view);
}

SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view) {
  SplatLayer layer;
  const auto camera = splat_camera(view);
  if (!camera || pieces.empty() || view.width < 1 || view.height < 1) return layer;
  std::vector<SplatPiece> ranges;
  std::vector<std::size_t> tasks{0};  // the first range of each, and the end
  std::size_t all = 0, in_task = 0;
  bool colored = false;
  for (const SplatPiece& piece : pieces) {
    colored = colored || !piece.cloud->colors.empty();
    for (std::size_t i = 0; i < piece.count; i += kRange) {
      const std::size_t count = std::min(kRange, piece.count - i);
      if (in_task + count > kRange && in_task > 0) {
        tasks.push_back(ranges.size());
        in_task = 0;
      }
      ranges.push_back({piece.cloud, piece.first + i, count, piece.growth});
      in_task += count;
      all += count;
    }
  }
  tasks.push_back(ranges.size());
  SplatDisc* const discs = disc_memory(all);
  std::vector<Segment> segments(tasks.size() - 1);
  std::vector<double> widths(segments.size());
  for (std::size_t t = 0, first = 0; t < segments.size(); ++t) {
    segments[t].first = first;
    for (std::size_t r = tasks[t]; r < tasks[t + 1]; ++r) first += ranges[r].count;
  }
  qnv::parallel_for(
      segments.size(),
      [&](std::size_t t) {
        Segment& segment = segments[t];
        for (std::size_t r = tasks[t]; r < tasks[t + 1]; ++r)
          segment.count +=
              Preparer(ranges[r], *camera)
                  .run(ranges[r].first, ranges[r].first + ranges[r].count, discs + segment.first + segment.count);
        for (std::size_t i = segment.first; i < segment.first + segment.count; ++i)
          widths[t] += width_of(discs[i].bell);
      },
      view.threads);
  double width = 0;
  for (std::size_t t = 0; t < segments.size(); ++t) {
    layer.discs += segments[t].count;
    width += widths[t];
  }
  if (layer.discs == 0) return layer;
  const Bins bins = bin(discs, segments, *camera, view.threads);
  SplatKind kind;
  kind.cubes = !pieces.front().cloud->cells.empty();
  kind.colored = colored;
  kind.sides = pieces.front().cloud->description.two_sided;
  // The bounds of a disc are four bells wide.
  kind.smooth = width > 4.0 * kSmoothFrom * static_cast<double>(layer.discs);
  layer.width = view.width;
  layer.height = view.height;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layer.depth.assign(pixels, 0);
  layer.normals.assign(4 * pixels, 0);
  if (colored) layer.colors.assign(4 * pixels, 0);
  qnv::parallel_for(
      static_cast<std::size_t>(bins.columns) * static_cast<std::size_t>(bins.rows),
      [&](std::size_t t) {
        if (bins.begin[t] == bins.begin[t + 1]) return;
        const int left = static_cast<int>(t) % bins.columns * kTile,
                  bottom = static_cast<int>(t) / bins.columns * kTile;
        thread_local const auto tile = std::make_unique<SplatTile>();
        splat_kernel().tile(discs, std::span(bins.discs).subspan(bins.begin[t], bins.begin[t + 1] - bins.begin[t]),
                            camera->rays, left, bottom, kind, *tile);
        resolve(*tile, left, bottom, view, *camera, kind, layer);
      },
      view.threads);
  return layer;
}

SplatSurvey survey_surface(std::span<const SplatPiece> pieces, const SplatView& view, std::size_t most) {
  SplatSurvey survey;
  const auto camera = splat_camera(view);
  std::size_t all = 0;
  for (const SplatPiece& piece : pieces) all += piece.count;
  if (!camera || all == 0 || most == 0) return survey;
  const std::size_t step = (all + most - 1) / most;
  double width = 0, in_view = 0;
  std::vector<SplatDisc> discs;
  for (const SplatPiece& piece : pieces) {
    const std::size_t looked_at = (piece.count + step - 1) / step;
    discs.resize(looked_at);
    discs.resize(Preparer(piece, *camera).run(piece.first, piece.first + piece.count, discs.data(), step));
    const double share = static_cast<double>(piece.count) / static_cast<double>(std::max<std::size_t>(looked_at, 1));
    for (const SplatDisc& disc : discs) {
      width += share * width_of(disc.bell);
      survey.samples += share * width_of(disc.bell) * (1 + disc.bell.y1 - disc.bell.y0);
    }
    in_view += share * static_cast<double>(discs.size());
  }
  survey.discs = static_cast<std::size_t>(std::llround(in_view));
  survey.smooth = width > 4.0 * kSmoothFrom * in_view;
  return survey;
}

std::string_view splat_instructions() { return &splat_kernel() == &splat_kernel_baseline() ? "SSE2" : "AVX2"; }

}  // namespace gs::render
