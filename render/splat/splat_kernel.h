#pragma once

#include "qnv/base/geometry.h"
#include "render/splat/splat_camera.h"
#include "render/splat/splat_raster.h"
#include "render/splat/splat_tile.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gs::render {

/// Splats of a point set as the surface splatter reads them.
struct SplatSource {
  const glm::vec3 *positions = nullptr, *normals = nullptr;
  const float* weights = nullptr;
  const qnv::Rgb8* colors = nullptr;  // null means that all have `color`
  const qnv::Cell* cells = nullptr;   // null means no cubes
  std::size_t count = 0;
  float growth = 1;  // factor of their areas
  std::uint32_t color = 0;
  bool two_sided = false, color_by_normal = false;
};

/// Packs a colour as in SplatDisc.
[[nodiscard]] inline std::uint32_t splat_color(const qnv::Rgb8& c) {
  return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 | static_cast<std::uint32_t>(c.b) << 16;
}

/// Target of a tile: a whole viewport, rows from the bottom.
struct SplatTarget {
  int width = 0, height = 0, supersample = 1;
  float* depth = nullptr;
  std::uint16_t* normals = nullptr;  // 4 per pixel
  std::uint8_t* colors = nullptr;    // 4 per pixel; null if not needed
};

/// Inner loops of the surface splatter for one instruction set. All give the same bits.
struct SplatKernel {
  std::string_view name;
  /// Writes the splats in view in order and returns their number. `out` needs room for one extra.
  std::size_t (*prepare)(const SplatSource& source, const SplatCamera& camera, SplatDisc* out);
  /// Draws the splats `chosen` in order into the pixels of the tile with lower left sample (left, bottom), and clears
  /// uncovered pixels. `tile` is scratch memory.
  void (*draw)(const SplatDisc* discs, std::span<const std::uint32_t> chosen, const SplatCamera& camera, int left,
               int bottom, const SplatKind& kind, SplatTile& tile, const SplatTarget& target);
};

/// Returns the kernels that run on this CPU, fastest first; the last one runs everywhere.
[[nodiscard]] std::span<const SplatKernel> splat_kernels();

/// Rasterizes with a given kernel and sample limit.
[[nodiscard]] SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view,
                                           const SplatKernel& kernel, std::uint64_t most_samples = kMaxSplatSamples);

}  // namespace gs::render
