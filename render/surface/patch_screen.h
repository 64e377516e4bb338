#pragma once

#include "render/splat/software/splat_camera.h"
#include "render/splat/software/splat_raster.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

// Triangles of patches in screen space. Preparation makes them, and the drawing of tiles reads them.
namespace gs::render {

inline constexpr int kSubsampleBits = 8, kSubsamples = 1 << kSubsampleBits;  // steps of positions per sample
inline constexpr int kGuard = 8192;       // coordinates in samples beyond which a triangle is clipped
inline constexpr int kSmallTriangle = 4;  // maximum width and height, in samples, of triangles that are drawn at once

/// Vertex on the screen. Positions are integers in units of 1 / kSubsamples of a sample, relative to the centre of
/// sample (0, 0).
struct alignas(32) ScreenVertex {
  float x, y;
  float inverse;        // 1 / depth; 0 means that the triangle must be clipped
  std::uint32_t color;  // red, green << 8, blue << 16; valid only if vertices have colours
  glm::vec3 normal;     // normal in node space, times `inverse`
  float unused;
};
static_assert(sizeof(ScreenVertex) == 32);

/// Triangle that is drawn in each tile that it touches.
struct ScreenTriangle {
  std::array<ScreenVertex, 3> corners;
  std::uint32_t tiles;  // first tile: column | row << 8; then number of further columns << 16, of further rows << 24
};

/// Projection from node space to samples.
struct PatchLens {
  glm::vec4 x, y, depth;  // rows of the matrix; x and y are then divided by the depth
  float center_x, center_y, near_plane;
  bool mirrors;  // triangles of the node have the opposite winding on the screen
  glm::mat4 camera_from_node;
  glm::vec2 scale;  // subsamples per length 1 at depth 1

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
};

/// Grid of the tiles of an image.
struct PatchGrid {
  explicit PatchGrid(const SplatCamera& camera)
      : columns((camera.width + kTile - 1) / kTile),
        rows((camera.height + kTile - 1) / kTile),
        width(camera.width),
        height(camera.height) {}
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  int columns, rows, width, height;
};

/// Properties of all triangles of a surface.
struct PatchLook {
  bool two_sided = false, mirrors = false, colored = false;
};

/// Key of a covered sample; the larger key is nearer. The high bits are those of 1 / depth, which is positive. The low
/// bits are the normal in octahedral form, 16 bits x and 16 bits y.
using SampleKey = std::uint64_t;
using SampleKeys = std::vector<SampleKey, SplatAllocator<SampleKey>>;
/// Number of a sample: tile << kTileBits | row in the tile * kTile | column in the tile. For a single tile, only the
/// part after the tile is used.
using SampleNumbers = std::vector<std::uint32_t, SplatAllocator<std::uint32_t>>;
inline constexpr int kTileBits = 12;
static_assert(kTile * kTile == 1 << kTileBits && kGuard / kTile * (kGuard / kTile) << kTileBits > 0);

/// Bits per channel of a sample's colour, in quarters of 1 / 255.
inline constexpr int kSampleColorBits = 10;

/// Samples of one tile, stored row by row.
struct alignas(64) PatchTile {
  std::array<SampleKey, kTile * kTile> nearest;  // 0 means that the sample is empty
  std::array<std::uint32_t, kTile * kTile> color;
};

/// Successive samples of a task in one tile.
struct SampleRun {
  std::uint32_t tile, first, last;
};

/// Input and output of one preparation task.
struct PatchTask {
  std::size_t first = 0, last = 0;      // range of patches of the cut
  std::size_t vertices = 0, drawn = 0;  // numbers of vertices and of triangles
  SampleKeys keys;
  SampleNumbers samples, colors;
  std::vector<SampleRun> runs;
  std::vector<ScreenTriangle> triangles;
  // Indexes of runs and of triangles, sorted by tile, and the start of each tile in them.
  std::vector<std::uint32_t> run_begin, run_order, begin, order;
};

/// Returns twice the area of a triangle; positive if its corners are counter-clockwise.
inline std::int64_t area_of(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
  const auto whole = [](float v) { return static_cast<std::int64_t>(v); };
  return whole(b.x - a.x) * whole(c.y - a.y) - whole(b.y - a.y) * whole(c.x - a.x);
}

/// First and last sample that three screen positions may enclose, in both directions.
struct SampleBox {
  SampleBox(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c)
      : x0((whole(std::min({a.x, b.x, c.x})) + kSubsamples - 1) >> kSubsampleBits),
        x1(whole(std::max({a.x, b.x, c.x})) >> kSubsampleBits),
        y0((whole(std::min({a.y, b.y, c.y})) + kSubsamples - 1) >> kSubsampleBits),
        y1(whole(std::max({a.y, b.y, c.y})) >> kSubsampleBits) {}
  void limit(int left, int right, int bottom, int top) {
    x0 = std::max(x0, left);
    x1 = std::min(x1, right);
    y0 = std::max(y0, bottom);
    y1 = std::min(y1, top);
  }
  [[nodiscard]] bool empty() const { return x0 > x1 || y0 > y1; }
  static int whole(float v) { return static_cast<int>(v); }
  int x0, x1, y0, y1;
};

}  // namespace gs::render
