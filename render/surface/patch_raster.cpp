#include "render/surface/patch_raster.h"

#include "qnv/base/parallel.h"
#include "qnv/surface/patch_mesh.h"
#include "render/scene/color_ramps.h"
#include "render/splat/splat_camera.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <vector>

// Without fused multiplications and additions: a vertex that two patches share must come out the same in both.
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off")
#endif

namespace gs::render {
namespace {

using qnv::PatchVertex;

constexpr int kSubsampleBits = 8, kSubsamples = 1 << kSubsampleBits;  // places of a vertex between two samples
constexpr int kGuard = 8192;                                          // samples beyond which a triangle is cut
constexpr std::size_t kTaskVertices = 32768;                          // that one task prepares, about

/// A vertex on the screen: places count in 1 / kSubsamples of samples from the middle of sample (0, 0).
struct ScreenVertex {
  std::int32_t x, y;
  float inverse;  // of its depth; 0: the triangle must be cut
  std::uint32_t normal;
};
static_assert(sizeof(ScreenVertex) == 16 && sizeof(PatchVertex) == 16);

/// Corners are vertices of the task.
struct ScreenTriangle {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t tiles;  // the first that it meets: column | row << 8; how many more: << 16, << 24
};

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

/// Four of four numbers each: rows become columns.
inline void transpose(std::array<Float4, 4>& v) {
  const Float4 a = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5), b = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5),
               c = __builtin_shufflevector(v[0], v[1], 2, 6, 3, 7), d = __builtin_shufflevector(v[2], v[3], 2, 6, 3, 7);
  v = {__builtin_shufflevector(a, b, 0, 1, 4, 5), __builtin_shufflevector(a, b, 2, 3, 6, 7),
       __builtin_shufflevector(c, d, 0, 1, 4, 5), __builtin_shufflevector(c, d, 2, 3, 6, 7)};
}

/// From the node's space to samples.
struct PatchLens {
  glm::vec4 x, y, depth;  // rows: x and y are divided by the depth
  float center_x, center_y, near_plane;
  bool mirrors;  // the node's triangles turn the other way on the screen
  glm::mat4 camera_from_node;
  glm::vec2 scale;  // samples times kSubsamples a unit at depth 1

  PatchLens(const SplatCamera& camera, const SplatView& view)
      : near_plane(view.near_plane),
        mirrors(glm::determinant(glm::mat3(camera.camera_from_node)) < 0),
        camera_from_node(camera.camera_from_node) {
    scale = glm::vec2(static_cast<float>(camera.width), static_cast<float>(camera.height)) / (2.0f * camera.tangents) *
            static_cast<float>(kSubsamples);
    const auto row = [&](int r) {
      return glm::vec4(camera_from_node[0][r], camera_from_node[1][r], camera_from_node[2][r], camera_from_node[3][r]);
    };
    x = row(0) * scale.x;
    y = row(1) * scale.y;
    depth = -row(2);
    center_x = (camera.tangents.x - camera.center.x) * scale.x - 0.5f * kSubsamples;
    center_y = (camera.tangents.y - camera.center.y) * scale.y - 0.5f * kSubsamples;
  }

