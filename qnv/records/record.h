#pragma once

#include "qnv/base/cloud.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// The 8-byte record of a quantised normal vector (Nagasawa, "Beyond VRML", figure 6): X10 Y10 Z10 theta5 phi6
/// A15 C8. FORMAT-records.md has the bytes. Everything here is pure and may be called from any thread.
namespace gs::qnv {

inline constexpr std::size_t kRecordBytes = 8;
inline constexpr unsigned kRecordPositions = 1024;  // codes an axis
inline constexpr unsigned kRecordThetas = 32;       // polar angle, from +Z
inline constexpr unsigned kRecordPhis = 64;         // azimuth, from +X towards +Y
inline constexpr unsigned kRecordLargestWeight = 32767;
inline constexpr unsigned kNormalCodes = kRecordThetas * kRecordPhis;

/// No direction is further from that of its code than this: 2 asin(sqrt(2) sin(pi / 128)) = 3.978 degrees. (The
/// haversine of the distance is hav(dtheta) + sin(theta1) sin(theta2) hav(dphi), with both differences at most
/// half a step, pi / 64.)
inline constexpr double kLargestNormalError = 0.0694271;  // radians, rounded up

/// The seven numbers of a record, as integers. A weight of 0 is reserved: it is never written, and reads as 1.
struct RecordFields {
  std::uint16_t x = 0, y = 0, z = 0;  // 0..1023
  std::uint8_t theta = 0, phi = 0;    // 0..31, 0..63
  std::uint16_t weight = 1;           // 1..32767
  std::uint8_t color = 0;             // index of the palette; volume: the class
  friend bool operator==(const RecordFields&, const RecordFields&) = default;
};

/// A record is one little-endian integer of 64 bits: X in bits 0-9, Y 10-19, Z 20-29, theta 30-34, phi 35-40,
/// A 41-55, C 56-63.
[[nodiscard]] constexpr std::uint64_t join_fields(const RecordFields& f) {
  return std::uint64_t{f.x & 1023u} | std::uint64_t{f.y & 1023u} << 10 | std::uint64_t{f.z & 1023u} << 20 |
         std::uint64_t{f.theta & 31u} << 30 | std::uint64_t{f.phi & 63u} << 35 |
         std::uint64_t{f.weight & 32767u} << 41 | std::uint64_t{f.color} << 56;
}
[[nodiscard]] constexpr RecordFields split_fields(std::uint64_t bits) {
  return {static_cast<std::uint16_t>(bits & 1023),       static_cast<std::uint16_t>(bits >> 10 & 1023),
          static_cast<std::uint16_t>(bits >> 20 & 1023), static_cast<std::uint8_t>(bits >> 30 & 31),
          static_cast<std::uint8_t>(bits >> 35 & 63),    static_cast<std::uint16_t>(bits >> 41 & 32767),
          static_cast<std::uint8_t>(bits >> 56)};
}

/// What the numbers of a record mean: those of one chunk.
///
/// A coordinate decodes to lower + (2x + 1) * (cell / 2), that is lower + (x + 0.5) / 1024 * extent, a weight to
/// max(A, 1) * weight_step. `cell` has 13 significant bits, so that (2x + 1) * (cell / 2) is exact, and every
/// decoder gets the same position to the last bit whether or not it fuses the addition with the multiplication.
struct RecordFrame {
  glm::vec3 lower{0};     // units of the source
  glm::vec3 cell{0};      // 1/1024 of the box, units of the source; 0: flat
  float weight_step = 1;  // largest weight / 32767
  friend bool operator==(const RecordFrame&, const RecordFrame&) = default;

  /// The box that the positions can lie in.
  [[nodiscard]] Box box() const;
};

/// The frame for vectors in `box` (not empty, finite) of weights up to `largest_weight` (> 0, finite). Its own box is
/// `box`, up to 1/2048 longer. A position in `box` then decodes to within cell / 2 an axis, a weight to within
/// weight_step / 2 unless it is below weight_step / 2: such a one becomes weight_step. (To both comes the last bit
/// of the float that holds the result.)
[[nodiscard]] RecordFrame frame_for(const Box& box, float largest_weight);

/// True for a frame whose every number is finite, cells not negative and of at most 13 significant bits, steps > 0, and
/// of which no record decodes to an infinity. Frames from outside must be checked.
[[nodiscard]] bool valid(const RecordFrame& frame);

/// A record, decoded.
struct RecordVector {
  glm::vec3 position{0};  // units of the source
  glm::vec3 normal{0};    // unit
  float weight = 0;
  std::uint8_t color = 0;
  friend bool operator==(const RecordVector&, const RecordVector&) = default;
};

/// theta + 32 phi of the code nearest to `direction`, of any length. Not finite or zero: that of +Z.
[[nodiscard]] unsigned normal_code(const glm::vec3& direction);

/// The unit vector of a code: (sin t cos f, sin t sin f, cos t) with t = (theta + 0.5) / 32 pi,
/// f = (phi + 0.5) / 64 2 pi, correctly rounded but for the last bit of double arithmetic.
[[nodiscard]] glm::vec3 normal_of(unsigned code);

/// The nearest record. Positions outside of the frame's box, weights above its largest or not finite are moved
/// to the nearest that it can hold.
[[nodiscard]] std::uint64_t pack_record(const RecordVector& vector, const RecordFrame& frame);
[[nodiscard]] RecordVector unpack_record(std::uint64_t bits, const RecordFrame& frame);

/// Packs positions.size() vectors to as many records at `out`. The spans have the same length; `colors` may be
/// empty: all 0.
void pack_records(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                  std::span<const float> weights, std::span<const std::uint8_t> colors, const RecordFrame& frame,
                  std::byte* out);

/// Unpacks records.size() / 8 records, each to one entry of every array; bytes behind the last whole record are
/// left alone. The arrays must not overlap. `frame` must be valid(). Every processor gives the same bits.
void unpack_records(std::span<const std::byte> records, const RecordFrame& frame, glm::vec3* positions,
                    glm::vec3* normals, float* weights, std::uint8_t* colors);

}  // namespace gs::qnv
