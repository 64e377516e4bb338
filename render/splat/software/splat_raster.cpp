#include "render/splat/software/splat_raster.h"

#include "base/parallel.h"
#include "render/splat/software/splat_camera.h"
#include "render/splat/software/splat_constants.h"
#include "render/splat/software/splat_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace gs::render {
namespace {

// Splats per preparation task. They should stay in the second-level cache until they are sorted. Tasks have more splats
// if there would be more than kMaxTasks tasks.
constexpr std::size_t kTaskRange = 16384, kMaxTasks = 256;
constexpr int kMaxSamples = 65535;  // maximum samples along a side of the viewport

SplatSource source_of(const SplatPiece& piece, const SplatView& view) {
  const qnv::Splats& splats = *piece.splats;
  SplatSource source;
  source.positions = splats.positions.data() + piece.first;
  source.normals = splats.normals.data() + piece.first;
  source.weights = splats.weights.data() + piece.first;
  if (!splats.colors.empty() && !piece.tint) source.colors = splats.colors.data() + piece.first;
  if (!splats.cells.empty()) source.cells = splats.cells.data() + piece.first;
  source.count = piece.count;
  source.growth = std::max(piece.growth, 1.0f);
  source.color = splat_color(piece.tint.value_or(splats.color));
  source.two_sided = splats.description.two_sided;
  source.color_by_normal = view.color_by_normal;
  return source;
}

/// Rectangle of samples to which a splat may contribute. Both ends are inclusive.
struct Extent {
  explicit Extent(const SplatDisc& disc)
      : x0(static_cast<int>(disc.low & 0xffff)),
        y0(static_cast<int>(disc.low >> 16)),
        x1(static_cast<int>(disc.high & 0xffff)),
        y1(static_cast<int>(disc.high >> 16)) {}
  [[nodiscard]] int width() const { return 1 + x1 - x0; }
  [[nodiscard]] std::uint64_t samples() const {
    return static_cast<std::uint64_t>(width()) * static_cast<std::uint64_t>(1 + y1 - y0);
  }
  int x0, y0, x1, y1;
};

/// Work of one task: successive parts of pieces, and their splats that are in view.
struct Segment {
  std::vector<SplatPiece> parts;
  std::size_t first = 0, count = 0;         // range in the splats of the image
  std::uint64_t samples = 0, width = 0;     // sums over the splats: covered samples, width of the bounding boxes
  std::vector<std::uint32_t> begin, discs;  // start of each tile in `discs`; splat indexes, by tile
};

std::vector<Segment> segments_of(std::span<const SplatPiece> pieces) {
  std::size_t all = 0;
  for (const SplatPiece& piece : pieces) all += piece.count;
  const std::size_t range = std::max(kTaskRange, all / kMaxTasks);
  std::vector<Segment> segments(1);
  std::size_t in_task = 0, first = 0;
  for (const SplatPiece& piece : pieces)
    for (std::size_t i = 0; i < piece.count; i += range) {
      SplatPiece part = piece;
      part.first = piece.first + i;
      part.count = std::min(range, piece.count - i);
      if (in_task + part.count > range && in_task > 0) {
        first += in_task + 1;  // one more, for the additional splat that `prepare` may write
        segments.emplace_back().first = first;
        in_task = 0;
      }
      in_task += part.count;
      segments.back().parts.push_back(part);
    }
  return segments;
}

std::size_t room_for(const std::vector<Segment>& segments) {
  std::size_t room = segments.back().first + 1;
  for (const SplatPiece& part : segments.back().parts) room += part.count;
  return room;
}

/// Returns memory for the splats of an image. Reuses it for later images: new memory would take as long as preparing
/// the splats.
SplatDisc* disc_memory(std::size_t count) {
  thread_local std::unique_ptr<SplatDisc[]> memory;
  thread_local std::size_t size = 0;
  if (count > size) {
    memory.reset();  // free the old memory before allocating
    memory.reset(new SplatDisc[count]);
    size = count;
  }
  return memory.get();
}

/// Grid of the tiles of an image.
struct Grid {
  explicit Grid(const SplatCamera& camera)
      : columns((camera.width + kTile - 1) / kTile), rows((camera.height + kTile - 1) / kTile) {}
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  int columns, rows;
};

/// Tiles that a splat touches.
struct Tiles {
  Tiles(const Extent& e, const Grid& grid)
      : first(tile(e.y0) * static_cast<std::size_t>(grid.columns) + tile(e.x0)),
        right(tile(e.x1) - tile(e.x0)),
        up(tile(e.y1) - tile(e.y0)),
        row(static_cast<std::size_t>(grid.columns)) {}
  static std::size_t tile(int sample) { return static_cast<unsigned>(sample) / kTile; }
  template <class Body>
  void for_each(Body body) const {
    if ((right | up) == 0) return body(first);  // one tile, the usual case
    for (std::size_t y = 0; y <= up; ++y)
      for (std::size_t x = 0; x <= right; ++x) body(first + y * row + x);
  }
  std::size_t first, right, up, row;
};

/// Counts every `step`-th splat of a segment in each tile that it touches. If these splats cover more than `most`
/// samples, leaves `begin` empty.
void count_in_tiles(Segment& segment, const SplatDisc* discs, const Grid& grid, std::size_t step, std::uint64_t most) {
  segment.begin.assign(grid.size() + 2, 0);
  // The offset of two makes room: sort_by_tiles() advances entries, which afterwards are the starts of the tiles.
  std::uint32_t* const counts = segment.begin.data() + 2;
  std::uint64_t samples = 0, width = 0;
  for (std::size_t i = 0; i < segment.count; i += step) {
    const Extent extent(discs[segment.first + i]);
    samples += extent.samples();
    width += static_cast<std::uint64_t>(extent.width());
    if (samples <= most) Tiles(extent, grid).for_each([&](std::size_t tile) { ++counts[tile]; });
  }
  if (samples > most) segment.begin.clear();
  if (step > 1) return;
  segment.samples = samples;
  segment.width = width;
}

/// Sorts every `step`-th splat of a segment by tile. Call it after count_in_tiles().
void sort_by_tiles(Segment& segment, const SplatDisc* discs, const Grid& grid, std::size_t step) {
  std::vector<std::uint32_t>& begin = segment.begin;
  for (std::size_t tile = 2; tile < begin.size(); ++tile) begin[tile] += begin[tile - 1];
  segment.discs.resize(begin.back());
  std::uint32_t* const next = begin.data() + 1;
  for (std::size_t i = 0; i < segment.count; i += step) {
    const auto disc = static_cast<std::uint32_t>(segment.first + i);
    Tiles(Extent(discs[disc]), grid).for_each([&](std::size_t tile) { segment.discs[next[tile]++] = disc; });
  }
}

/// Reports whether normals should follow the surface. `width` is the sum of the widths of `discs` bounding boxes, each
/// four bells wide.
bool is_smooth(double width, double discs) { return width > 4.0 * splat::kSmoothFrom * discs; }

/// Returns the supersampling: a power of two for which a side has at most kMaxSamples samples.
int supersample_of(const SplatView& view) {
  int s = static_cast<int>(std::bit_floor(static_cast<unsigned>(std::clamp(view.supersample, 1, 8))));
  while (s > 1 && std::max(view.width, view.height) > kMaxSamples / s) s /= 2;
  return s;
}

/// Removes splats with a centre outside of the ClipPlanes. Returns the number of the others.
std::size_t clip_discs(SplatDisc* discs, std::size_t count, const ClipSpace& clip) {
  if (clip.count == 0) return count;
  return static_cast<std::size_t>(
      std::remove_if(discs, discs + count, [&](const SplatDisc& disc) { return !clip.contains(disc.place); }) - discs);
}

/// Prepares all splats and sorts them by tile. Returns the step between splats that are drawn.
std::size_t prepare_all(std::vector<Segment>& segments, const SplatView& view, const SplatCamera& camera,
                        const Grid& grid, const SplatKernel& kernel, std::uint64_t most, SplatDisc* discs) {
  parallel_for(
      segments.size(),
      [&](std::size_t i) {
        Segment& segment = segments[i];
        for (const SplatPiece& part : segment.parts) {
          SplatDisc* const fresh = discs + segment.first + segment.count;
          segment.count += clip_discs(fresh, kernel.prepare(source_of(part, view), camera, fresh), camera.clip);
        }
        // Sort now, while the data is in the cache, unless there are so many splats that they may need thinning.
        count_in_tiles(segment, discs, grid, 1, most / segments.size());
        if (!segment.begin.empty()) sort_by_tiles(segment, discs, grid, 1);
      },
      view.threads);
  std::uint64_t samples = 0;
  bool sorted = true;
  for (const Segment& segment : segments) {
    samples += segment.samples;
    sorted = sorted && !segment.begin.empty();
  }
  const std::size_t step = samples / std::max<std::uint64_t>(most, 1) + 1;
  if (sorted && step == 1) return step;
  parallel_for(
      segments.size(),
      [&](std::size_t i) {
        if (step == 1 && !segments[i].begin.empty()) return;
        count_in_tiles(segments[i], discs, grid, step, std::numeric_limits<std::uint64_t>::max());
        sort_by_tiles(segments[i], discs, grid, step);
      },
      view.threads);
  return step;
}

}  // namespace

