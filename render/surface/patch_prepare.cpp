#include "render/surface/patch_prepare.h"

#include "render/scene/color_ramps.h"

#include <algorithm>
#include <cmath>

namespace gs::render {
namespace {

using qnv::PatchVertex;

std::uint32_t packed_color(const qnv::Rgb8& c) {
  return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 | static_cast<std::uint32_t>(c.b) << 16;
}

glm::vec3 unpacked_color(std::uint32_t c) {
  return {static_cast<float>(c & 255u), static_cast<float>(c >> 8 & 255u), static_cast<float>(c >> 16 & 255u)};
}

/// Memory that later patches and images reuse.
struct PatchScratch {
  qnv::PatchMesh mesh;
  std::vector<ScreenVertex> vertices;
  SiftedTriangles sifted;
};

class PatchPreparation {
 public:
  PatchPreparation(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const PatchLens& lens,
                   const PatchGrid& grid, const PatchRasterOptions& options, const PatchLook& look,
                   const PatchKernel& kernel, PatchScratch& scratch, PatchTask& task)
      : surface_(surface),
        cut_(cut),
        lens_(lens),
        grid_(grid),
        options_(options),
        look_(look),
        kernel_(kernel),
        mesh_(scratch.mesh),
        vertices_(scratch.vertices),
        sifted_(scratch.sifted),
        task_(task) {}

  void run() {
    task_.vertices = task_.drawn = 0;
    task_.keys.clear();
    task_.samples.clear();
    task_.colors.clear();
    task_.runs.clear();
    task_.triangles.clear();
    for (std::size_t i = task_.first; i < task_.last; ++i) add(*surface_.parts[cut_.patches[i].part], cut_.patches[i]);
    sort();
  }

 private:
  void add(const qnv::PatchSurface& part, const qnv::PatchCut& one) {
    mesh_.build(part, one);
    const std::size_t count = mesh_.vertices().size(), first = task_.samples.size();
    if (vertices_.size() < count + kPatchRoom) vertices_.resize(count + kPatchRoom);
    kernel_.project(mesh_.vertices().data(), count, lens_, vertices_.data());
    task_.vertices += count;
    if (look_.colored) add_colors(one);
    draw(mesh_.inner());
    draw(mesh_.border());
    find_runs(first);
  }

  void draw(std::span<const PatchTriangle> triangles) {
    if (triangles.empty()) return;
    kernel_.sift(vertices_.data(), triangles, look_, sifted_);
    task_.drawn += sifted_.narrows + sifted_.wides;
    draw_small(triangles, std::span(sifted_.narrow).first(sifted_.narrows), 2);
    draw_small(triangles, std::span(sifted_.wide).first(sifted_.wides), kSmallTriangle);
    for (std::size_t i = 0; i < sifted_.larges; ++i) {
      const PatchTriangle& t = triangles[sifted_.large[i]];
      const ScreenVertex &a = vertices_[t[0]], &b = vertices_[t[1]], &c = vertices_[t[2]];
      if (a.inverse == 0 || b.inverse == 0 || c.inverse == 0)
        clip(t);
      else
        keep(a, b, c);
    }
  }

  void draw_small(std::span<const PatchTriangle> triangles, std::span<const std::uint32_t> chosen, int side) {
    if (chosen.empty()) return;
    const std::size_t first = task_.samples.size(),
                      most = first + chosen.size() * static_cast<std::size_t>(side * side) + kPatchRoom;
    const auto resize = [&](std::size_t size) {
      task_.keys.resize(size);
      task_.samples.resize(size);
      if (look_.colored) task_.colors.resize(size);
    };
    resize(most);
    const PatchSamples out{task_.keys.data() + first, task_.samples.data() + first,
                           look_.colored ? task_.colors.data() + first : nullptr};
    resize(first + kernel_.draw_small(vertices_.data(), triangles.data(), chosen, side, grid_, look_, out));
  }

