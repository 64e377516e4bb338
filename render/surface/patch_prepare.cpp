#include "render/surface/patch_prepare.h"

#include "render/scene/color_ramps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

// Without fused multiplications and additions: a vertex that two patches share must come out the same in both.
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off")
#endif

namespace gs::render {
namespace {

using qnv::PatchVertex;

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

/// Four of four numbers each: rows become columns.
inline void transpose(std::array<Float4, 4>& v) {
  const Float4 a = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5), b = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5),
               c = __builtin_shufflevector(v[0], v[1], 2, 6, 3, 7), d = __builtin_shufflevector(v[2], v[3], 2, 6, 3, 7);
  v = {__builtin_shufflevector(a, b, 0, 1, 4, 5), __builtin_shufflevector(a, b, 2, 3, 6, 7),
       __builtin_shufflevector(c, d, 0, 1, 4, 5), __builtin_shufflevector(c, d, 2, 3, 6, 7)};
}

std::uint32_t packed_color(const qnv::Rgb8& c) {
  return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 | static_cast<std::uint32_t>(c.b) << 16;
}

class PatchPreparation {
 public:
  PatchPreparation(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const PatchLens& lens,
                   const PatchGrid& grid, const PatchRasterOptions& options, bool colored, PatchTask& task)
      : surface_(surface), cut_(cut), lens_(lens), grid_(grid), options_(options), colored_(colored), task_(task) {}

  void run() {
    task_.vertices.clear();
    task_.colors.clear();
    task_.triangles.clear();
    for (std::size_t i = task_.first; i < task_.last; ++i) add(*surface_.parts[cut_.patches[i].part], cut_.patches[i]);
    sort();
  }

 private:
  void add(const qnv::PatchSurface& part, const qnv::PatchCut& one) {
    mesh_.build(part, one);
    const std::size_t count = mesh_.vertices().size(), start = task_.vertices.size();
    task_.vertices.resize(start + count + 3);
    lens_.project(mesh_.vertices().data(), count, task_.vertices.data() + start);
    task_.vertices.resize(start + count);
    if (colored_) add_colors(one);
    for (const auto& triangles : {mesh_.inner(), mesh_.border()}) {
      const ScreenVertex* const v = task_.vertices.data() + start;
      cut_off_.clear();
      for (const qnv::PatchMesh::Triangle& t : triangles) {
        const ScreenVertex &a = v[t[0]], &b = v[t[1]], &c = v[t[2]];
        if (a.inverse == 0 || b.inverse == 0 || c.inverse == 0)
          cut_off_.push_back(t);
        else
          keep(a, b, c, start + t[0], start + t[1], start + t[2]);
      }
      for (const qnv::PatchMesh::Triangle& t : cut_off_) clip(t, start);
    }
  }

