#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// Constants of Niantic's SPZ format, for the importer and the exporter.
namespace gs::app::spz {

inline constexpr std::uint32_t kSpzMagic = 0x5053474e;  // "NGSP"
inline constexpr std::size_t kSpzHeaderBytes = 16;      // versions 1 to 3: header at the start of the decompressed data
inline constexpr std::size_t kSpzHeaderBytes4 = 32;     // version 4: uncompressed header
inline constexpr std::uint8_t kAntialiased = 1, kHasExtensions = 2;  // bits of the flags
inline constexpr std::uint32_t kCoordinateSystem = 0xadbe0003;

/// Maximum number of splats in an exported file; other readers accept no more.
inline constexpr std::size_t kMaxSplats = std::size_t{1} << 26;

/// Planes that are read, in the order of the file. The spherical harmonics follow.
enum Plane : std::size_t { positions, alphas, colors, scales, rotations, plane_count };
/// Returns the bytes per splat in each plane.
[[nodiscard]] constexpr std::array<std::size_t, plane_count> plane_widths(std::uint32_t version) {
  return {version == 1 ? std::size_t{6} : std::size_t{9}, 1, 3, 3, version < 3 ? std::size_t{3} : std::size_t{4}};
}

inline constexpr float kColorScale = 0.15f;     // of the colour coefficients dc
inline constexpr float kLogScaleSteps = 16;     // steps of ln(scale) per unit
inline constexpr float kMinLogScale = -10;      // ln(scale) of byte 0
inline constexpr float kQuaternionSteps = 511;  // steps from 0 to 1/sqrt(2); nine bits and a sign

}  // namespace gs::app::spz
