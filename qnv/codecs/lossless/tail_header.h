#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>

// Header, rank cells and colours of an exact tail (FORMAT.md, "Exact tail").
namespace gs::qnv::exact {

/// Number of vertices that predict a new vertex, and number of situations with separate weights.
inline constexpr std::size_t kNear = 8, kSituations = 6;
inline constexpr int kWeightBits = 12;
using Weights = std::array<std::array<std::int16_t, kNear>, kSituations>;

/// Header of a tail, which precedes the coded decisions.
struct TailHeader {
  int bits = 11, finest = 11;  // `finest` includes the low bits that follow the tail
  bool colored = false;
  bool usual = false;  // uses the default weights, which the header omits
  int crease_angle = 180;  // see ExactMesh::crease_angle
  std::uint32_t vertices = 0, triangles = 0;
  Weights weights{};  // in units of 1 / 2^kWeightBits
  TextureLattice texture;  // lattice of the corners' texture coordinates
  int cell_bits = 0;  // bits per axis of the cells that have ranks; 0 means no ranks
};

/// Maximum bits per axis of a cell. A cell's index is the highest bits of the positions inside. The mesh grows through
/// cells of low rank first.
inline constexpr int kMaxCellBits = 5;
[[nodiscard]] constexpr std::size_t cell_of(const glm::ivec3& place, int bits, int cell_bits) {
  const int shift = bits - cell_bits;
  const auto part = [&](int c) { return static_cast<std::size_t>(c >> shift); };
  return (part(place.z) << 2 * cell_bits) + (part(place.y) << cell_bits) + part(place.x);
}

/// Converts a colour to luma and two chromas, without loss (H. Malvar, G. Sullivan, YCoCg-R, 2003).
[[nodiscard]] constexpr glm::ivec3 luma_of(Rgb8 c) {
  const int co = c.r - c.b, t = c.b + (co >> 1), cg = c.g - t;
  return {t + (cg >> 1), co, cg};
}
/// Converts luma and chromas back to a colour. Returns false if a component exceeds 8 bits.
[[nodiscard]] constexpr bool color_of(const glm::ivec3& c, Rgb8& to) {
  const int t = c.x - (c.z >> 1), g = c.z + t, b = t - (c.y >> 1), r = b + c.y;
  to = {static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g), static_cast<std::uint8_t>(b)};
  return r >= 0 && g >= 0 && b >= 0 && r < 256 && g < 256 && b < 256;
}

/// Number coded after the last decision. A decoder reads another number if it went wrong before.
inline constexpr std::uint32_t kEndMark = 0x5143;

}  // namespace gs::qnv::exact
