#pragma once

#include "qnv/outline/outline_chunk.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// From polygons on the lattice to the bytes of records. Only for the encoder of outline streams.
namespace gs::qnv::outline {

/// A polygon on the lattice, as a view: rings of at least three corners, none like the one before it.
struct Polygon {
  std::span<const Corner> corners;           // ring after ring
  std::span<const std::uint32_t> ring_ends;  // in `corners`, plus `first`
  std::uint32_t first = 0;
  std::uint32_t group = 0;
  std::uint32_t count = 0;  // outlines: inner polygons that stand for the group in the end
  bool textured = false;

  [[nodiscard]] std::size_t ring_begin(std::size_t ring) const { return ring == 0 ? 0 : ring_ends[ring - 1] - first; }
  [[nodiscard]] std::size_t ring_end(std::size_t ring) const { return ring_ends[ring] - first; }
  [[nodiscard]] std::size_t axes() const { return textured ? kAxes : kPlaneAxes; }
  /// The normal times twice the area, in steps of the lattice.
  [[nodiscard]] std::array<double, 3> normal() const;
};

/// The plane through a normal with slopes of this precision (0..3).
[[nodiscard]] Plane plane_across(const std::array<double, 3>& normal, int precision);

using Numbers = std::array<std::uint64_t, kAxes>;

/// The differences of a polygon's corners, as they are written.
class Differences {
 public:
  Differences(const Polygon& polygon, const Plane& plane);

  /// Bits of everything behind the first corner.
  [[nodiscard]] std::uint64_t cost(const Code& code) const;
  [[nodiscard]] const std::vector<Numbers>& numbers() const { return numbers_; }
  [[nodiscard]] std::size_t axes() const { return axes_; }
  /// Rings: how many corners, their differences.
  void write(const Polygon& polygon, const Code& code, BitWriter& to) const;

 private:
  void add_ring(std::span<const Place> places);

  std::size_t axes_;
  std::vector<Numbers> numbers_, corrections_;
  std::vector<std::uint8_t> parallelograms_;  // a ring
  std::uint64_t fixed_cost_ = 0;              // what does not depend on the code
};

/// The code that takes the fewest bits for all of these.
[[nodiscard]] Code best_code(std::span<const Numbers> numbers, std::size_t axes);

/// Polygons of one appearance as the records of a chunk.
struct Chunk {
  ChunkHead head;
  std::vector<std::byte> records;
  [[nodiscard]] std::vector<std::byte> payload(const LatticeBits& bits) const;
};

/// What all chunks of an appearance have in common.
struct ChunkKind {
  std::uint16_t appearance = 0;
  bool inner = false, textured = false;
};

/// A record that takes more than 65,535 bytes makes `records` empty.
[[nodiscard]] Chunk encode_chunk_of(std::span<const Polygon> polygons, const ChunkKind& kind);

}  // namespace gs::qnv::outline
