#pragma once

#include "qnv/base/description.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// Record of a vector in 8 bytes (Nagasawa, "Beyond VRML", figure 6), with the bit fields X10 Y10 Z10 theta5 phi6 A15
/// C8. FORMAT.md, "Records payload", defines the bytes. All functions are pure and safe from any thread.
namespace gs::qnv {

inline constexpr std::size_t kRecordBytes = 8;
inline constexpr unsigned kRecordPositions = 1024;  // position codes per axis
inline constexpr unsigned kRecordThetas = 32;  // codes of the polar angle, from +Z
inline constexpr unsigned kRecordPhis = 64;  // codes of the azimuth, from +X towards +Y
inline constexpr unsigned kRecordLargestWeight = 32767;
inline constexpr unsigned kNormalCodes = kRecordThetas * kRecordPhis;

/// Maximum angle between a direction and the direction of its code: 2 asin(sqrt(2) sin(pi / 128)) = 3.978 degrees. The
/// haversine of the angle is hav(dtheta) + sin(theta1) sin(theta2) hav(dphi); both differences are at most half a step,
/// pi / 64.
inline constexpr double kLargestNormalError = 0.0694271;  // radians, rounded up

/// Frame of a chunk's records: parameters for decoding their fields.
/// A coordinate code x decodes to lower + (2x + 1) * (cell / 2), which is lower + (x + 0.5) / 1024 * extent. A weight
/// code A decodes to max(A, 1) * weight_step. `cell` has 13 significant bits, so that (2x + 1) * (cell / 2) is exact.
/// Therefore all decoders compute the same position bits, with or without fused multiply-add.
struct RecordFrame {
  glm::vec3 lower{0};     // units of the source
  glm::vec3 cell{0};      // 1/1024 of the box, units of the source; 0 if the box is flat
  float weight_step = 1;  // largest weight / 32767
  friend bool operator==(const RecordFrame&, const RecordFrame&) = default;

  /// Returns the box of all positions that records can have.
  [[nodiscard]] Box box() const;
};

/// Returns the frame for vectors in `box` (not empty, finite) with weights up to `largest_weight` (> 0, finite). The
/// box of the frame has the same lower corner as `box` and is at most 1/2048 longer. Decoded positions differ by at
/// most cell / 2 per axis, weights by at most weight_step / 2. Weights below weight_step / 2 become weight_step. Float
/// rounding of the result adds to both errors.
[[nodiscard]] RecordFrame frame_for(const Box& box, float largest_weight);

/// Reports whether a frame is usable. All numbers must be finite, cells non-negative with at most 13 significant bits,
/// and the step > 0; no record may decode to infinity. Call it for frames from untrusted input.
[[nodiscard]] bool valid(const RecordFrame& frame);

/// Decoded record.
struct RecordVector {
  glm::vec3 position{0};  // units of the source
  glm::vec3 normal{0};    // unit
  float weight = 0;
  std::uint8_t color = 0;
  friend bool operator==(const RecordVector&, const RecordVector&) = default;
};

/// Returns the code theta + 32 phi of the direction nearest to `direction`, which may have any length. Returns the code
/// of +Z if `direction` is zero or not finite.
[[nodiscard]] unsigned normal_code(const glm::vec3& direction);

/// Returns the unit vector of a code: (sin t cos f, sin t sin f, cos t). Here t = (theta + 0.5) / 32 * pi and f = (phi
/// + 0.5) / 64 * 2 pi. Correctly rounded, except for the last bit of double arithmetic.
[[nodiscard]] glm::vec3 normal_of(unsigned code);

/// Unpacks one record. Treats the reserved weight 0 as 1.
[[nodiscard]] RecordVector unpack_record(std::uint64_t bits, const RecordFrame& frame);

/// Packs positions.size() vectors into the same number of records at `out`: the nearest ones. A record is a 64-bit
/// integer in little-endian order. X has bits 0-9, Y 10-19, Z 20-29, theta 30-34, phi 35-40, A 41-55, C 56-63. Clamps
/// positions to the frame's box, and weights to the frame's maximum. Also clamps weights that are not finite. All spans
/// have equal lengths, except that `colors` may be empty; all colours are then 0.
void pack_records(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                  std::span<const float> weights, std::span<const std::uint8_t> colors, const RecordFrame& frame,
                  std::byte* out);

/// Unpacks records.size() / 8 records. Each array gets one entry per record. Ignores bytes after the last whole record.
/// The arrays must not overlap, and `frame` must be valid(). All processors give the same bits.
void unpack_records(std::span<const std::byte> records, const RecordFrame& frame, glm::vec3* positions,
                    glm::vec3* normals, float* weights, std::uint8_t* colors);

}  // namespace gs::qnv