SplatLayer rasterize_surface(const qnv::Splats& splats, const SplatView& view) {
  const SplatPiece whole{&splats, 0, splats.size()};
  return rasterize_surface(std::span(&whole, 1), view);
}

SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view) {
  return rasterize_surface(pieces, view, splat_kernels().front());
}

SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& wanted, const SplatKernel& kernel,
                             std::uint64_t most_samples) {
  SplatLayer layer;
  SplatView view = wanted;
  view.supersample = supersample_of(wanted);
  if (pieces.empty() || view.width < 1 || view.height < 1 || std::max(view.width, view.height) > kMaxSamples)
    return layer;
  const auto camera = splat_camera(view);
  if (!camera) return layer;
  std::vector<Segment> segments = segments_of(pieces);
  const std::size_t room = room_for(segments);
  if (room > std::numeric_limits<std::uint32_t>::max()) return layer;
  SplatDisc* const discs = disc_memory(room);
  const Grid grid(*camera);
  const std::size_t step = prepare_all(segments, view, *camera, grid, kernel, most_samples, discs);
  std::uint64_t width = 0;
  for (const Segment& segment : segments) {
    layer.discs += segment.count;
    layer.drawn += (segment.count + step - 1) / step;
    width += segment.width;
  }
  if (layer.discs == 0) return layer;
  SplatKind kind;
  kind.cubes = !pieces.front().splats->cells.empty();
  kind.sides = pieces.front().splats->description.two_sided;
  kind.smooth = is_smooth(static_cast<double>(width), static_cast<double>(layer.discs));
  kind.colored = view.color_by_normal || std::any_of(pieces.begin(), pieces.end(), [](const SplatPiece& piece) {
                   return piece.tint || !piece.splats->colors.empty();
                 });
  layer.width = view.width;
  layer.height = view.height;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layer.depth.resize(pixels);
  layer.normals.resize(4 * pixels);
  if (kind.colored) layer.colors.resize(4 * pixels);
  const SplatTarget target{view.width,         view.height,          view.supersample,
                           layer.depth.data(), layer.normals.data(), kind.colored ? layer.colors.data() : nullptr};
  parallel_for(
      grid.size(),
      [&](std::size_t t) {
        thread_local const auto tile = std::make_unique<SplatTile>();
        thread_local std::vector<std::uint32_t> chosen;  // reused for the next tile, as is `tile`
        chosen.clear();
        for (const Segment& segment : segments)
          chosen.insert(chosen.end(), segment.discs.begin() + segment.begin[t],
                        segment.discs.begin() + segment.begin[t + 1]);
        kernel.draw(discs, chosen, *camera, static_cast<int>(t) % grid.columns * kTile,
                    static_cast<int>(t) / grid.columns * kTile, kind, *tile, target);
      },
      view.threads);
  return layer;
}

