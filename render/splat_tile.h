#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::render {

constexpr int kTile = 32;  // samples along an edge: what is written of a tile stays in the first cache

/// Samples, inclusive; none where x1 < x0.
struct SplatBounds {
  std::int16_t x0, y0, x1, y1;
};

/// A disc in view, ready to be rasterised. Node space, from the camera's place.
struct SplatDisc {
  glm::vec3 place;  // the disc's centre
  glm::vec3 normal;
  glm::vec3 clip;                    // centre of the cube, or of the disc
  float plane;                       // normal . place
  float facing, facing_x, facing_y;  // normal . ray of sample (0, 0); what a sample to the right or up adds
  float reach;                       // half the edge of the cube, or the square of the covering radius
  float inverse_radius2;             // of the bell
  std::uint32_t color;
  SplatBounds bell, cover;  // the samples that it may count in, and those that it may cover
};

/// What all discs of a cloud share.
struct SplatRays {
  glm::vec3 origin, right, up;  // node space: ray of sample (0, 0), and what one sample adds; of depth 1
  float near_plane;
};

/// The samples of one tile.
struct alignas(64) SplatTile {
  std::array<float, kTile * kTile> depth;
  std::array<float, kTile * kTile> weight, normal_x, normal_y, normal_z, red, green, blue;
  // Of the bells: sums of their slopes, of the slopes and of the bells themselves times the height over the disc's
  // plane.
  std::array<float, kTile * kTile> slope_x, slope_y, slope_z, tilt_x, tilt_y, tilt_z, height;
  std::array<float, kTile * kTile> side;  // negative: the nearest surface faces the viewer; positive: its back does
};

/// What is the same for all discs of a cloud.
struct SplatKind {
  bool cubes = false, colored = false;
  bool sides = false;   // seen from behind too
  bool smooth = false;  // fill slope, tilt and height
};

/// Rasterises the discs `chosen`, in that order, into the tile whose lower left sample is (left, bottom).
struct SplatKernel {
  void (*tile)(const SplatDisc* discs, std::span<const std::uint32_t> chosen, const SplatRays& rays, int left,
               int bottom, const SplatKind& kind, SplatTile& tile);
};

[[nodiscard]] const SplatKernel& splat_kernel();
[[nodiscard]] const SplatKernel& splat_kernel_baseline();

}  // namespace gs::render