  // Groups the samples from index `first` on into runs. Successive samples are usually in one tile.
  void find_runs(std::size_t first) {
    const std::size_t count = task_.samples.size();
    const std::uint32_t* const samples = task_.samples.data();
    while (first < count) {
      const std::uint32_t tile = samples[first] >> kTileBits;
      std::size_t last = first + 1;
      while (last < count && samples[last] >> kTileBits == tile) ++last;
      task_.runs.push_back({tile, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)});
      first = last;
    }
  }

  void add_colors(const qnv::PatchCut& one) {
    const std::span<const PatchVertex> from = mesh_.vertices();
    const auto fill = [&](const qnv::Rgb8& color) {
      for (std::size_t i = 0; i < from.size(); ++i) vertices_[i].color = packed_color(color);
    };
    switch (options_.color_by) {
      case ColorBy::own:
        if (mesh_.colors().empty()) return fill(options_.color);
        for (std::size_t i = 0; i < from.size(); ++i) vertices_[i].color = packed_color(mesh_.colors()[i]);
        break;
      case ColorBy::normal:
        for (std::size_t i = 0; i < from.size(); ++i) {
          const glm::vec3 c = (qnv::unpack_direction(from[i].normal) * 0.5f + 0.5f) * 255.0f + 0.5f;
          const auto channel = [](float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f)); };
          vertices_[i].color = packed_color({channel(c.x), channel(c.y), channel(c.z)});
        }
        break;
      case ColorBy::level:
      case ColorBy::age:
        fill(level_color(one.level, qnv::displaced::kDeepestPatch));
        break;
      case ColorBy::chunk:
        fill(chunk_color(one.patch));
        break;
    }
  }

  // Adds a large triangle. Drops it if it is invisible.
  void keep(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
    SampleBox box(a, b, c);
    box.limit(0, grid_.width - 1, 0, grid_.height - 1);
    if (box.empty()) return;
    const std::int64_t area = look_.mirrors ? -area_of(a, b, c) : area_of(a, b, c);
    if (area == 0 || (area < 0 && !look_.two_sided)) return;
    ScreenTriangle& t = task_.triangles.emplace_back();
    t.corners = {a, b, c};
    const auto tile = [](int sample) { return static_cast<std::uint32_t>(sample) / kTile; };
    t.tiles =
        tile(box.x0) | tile(box.y0) << 8 | (tile(box.x1) - tile(box.x0)) << 16 | (tile(box.y1) - tile(box.y0)) << 24;
    ++task_.drawn;
  }

  /// Vertex of a clipped triangle, in camera space.
  struct Corner {
    glm::vec3 place{0}, normal{0}, color{0};
  };

  // Clips a triangle (Sutherland and Hodgman) at the near plane and the sides of the guard band.
  void clip(const PatchTriangle& triangle) {
    std::vector<Corner> polygon, next;
    for (const auto number : triangle) {
      const PatchVertex& v = mesh_.vertices()[number];
      Corner& corner = polygon.emplace_back();
      corner.place = glm::vec3(lens_.camera_from_node * glm::vec4(v.position, 1));
      corner.normal = qnv::unpack_direction(v.normal);
      if (look_.colored) corner.color = unpacked_color(vertices_[number].color);
    }
    const glm::vec2 reach = glm::vec2(0.49f * kGuard * kSubsamples) / lens_.scale;
    const std::array<glm::vec4, 5> planes{{{0, 0, -1, -lens_.near_plane * 1.0001f},
                                           {1, 0, -reach.x, 0},
                                           {-1, 0, -reach.x, 0},
                                           {0, 1, -reach.y, 0},
                                           {0, -1, -reach.y, 0}}};
    for (const glm::vec4& plane : planes) {
      next.clear();
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const float at_a = glm::dot(glm::vec3(plane), a.place) + plane.w,
                    at_b = glm::dot(glm::vec3(plane), b.place) + plane.w;
        if (at_a >= 0) next.push_back(a);
        if ((at_a >= 0) == (at_b >= 0)) continue;
        const float part = at_a / (at_a - at_b);
        next.push_back(
            {glm::mix(a.place, b.place, part), glm::mix(a.normal, b.normal, part), glm::mix(a.color, b.color, part)});
      }
      polygon.swap(next);
    }
    std::vector<ScreenVertex> corners;
    for (const Corner& corner : polygon) {
      const float depth = -corner.place.z;
      const glm::vec2 at = glm::vec2(corner.place) * lens_.scale / depth + glm::vec2(lens_.center_x, lens_.center_y);
      if (!(depth > 0) || !(std::abs(at.x) + std::abs(at.y) < static_cast<float>(2 * kGuard * kSubsamples))) break;
      const auto channel = [](float c) { return static_cast<std::uint8_t>(std::clamp(c, 0.0f, 255.0f)); };
      const qnv::Rgb8 color{channel(corner.color.r), channel(corner.color.g), channel(corner.color.b)};
      corners.push_back(
          {std::round(at.x), std::round(at.y), 1 / depth, packed_color(color), corner.normal * (1 / depth), 0});
    }
    for (std::size_t i = 2; i < corners.size(); ++i) keep(corners[0], corners[i - 1], corners[i]);
  }

  template <class Body>
  void for_each_tile(const ScreenTriangle& t, Body body) const {
    const std::size_t left = t.tiles & 255u, low = t.tiles >> 8 & 255u, right = t.tiles >> 16 & 255u,
                      up = t.tiles >> 24;
    for (std::size_t y = low; y <= low + up; ++y)
      for (std::size_t x = left; x <= left + right; ++x) body(y * static_cast<std::size_t>(grid_.columns) + x);
  }

  /// Sorts elements by tile. `each(body)` calls body(tile, index) for all elements, always in the same order.
  template <class Each>
  void sort_by_tiles(Each each, std::vector<std::uint32_t>& begin, std::vector<std::uint32_t>& order) const {
    // The offset of two makes room: filling the tiles advances entries, which afterwards are the starts of the tiles.
    begin.assign(grid_.size() + 2, 0);
    each([&](std::size_t tile, std::size_t) { ++begin[tile + 2]; });
    for (std::size_t tile = 2; tile < begin.size(); ++tile) begin[tile] += begin[tile - 1];
    order.resize(begin.back());
    each([&](std::size_t tile, std::size_t number) { order[begin[tile + 1]++] = static_cast<std::uint32_t>(number); });
  }

  void sort() {
    sort_by_tiles(
        [&](auto body) {
          for (std::size_t i = 0; i < task_.runs.size(); ++i) body(task_.runs[i].tile, i);
        },
        task_.run_begin, task_.run_order);
    sort_by_tiles(
        [&](auto body) {
          for (std::size_t i = 0; i < task_.triangles.size(); ++i)
            for_each_tile(task_.triangles[i], [&](std::size_t tile) { body(tile, i); });
        },
        task_.begin, task_.order);
  }

  const qnv::SurfacePatches& surface_;
  const qnv::SurfaceCut& cut_;
  const PatchLens& lens_;
  const PatchGrid& grid_;
  const PatchRasterOptions& options_;
  const PatchLook& look_;
  const PatchKernel& kernel_;
  qnv::PatchMesh& mesh_;
  std::vector<ScreenVertex>& vertices_;
  SiftedTriangles& sifted_;
  PatchTask& task_;
};

}  // namespace

void prepare_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const PatchLens& lens,
                     const PatchGrid& grid, const PatchRasterOptions& options, const PatchLook& look,
                     const PatchKernel& kernel, PatchTask& task) {
  thread_local PatchScratch scratch;
  PatchPreparation(surface, cut, lens, grid, options, look, kernel, scratch, task).run();
}

}  // namespace gs::render