  /// `to` and `from` have room for a multiple of four.
  void project(const PatchVertex* from, std::size_t count, ScreenVertex* to) const {
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
};

/// The tiles of a picture.
struct PatchGrid {
  explicit PatchGrid(const SplatCamera& camera)
      : columns((camera.width + kTile - 1) / kTile),
        rows((camera.height + kTile - 1) / kTile),
        width(camera.width),
        height(camera.height) {}
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  int columns, rows, width, height;
};

/// What one task prepares.
struct PatchTask {
  std::size_t first = 0, last = 0;  // patches of the cut
  std::vector<ScreenVertex> vertices;
  std::vector<std::uint32_t> colors;
  std::vector<ScreenTriangle> triangles;
  std::vector<std::uint32_t> begin, order;  // triangles of each tile, tile by tile
};

std::uint32_t packed_color(const qnv::Rgb8& c) {
  return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 | static_cast<std::uint32_t>(c.b) << 16;
}

glm::vec3 unpacked_color(std::uint32_t c) {
  return {static_cast<float>(c & 255u), static_cast<float>(c >> 8 & 255u), static_cast<float>(c >> 16 & 255u)};
}

/// Twice the area, positive where the corners go counter-clockwise.
std::int64_t area_of(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
  return static_cast<std::int64_t>(b.x - a.x) * (c.y - a.y) - static_cast<std::int64_t>(b.y - a.y) * (c.x - a.x);
}

/// The first and last samples that three places on the screen may hold between them.
struct SampleBox {
  SampleBox(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c)
      : x0((std::min({a.x, b.x, c.x}) + kSubsamples - 1) >> kSubsampleBits),
        x1(std::max({a.x, b.x, c.x}) >> kSubsampleBits),
        y0((std::min({a.y, b.y, c.y}) + kSubsamples - 1) >> kSubsampleBits),
        y1(std::max({a.y, b.y, c.y}) >> kSubsampleBits) {}
  void limit(int left, int right, int bottom, int top) {
    x0 = std::max(x0, left);
    x1 = std::min(x1, right);
    y0 = std::max(y0, bottom);
    y1 = std::min(y1, top);
  }
  [[nodiscard]] bool empty() const { return x0 > x1 || y0 > y1; }
  int x0, x1, y0, y1;
};

/// Positive inside, and exactly the negative of that of the triangle on the other side.
template <class Number>
struct EdgeFunction {
  Number at, right, up;  // at a sample, and what the next one adds
  Number least;          // which of two triangles a sample on the edge belongs to
  EdgeFunction(const ScreenVertex& a, const ScreenVertex& b, Number x, Number y) {
    const Number dx = b.x - a.x, dy = b.y - a.y;
    at = dx * (y - a.y) - dy * (x - a.x);
    right = -dy * kSubsamples;
    up = dx * kSubsamples;
    least = dy < 0 || (dy == 0 && dx > 0) ? 0 : 1;
  }
};

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

/// The samples of one tile, row by row.
struct PatchTile {
  std::array<float, kTile * kTile> inverse;  // of the depth; 0: nothing
  std::array<glm::vec3, kTile * kTile> normal, color;
};

class PatchTileDrawing {
 public:
  PatchTileDrawing(int left, int bottom, const PatchGrid& grid, bool mirrors, bool colored, PatchTile& tile)
      : left_(left),
        bottom_(bottom),
        right_(std::min(left + kTile, grid.width) - 1),
        top_(std::min(bottom + kTile, grid.height) - 1),
        mirrors_(mirrors),
        colored_(colored),
        tile_(tile) {}

  void draw(const PatchTask& task, const ScreenTriangle& triangle) {
    std::array<std::uint32_t, 3> n = triangle.corners;
    const auto corner = [&](std::size_t k) -> const ScreenVertex& { return task.vertices[n[k]]; };
    const std::int64_t area = area_of(corner(0), corner(1), corner(2));
    if (area < 0) std::swap(n[1], n[2]);
    SampleBox box(corner(0), corner(1), corner(2));
    // Differences of less than 64 samples have products that fit 32 bits.
    const bool small = box.x1 - box.x0 < 60 && box.y1 - box.y0 < 60;
    box.limit(left_, right_, bottom_, top_);
    if (box.empty()) return;
    const Corners corners{{&corner(0), &corner(1), &corner(2)}, n, &task, (area < 0) != mirrors_};
    const float share = 1 / static_cast<float>(std::abs(area));
    if (small)
      fill<std::int32_t>(corners, share, box);
    else
      fill<std::int64_t>(corners, share, box);
  }

 private:
  struct Corners {
    std::array<const ScreenVertex*, 3> v;
    std::array<std::uint32_t, 3> numbers;
    const PatchTask* task;
    bool back;  // is seen
  };

