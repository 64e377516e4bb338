#pragma once

#include "qnv/surface/patch_mesh.h"
#include "render/splat/splat_camera.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

// Triangles of patches on the screen, between those who prepare them and those who draw tiles.
namespace gs::render {

inline constexpr int kSubsampleBits = 8, kSubsamples = 1 << kSubsampleBits;  // places of a vertex between two samples
inline constexpr int kGuard = 8192;                                          // samples beyond which a triangle is cut

/// A vertex on the screen: places count in 1 / kSubsamples of samples from the middle of sample (0, 0).
struct ScreenVertex {
  std::int32_t x, y;
  float inverse;  // of its depth; 0: the triangle must be cut
  std::uint32_t normal;
};
static_assert(sizeof(ScreenVertex) == 16 && sizeof(qnv::PatchVertex) == 16);

/// Corners are vertices of the task.
struct ScreenTriangle {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t tiles;  // the first that it meets: column | row << 8; how many more: << 16, << 24
};

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
  void project(const qnv::PatchVertex* from, std::size_t count, ScreenVertex* to) const;
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

/// Twice the area, positive where the corners go counter-clockwise.
inline std::int64_t area_of(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
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

inline glm::vec3 unpacked_color(std::uint32_t c) {
  return {static_cast<float>(c & 255u), static_cast<float>(c >> 8 & 255u), static_cast<float>(c >> 16 & 255u)};
}

}  // namespace gs::render