SurfaceMeasure measure_surface(std::span<const SplatPiece> pieces, const SplatView& wanted, std::size_t most) {
  SurfaceMeasure survey;
  SplatView view = wanted;
  view.supersample = supersample_of(wanted);
  if (view.width < 1 || view.height < 1 || std::max(view.width, view.height) > kMaxSamples) return survey;
  const auto camera = splat_camera(view);
  std::size_t all = 0;
  for (const SplatPiece& piece : pieces) all += piece.count;
  if (!camera || all == 0 || most == 0) return survey;
  const std::size_t step = (all + most - 1) / most;
  double width = 0, in_view = 0;
  std::vector<SplatDisc> discs;
  for (const SplatPiece& piece : pieces) {
    qnv::Splats sample;
    const std::size_t looked_at = (piece.count + step - 1) / step;
    SplatPiece looked{piece};
    if (step > 1) {
      sample.description.two_sided = piece.splats->description.two_sided;
      for (std::size_t i = 0; i < piece.count; i += step) {
        const std::size_t at = piece.first + i;
        sample.positions.push_back(piece.splats->positions[at]);
        sample.normals.push_back(piece.splats->normals[at]);
        sample.weights.push_back(piece.splats->weights[at]);
        if (!piece.splats->cells.empty()) sample.cells.push_back(piece.splats->cells[at]);
      }
      looked = {&sample, 0, looked_at, piece.growth};
    }
    discs.resize(looked_at + 1);
    discs.resize(splat_kernels().front().prepare(source_of(looked, view), *camera, discs.data()));
    const double share = static_cast<double>(piece.count) / static_cast<double>(std::max<std::size_t>(looked_at, 1));
    for (const SplatDisc& disc : discs) {
      const Extent extent(disc);
      width += share * extent.width();
      survey.samples += share * static_cast<double>(extent.samples());
    }
    in_view += share * static_cast<double>(discs.size());
  }
  survey.discs = static_cast<std::size_t>(std::llround(in_view));
  survey.smooth = is_smooth(width, in_view);
  return survey;
}

}  // namespace gs::render