  template <class Number>
  void fill(const Corners& t, float share, const SampleBox& box) {
    const Number x = static_cast<Number>(box.x0) * kSubsamples, y = static_cast<Number>(box.y0) * kSubsamples;
    EdgeFunction<Number> a(*t.v[1], *t.v[2], x, y), b(*t.v[2], *t.v[0], x, y), c(*t.v[0], *t.v[1], x, y);
    const glm::vec3 scale = share * glm::vec3(t.v[0]->inverse, t.v[1]->inverse, t.v[2]->inverse);
    for (int row = box.y0; row <= box.y1; ++row, a.at += a.up, b.at += b.up, c.at += c.up) {
      Number at_a = a.at, at_b = b.at, at_c = c.at;
      int sample = (row - bottom_) * kTile + box.x0 - left_;
      for (int column = box.x0; column <= box.x1;
           ++column, ++sample, at_a += a.right, at_b += b.right, at_c += c.right) {
        if (at_a < a.least || at_b < b.least || at_c < c.least) continue;
        const glm::vec3 weights = scale * glm::vec3(at_a, at_b, at_c);
        const float now = weights.x + weights.y + weights.z;
        float& nearest = tile_.inverse[static_cast<std::size_t>(sample)];
        if (now <= nearest) continue;
        nearest = now;
        write(t, weights, static_cast<std::size_t>(sample));
      }
    }
  }

  [[gnu::always_inline]] void write(const Corners& t, const glm::vec3& weights, std::size_t sample) {
    const glm::vec3 normal = qnv::unpack_direction(t.v[0]->normal) * weights.x +
                             qnv::unpack_direction(t.v[1]->normal) * weights.y +
                             qnv::unpack_direction(t.v[2]->normal) * weights.z;
    tile_.normal[sample] = t.back ? -normal : normal;
    if (!colored_) return;
    const auto color = [&](std::size_t k) { return unpacked_color(t.task->colors[t.numbers[k]]); };
    tile_.color[sample] =
        (color(0) * weights.x + color(1) * weights.y + color(2) * weights.z) / (weights.x + weights.y + weights.z);
  }

  int left_, bottom_, right_, top_;
  bool mirrors_, colored_;
  PatchTile& tile_;
};

/// The means of the samples of each pixel of a tile.
class PatchTileResolve {
 public:
  PatchTileResolve(const PatchTile& tile, const glm::mat3& normal_matrix, int left, int bottom, int supersample,
                   SplatLayer& layer)
      : tile_(tile),
        normal_matrix_(normal_matrix),
        left_(left / supersample),
        bottom_(bottom / supersample),
        supersample_(supersample),
        layer_(layer) {}

  void run() const {
    const int size = kTile / supersample_;
    for (int y = bottom_; y < std::min(bottom_ + size, layer_.height); ++y)
      for (int x = left_; x < std::min(left_ + size, layer_.width); ++x)
        pixel(x, y, static_cast<std::size_t>(y) * static_cast<std::size_t>(layer_.width) + static_cast<std::size_t>(x));
  }

 private:
  void pixel(int x, int y, std::size_t at) const {
    const bool colored = !layer_.colors.empty();
    glm::vec3 normal(0), color(0);
    float nearest = 0, covered = 0;
    const int first = (y - bottom_) * supersample_ * kTile + (x - left_) * supersample_;
    for (int v = 0; v < supersample_; ++v)
      for (int u = 0; u < supersample_; ++u) {
        const auto sample = static_cast<std::size_t>(first + v * kTile + u);
        const float inverse = tile_.inverse[sample];
        if (inverse == 0) continue;
        covered += 1;
        nearest = std::max(nearest, inverse);
        const glm::vec3& n = tile_.normal[sample];
        const float square = glm::dot(n, n);
        if (square > 0) normal += n * (1 / std::sqrt(square));
        if (colored) color += tile_.color[sample];
      }
    std::uint16_t* const out = layer_.normals.data() + 4 * at;
    if (covered == 0) {
      std::memset(out, 0, 8);
      layer_.depth[at] = 0;
      if (colored) std::memset(layer_.colors.data() + 4 * at, 0, 4);
      return;
    }
    layer_.depth[at] = 1 / nearest;
    normal = normal_matrix_ * normal;
    const float square = glm::dot(normal, normal);
    normal = square > 0 ? normal * (1 / std::sqrt(square)) : glm::vec3(0, 0, 1);
    const auto level = [](float v) {
      return static_cast<std::uint16_t>(std::clamp(v * 32767.5f + 32768, 0.0f, 65535.0f));
    };
    out[0] = level(normal.x);
    out[1] = level(normal.y);
    out[2] = level(normal.z);
    out[3] = static_cast<std::uint16_t>(65535 * covered / static_cast<float>(supersample_ * supersample_));
    if (!colored) return;
    color = color / covered + 0.5f;
    std::uint8_t* const rgb = layer_.colors.data() + 4 * at;
    for (int i = 0; i < 3; ++i) rgb[i] = static_cast<std::uint8_t>(std::min(color[i], 255.0f));
    rgb[3] = 0;
  }

