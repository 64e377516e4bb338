#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// The numbers of Niantic's SPZ format that reading and writing share.
namespace gs::app::spz {

inline constexpr std::uint32_t kSpzMagic = 0x5053474e;  // "NGSP"
inline constexpr std::size_t kSpzHeaderBytes = 16;      // versions 1 to 3, at the start of the unpacked stream
inline constexpr std::size_t kSpzHeaderBytes4 = 32;     // version 4, in the open
inline constexpr std::uint8_t kHasExtensions = 2;       // in the flags
inline constexpr std::uint32_t kCoordinateSystem = 0xadbe0003;

/// So many splats are written at most; other readers take no more.
inline constexpr std::size_t kMaxSplats = std::size_t{1} << 26;

/// The planes that are read, in their order. (Behind them: harmonics.)
enum Plane : std::size_t { positions, alphas, colors, scales, rotations, plane_count };
/// Bytes a splat in each plane.
[[nodiscard]] constexpr std::array<std::size_t, plane_count> plane_widths(std::uint32_t version) {
  return {version == 1 ? std::size_t{6} : std::size_t{9}, 1, 3, 3, version < 3 ? std::size_t{3} : std::size_t{4}};
}

inline constexpr float kColorScale = 0.15f;     // of dc
inline constexpr float kLogScaleSteps = 16;     // a unit of ln(scale)
inline constexpr float kMinLogScale = -10;      // value of byte 0
inline constexpr float kQuaternionSteps = 511;  // of nine bits and a sign, for 0..1/sqrt(2)

}  // namespace gs::app::spz
