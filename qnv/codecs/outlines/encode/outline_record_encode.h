#pragma once

#include "qnv/codecs/outlines/outline_chunk.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Encodes polygons on the lattice as records. Internal to the encoder of outline streams.
namespace gs::qnv::outline {

/// View of a polygon on the lattice. Each ring has at least three corners, without repetitions.
struct Polygon {
  std::span<const Corner> corners;           // ring after ring
  std::span<const std::uint32_t> ring_ends;  // end of each ring in `corners`, plus `first`
  std::uint32_t first = 0;
  std::uint32_t group = 0;
  std::uint32_t count = 0;  // for outlines: number of inner polygons that replace it
  bool textured = false;

  [[nodiscard]] std::size_t ring_begin(std::size_t ring) const { return ring == 0 ? 0 : ring_ends[ring - 1] - first; }
  [[nodiscard]] std::size_t ring_end(std::size_t ring) const { return ring_ends[ring] - first; }
  [[nodiscard]] std::size_t axes() const { return textured ? kAxes : kPlaneAxes; }
  /// Returns the normal in lattice steps; its length is twice the area.
  [[nodiscard]] std::array<double, 3> normal() const;
};

/// Returns the plane perpendicular to `normal`. Its slopes have the given precision (0..3).
[[nodiscard]] Plane plane_across(const std::array<double, 3>& normal, int precision);

using Numbers = std::array<std::uint64_t, kAxes>;

/// Differences between successive corners of a polygon, in the form in which they are written.
class Differences {
 public:
  Differences(const Polygon& polygon, const Plane& plane);

  /// Returns the number of bits after the first corner, with the given code.
  [[nodiscard]] std::uint64_t cost(const Code& code) const;
  [[nodiscard]] const std::vector<Numbers>& numbers() const { return numbers_; }
  [[nodiscard]] std::size_t axes() const { return axes_; }
  /// Writes the numbers of corners and the differences of all rings.
  void write(const Polygon& polygon, const Code& code, BitWriter& to) const;

 private:
  void add_ring(std::span<const Place> places);

  std::size_t axes_;
  std::vector<Numbers> numbers_, corrections_;
  std::vector<std::uint8_t> parallelograms_;  // one entry per ring
  std::uint64_t fixed_cost_ = 0;  // number of bits that do not depend on the code
};

/// Returns the code that needs the fewest bits for all numbers.
[[nodiscard]] Code best_code(std::span<const Numbers> numbers, std::size_t axes);

/// Chunk of outlines or inner polygons of one appearance.
struct Chunk {
  ChunkHead head;
  std::vector<std::byte> records;
  [[nodiscard]] std::vector<std::byte> payload(const LatticeBits& bits) const;
};

/// Properties that all chunks of an appearance share.
struct ChunkKind {
  std::uint16_t appearance = 0;
  bool inner = false, textured = false;
};

/// Encodes polygons as one chunk. Leaves `records` empty if a record exceeds 65,535 bytes.
[[nodiscard]] Chunk encode_chunk_of(std::span<const Polygon> polygons, const ChunkKind& kind);

}  // namespace gs::qnv::outline
