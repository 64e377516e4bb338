#pragma once

#include "qnv/base/description.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::qnv {

constexpr std::size_t kMaxOutlineAppearances = 65535;
/// Maximum bits of a lattice coordinate: 0..2^30 - 1 per axis.
constexpr int kMaxLatticeBits = 30;
/// Maximum distance of a lattice's origin from 0, in steps.
constexpr std::int64_t kMaxLatticeOrigin = std::int64_t{1} << 52;

/// Appearance of the polygons of an outline stream: the fields of VRML97's Material and of IndexedFaceSet that affect
/// shading. Fractions are in 1/255.
struct OutlineAppearance {
  Rgb8 diffuse, emissive{0, 0, 0}, specular{0, 0, 0};
  std::uint8_t ambient_intensity = 51, shininess = 51, transparency = 0;
  bool lit = true;  // if false, `diffuse` is drawn unchanged
  bool solid = true;  // if false, the back is visible too
  bool textured = false;    // polygons may have texture coordinates
  float crease_angle = 0;   // radians, >= 0
  std::string texture_url;  // UTF-8, at most 65535 bytes; untrusted
  friend bool operator==(const OutlineAppearance&, const OutlineAppearance&) = default;
};

/// Integer coordinates for a whole stream. The coordinate q on an axis means (origin + q) * 2^exponent, computed
/// exactly and rounded to the nearest float32. Therefore equal q give bitwise equal numbers everywhere, and positions
/// on the lattice are lossless. Other positions change by at most half a step.
template <std::size_t Axes>
struct OutlineLattice {
  int exponent = 0;                         // -149..127
  std::array<std::int64_t, Axes> origin{};  // in steps; at most kMaxLatticeOrigin from 0
  std::array<std::uint32_t, Axes> size{};  // largest coordinate on each axis

  [[nodiscard]] double step() const { return std::ldexp(1.0, exponent); }
  [[nodiscard]] float at(std::size_t axis, std::uint32_t q) const {
    return static_cast<float>(static_cast<double>(origin[axis] + q) * step());
  }
  friend bool operator==(const OutlineLattice&, const OutlineLattice&) = default;
};

/// Header fields that only outline streams have.
struct OutlineHeader {
  OutlineLattice<3> positions;
  OutlineLattice<2> texture_coordinates;
  std::uint32_t groups = 0;  // exclusive upper bound of group indices
  std::uint32_t outline_polygons = 0, inner_polygons = 0;  // numbers in the source; only hints
  std::vector<OutlineAppearance> appearances;              // at most kMaxOutlineAppearances
  friend bool operator==(const OutlineHeader&, const OutlineHeader&) = default;
};

/// Encodes the header section (FORMAT.md, "Outlines payload").
[[nodiscard]] std::vector<std::byte> encode_outline_header(const OutlineHeader& header);
/// Decodes the header section. Returns nullopt if it is truncated or contains invalid numbers. Safe for untrusted
/// bytes.
[[nodiscard]] std::optional<OutlineHeader> decode_outline_header(std::span<const std::byte> section);

}  // namespace gs::qnv
