#pragma once

#include "qnv/base/geometry.h"
#include "render/splat/software/splat_camera.h"
#include "render/splat/software/splat_raster.h"
#include "render/splat/software/splat_tile.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gs::render {

/// Splats of a geometry in the form that the kernels read.
struct SplatSource {
  const glm::vec3 *positions = nullptr, *normals = nullptr;
  const float* weights = nullptr;
  const qnv::Rgb8* colors = nullptr;  // null means that all splats have `color`
  const qnv::Cell* cells = nullptr;   // null means that no splat has a cube
  std::size_t count = 0;
  float growth = 1;  // factor of the splats' areas
  std::uint32_t color = 0;
  bool two_sided = false, color_by_normal = false;
};

/// Packs a colour as in SplatDisc.
[[nodiscard]] inline std::uint32_t splat_color(const qnv::Rgb8& c) {
  return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 | static_cast<std::uint32_t>(c.b) << 16;
}

/// Arrays of the image to which tiles are drawn. Covers a whole viewport, rows from the bottom.
struct SplatTarget {
  int width = 0, height = 0, supersample = 1;
  float* depth = nullptr;
  std::uint16_t* normals = nullptr;  // 4 numbers per pixel, as in SplatLayer
  std::uint8_t* colors = nullptr;    // 4 bytes per pixel; may be null
};

/// Inner loops of the surface splatter for one instruction set. All kernels give identical bits.
struct SplatKernel {
  std::string_view name;
  /// Writes the splats that are in view to `out`, in order. Returns their number. `out` needs space for one more splat.
  std::size_t (*prepare)(const SplatSource& source, const SplatCamera& camera, SplatDisc* out);
  /// Draws the splats with the indexes `chosen`, in order, into the pixels of a tile. Clears uncovered pixels. (left,
  /// bottom) is the lower left sample of the tile. `tile` is scratch memory.
  void (*draw)(const SplatDisc* discs, std::span<const std::uint32_t> chosen, const SplatCamera& camera, int left,
               int bottom, const SplatKind& kind, SplatTile& tile, const SplatTarget& target);
};

/// Returns the kernels that this CPU supports, fastest first. The last kernel runs on any CPU.
[[nodiscard]] std::span<const SplatKernel> splat_kernels();

/// Rasterizes a surface with the given kernel and maximum number of samples.
[[nodiscard]] SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view,
                                           const SplatKernel& kernel, std::uint64_t most_samples = kMaxSplatSamples);

}  // namespace gs::render
