#pragma once

#include "qnv/base/cloud.h"
#include "render/splat/splat_camera.h"
#include "render/splat/splat_raster.h"
#include "render/splat/splat_tile.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gs::render {

/// Discs of a cloud, as the surface splatter takes them.
struct SplatSource {
  const glm::vec3 *positions = nullptr, *normals = nullptr;
  const float* weights = nullptr;
  const qnv::Rgb8* colors = nullptr;  // null: all have `color`
  const qnv::Cell* cells = nullptr;   // null: none has a cube
  std::size_t count = 0;
  float growth = 1;  // by which their areas are multiplied
  std::uint32_t color = 0;
  bool two_sided = false, color_by_normal = false;
};

/// A colour as SplatDisc has it.
[[nodiscard]] inline std::uint32_t splat_color(const qnv::Rgb8& c) {
  return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 | static_cast<std::uint32_t>(c.b) << 16;
}

/// Where a tile is drawn to: a whole viewport, rows from the bottom.
struct SplatTarget {
  int width = 0, height = 0, supersample = 1;
  float* depth = nullptr;
  std::uint16_t* normals = nullptr;  // 4 a pixel
  std::uint8_t* colors = nullptr;    // 4 a pixel; null: not wanted
};

/// The inner loops of the surface splatter with one set of vector instructions. All give the same bits.
struct SplatKernel {
  std::string_view name;
  /// Writes the discs that are in view, in their order, and returns how many they are. `out` has room for one more
  /// than there are.
  std::size_t (*prepare)(const SplatSource& source, const SplatCamera& camera, SplatDisc* out);
  /// Draws the discs `chosen`, in that order, into the pixels of the tile whose lower left sample is (left, bottom),
  /// and empties those that no disc covers. `tile` holds nothing before or after that matters.
  void (*draw)(const SplatDisc* discs, std::span<const std::uint32_t> chosen, const SplatCamera& camera, int left,
               int bottom, const SplatKind& kind, SplatTile& tile, const SplatTarget& target);
};

/// Those that run here, the fastest first; the last runs everywhere.
[[nodiscard]] std::span<const SplatKernel> splat_kernels();

/// rasterize_surface with a certain one, and another limit than kMostSplatSamples.
[[nodiscard]] SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view,
                                           const SplatKernel& kernel, std::uint64_t most_samples = kMostSplatSamples);

}  // namespace gs::render
