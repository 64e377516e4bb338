#pragma once

#include "qnv/base/cloud.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::qnv {

constexpr std::size_t kMostOutlineAppearances = 65535;
/// A lattice has coordinates 0..2^30 - 1 an axis at most.
constexpr int kMostLatticeBits = 30;
/// How far from 0 its origin may be, in steps.
constexpr std::int64_t kMostLatticeOrigin = std::int64_t{1} << 52;

/// How polygons of an outline stream look: VRML97's Material and the fields of IndexedFaceSet that a face's look
/// depends on. Fractions are in 1/255.
struct OutlineAppearance {
  Rgb8 diffuse, emissive{0, 0, 0}, specular{0, 0, 0};
  std::uint8_t ambient_intensity = 51, shininess = 51, transparency = 0;
  bool lit = true;          // false: diffuse is the colour that is seen
  bool solid = true;        // false: seen from behind too
  bool textured = false;    // polygons may have texture coordinates
  float crease_angle = 0;   // radians, >= 0
  std::string texture_url;  // UTF-8, at most 65535 bytes; untrusted
  friend bool operator==(const OutlineAppearance&, const OutlineAppearance&) = default;
};

/// Coordinates of a whole stream as integers: q of an axis stands for (origin + q) * 2^exponent, which is exact; the
/// nearest f32 is taken. So equal q are bitwise the same number wherever they come, and what lay on the lattice comes
/// back as it was. What did not is off by half a step at most.
template <std::size_t Axes>
struct OutlineLattice {
  int exponent = 0;                         // -149..127
  std::array<std::int64_t, Axes> origin{};  // at most kMostLatticeOrigin from 0
  std::array<std::uint32_t, Axes> size{};   // the largest coordinate

  [[nodiscard]] double step() const { return std::ldexp(1.0, exponent); }
  [[nodiscard]] float at(std::size_t axis, std::uint32_t q) const {
    return static_cast<float>(static_cast<double>(origin[axis] + q) * step());
  }
  friend bool operator==(const OutlineLattice&, const OutlineLattice&) = default;
};

/// What the header of an outline stream says besides what all headers say.
struct OutlineHeader {
  OutlineLattice<3> positions;
  OutlineLattice<2> texture_coordinates;
  std::uint32_t groups = 0;                                // their numbers are below
  std::uint32_t outline_polygons = 0, inner_polygons = 0;  // of the source: hints
  std::vector<OutlineAppearance> appearances;              // at most kMostOutlineAppearances
  friend bool operator==(const OutlineHeader&, const OutlineHeader&) = default;
};

/// The bytes of the header's section (FORMAT.md, "Outlines payload").
[[nodiscard]] std::vector<std::byte> encode_outline_header(const OutlineHeader& header);
/// Nothing where it is cut, or holds impossible numbers. Safe for untrusted bytes.
[[nodiscard]] std::optional<OutlineHeader> decode_outline_header(std::span<const std::byte> section);

}  // namespace gs::qnv