  const PatchTile& tile_;
  const glm::mat3& normal_matrix_;
  int left_, bottom_, supersample_;
  SplatLayer& layer_;
};

/// A power of two that keeps the samples of an edge within the guard band.
int supersample_for(const SplatView& view) {
  int s = static_cast<int>(std::bit_floor(static_cast<unsigned>(std::clamp(view.supersample, 1, 8))));
  while (s > 1 && std::max(view.width, view.height) > kGuard / s) s /= 2;
  return s;
}

/// Kept from one picture to the next: fresh memory would cost as much as the vertices do.
std::span<PatchTask> tasks_of(const qnv::SurfaceCut& cut) {
  thread_local std::vector<PatchTask> tasks;
  std::size_t in_task = 0, used = 1;
  if (tasks.empty()) tasks.emplace_back();
  tasks[0].first = 0;
  for (std::size_t i = 0; i < cut.patches.size(); ++i) {
    const std::size_t count = qnv::patch_vertices(cut.patches[i].level);
    if (in_task > 0 && in_task + count > kTaskVertices) {
      tasks[used - 1].last = i;
      if (++used > tasks.size()) tasks.emplace_back();
      tasks[used - 1].first = i;
      in_task = 0;
    }
    in_task += count;
  }
  tasks[used - 1].last = cut.patches.size();
  tasks.resize(used);  // what a larger picture left behind is given back
  return tasks;
}

}  // namespace

SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const SplatView& wanted,
                             const PatchRasterOptions& options) {
  SplatLayer layer;
  SplatView view = wanted;
  view.supersample = supersample_for(wanted);
  if (cut.patches.empty() || view.width < 1 || view.height < 1 || std::max(view.width, view.height) > kGuard)
    return layer;
  const auto camera = splat_camera(view);
  if (!camera) return layer;
  const PatchLens lens(*camera, view);
  const PatchGrid grid(*camera);
  const bool colored =
      options.color_by != ColorBy::own ||
      std::any_of(surface.parts.begin(), surface.parts.end(), [](const auto& part) { return part->colored(); });
  const std::span<PatchTask> tasks = tasks_of(cut);
  qnv::parallel_for(
      tasks.size(),
      [&](std::size_t i) { PatchPreparation(surface, cut, lens, grid, options, colored, tasks[i]).run(); },
      view.threads);
  for (const PatchTask& task : tasks) {
    layer.discs += task.vertices.size();
    layer.drawn += task.triangles.size();
  }
  if (layer.drawn == 0) return layer;
  layer.width = view.width;
  layer.height = view.height;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layer.depth.resize(pixels);
  layer.normals.resize(4 * pixels);
  if (colored) layer.colors.resize(4 * pixels);
  qnv::parallel_for(
      grid.size(),
      [&](std::size_t t) {
        thread_local const auto tile = std::make_unique<PatchTile>();
        tile->inverse.fill(0);
        const int left = static_cast<int>(t) % grid.columns * kTile,
                  bottom = static_cast<int>(t) / grid.columns * kTile;
        PatchTileDrawing drawing(left, bottom, grid, lens.mirrors, colored, *tile);
        for (const PatchTask& task : tasks)
          for (std::uint32_t i = task.begin[t]; i < task.begin[t + 1]; ++i)
            drawing.draw(task, task.triangles[task.order[i]]);
        PatchTileResolve(*tile, camera->normal_matrix, left, bottom, view.supersample, layer).run();
      },
      view.threads);
  return layer;
}

}  // namespace gs::render