  void add_colors(const qnv::PatchCut& one) {
    switch (options_.color_by) {
      case ColorBy::own:
        for (std::size_t i = 0; i < mesh_.vertices().size(); ++i)
          task_.colors.push_back(packed_color(mesh_.colors().empty() ? options_.color : mesh_.colors()[i]));
        break;
      case ColorBy::normal:
        for (const PatchVertex& v : mesh_.vertices()) {
          const glm::vec3 c = (qnv::unpack_direction(v.normal) * 0.5f + 0.5f) * 255.0f + 0.5f;
          const auto channel = [](float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f)); };
          task_.colors.push_back(packed_color({channel(c.x), channel(c.y), channel(c.z)}));
        }
        break;
      case ColorBy::level:
      case ColorBy::age:
        task_.colors.resize(task_.vertices.size(), packed_color(level_color(one.level, qnv::displaced::kDeepestPatch)));
        break;
      case ColorBy::chunk:
        task_.colors.resize(task_.vertices.size(), packed_color(chunk_color(one.patch)));
        break;
    }
  }

  // Where it covers no sample it is dropped.
  void keep(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c, std::size_t i, std::size_t j,
            std::size_t k) {
    SampleBox box(a, b, c);
    box.limit(0, grid_.width - 1, 0, grid_.height - 1);
    if (box.empty()) return;
    const std::int64_t area = lens_.mirrors ? -area_of(a, b, c) : area_of(a, b, c);
    if (area == 0 || (area < 0 && !options_.two_sided)) return;
    // Most triangles are so small that they have one sample to cover, or miss.
    if (box.x0 == box.x1 && box.y0 == box.y1 && !holds(a, b, c, area_of(a, b, c) < 0, box)) return;
    ScreenTriangle& t = task_.triangles.emplace_back();
    t.corners = {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(k)};
    const auto tile = [](int sample) { return static_cast<std::uint32_t>(sample) / kTile; };
    t.tiles =
        tile(box.x0) | tile(box.y0) << 8 | (tile(box.x1) - tile(box.x0)) << 16 | (tile(box.y1) - tile(box.y0)) << 24;
  }

  [[gnu::always_inline]] static bool holds(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                                           bool turned, const SampleBox& box) {
    const std::int64_t x = std::int64_t{box.x0} * kSubsamples, y = std::int64_t{box.y0} * kSubsamples;
    const ScreenVertex &second = turned ? c : b, &third = turned ? b : c;
    const EdgeFunction<std::int64_t> ab(a, second, x, y), bc(second, third, x, y), ca(third, a, x, y);
    return ab.at >= ab.least && bc.at >= bc.least && ca.at >= ca.least;
  }

  /// A corner of what is left of a triangle, in camera space.
  struct Corner {
    glm::vec3 place{0}, normal{0}, color{0};
  };

  // Sutherland and Hodgman, against the near plane and the sides of the guard band.
  void clip(const qnv::PatchMesh::Triangle& triangle, std::size_t start) {
    std::vector<Corner> polygon, next;
    for (const auto number : triangle) {
      const PatchVertex& v = mesh_.vertices()[number];
      Corner& corner = polygon.emplace_back();
      corner.place = glm::vec3(lens_.camera_from_node * glm::vec4(v.position, 1));
      corner.normal = qnv::unpack_direction(v.normal);
      if (colored_) corner.color = unpacked_color(task_.colors[start + number]);
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
    const std::size_t first = task_.vertices.size();
    for (const Corner& corner : polygon) {
      const float depth = -corner.place.z;
      const glm::vec2 at = glm::vec2(corner.place) * lens_.scale / depth + glm::vec2(lens_.center_x, lens_.center_y);
      if (!(depth > 0) || !(std::abs(at.x) + std::abs(at.y) < static_cast<float>(2 * kGuard * kSubsamples))) break;
      task_.vertices.push_back({static_cast<std::int32_t>(std::lround(at.x)),
                                static_cast<std::int32_t>(std::lround(at.y)), 1 / depth,
                                qnv::pack_direction(corner.normal)});
      const auto channel = [](float c) { return static_cast<std::uint8_t>(std::clamp(c, 0.0f, 255.0f)); };
      if (colored_)
        task_.colors.push_back(
            packed_color({channel(corner.color.r), channel(corner.color.g), channel(corner.color.b)}));
    }
    const ScreenVertex* const v = task_.vertices.data() + first;
    for (std::size_t i = 2; i < task_.vertices.size() - first; ++i)
      keep(v[0], v[i - 1], v[i], first, first + i - 1, first + i);
  }

  template <class Body>
  void for_each_tile(const ScreenTriangle& t, Body body) const {
    const std::size_t left = t.tiles & 255u, low = t.tiles >> 8 & 255u, right = t.tiles >> 16 & 255u,
                      up = t.tiles >> 24;
    for (std::size_t y = low; y <= low + up; ++y)
      for (std::size_t x = left; x <= left + right; ++x) body(y * static_cast<std::size_t>(grid_.columns) + x);
  }

  void sort() {
    // Two places on, so that each tile's place can move on while it is filled, and is then where the next one begins.
    std::vector<std::uint32_t>& begin = task_.begin;
    begin.assign(grid_.size() + 2, 0);
    for (const ScreenTriangle& t : task_.triangles) for_each_tile(t, [&](std::size_t tile) { ++begin[tile + 2]; });
    for (std::size_t tile = 2; tile < begin.size(); ++tile) begin[tile] += begin[tile - 1];
    task_.order.resize(begin.back());
    for (std::size_t i = 0; i < task_.triangles.size(); ++i)
      for_each_tile(task_.triangles[i],
                    [&](std::size_t tile) { task_.order[begin[tile + 1]++] = static_cast<std::uint32_t>(i); });
  }

  const qnv::SurfacePatches& surface_;
  const qnv::SurfaceCut& cut_;
  const PatchLens& lens_;
  const PatchGrid& grid_;
  const PatchRasterOptions& options_;
  bool colored_;
  PatchTask& task_;
  qnv::PatchMesh mesh_;
  std::vector<qnv::PatchMesh::Triangle> cut_off_;
};

}  // namespace

void PatchLens::project(const PatchVertex* from, std::size_t count, ScreenVertex* to) const {
  constexpr float kFar = static_cast<float>(kGuard) * kSubsamples;
  for (std::size_t i = 0; i < count; i += 4) {
    std::array<Float4, 4> v;
    std::memcpy(v.data(), from + i, sizeof(v));
    transpose(v);
    const auto dot = [&](const glm::vec4& row) { return v[0] * row.x + v[1] * row.y + v[2] * row.z + row.w; };
    const Float4 d = dot(depth), inverse = 1.0f / d;
    const Float4 sx = dot(x) * inverse + center_x, sy = dot(y) * inverse + center_y;
    const Int4 good = (d > near_plane) & (d < 3e38f) & (sx > -kFar) & (sx < kFar) & (sy > -kFar) & (sy < kFar);
    const auto kept = [&](const Float4& value) { return std::bit_cast<Float4>(std::bit_cast<Int4>(value) & good); };
    // To the nearest, on both sides of zero.
    const auto rounded = [&](const Float4& value) {
      const Float4 positive = kept(value) + (kFar + 0.5f);
      return std::bit_cast<Float4>(__builtin_convertvector(positive, Int4) - static_cast<std::int32_t>(kFar));
    };
    v = {rounded(sx), rounded(sy), kept(inverse), v[3]};
    transpose(v);
    std::memcpy(static_cast<void*>(to + i), v.data(), sizeof(v));
  }
}

void prepare_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const PatchLens& lens,
                     const PatchGrid& grid, const PatchRasterOptions& options, bool colored, PatchTask& task) {
  PatchPreparation(surface, cut, lens, grid, options, colored, task).run();
}

}  // namespace gs::render
