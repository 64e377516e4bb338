#pragma once

#include "qnv/codecs/outlines/outline_chunk.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Encodes polygons on the lattice as records. Internal to the encoder of outline streams.
namespace gs::qnv::outline {

/// View of a polygon on the lattice: rings of at least three corners, without repeated corners.
struct Polygon {
  std::span<const Corner> corners;           // ring after ring
  std::span<const std::uint32_t> ring_ends;  // in `corners`, plus `first`
  std::uint32_t first = 0;
  std::uint32_t group = 0;
  std::uint32_t count = 0;  // outlines: number of inner polygons that replace it
  bool textured = false;

  [[nodiscard]] std::size_t ring_begin(std::size_t ring) const { return ring == 0 ? 0 : ring_ends[ring - 1] - first; }
  [[nodiscard]] std::size_t ring_end(std::size_t ring) const { return ring_ends[ring] - first; }
  [[nodiscard]] std::size_t axes() const { return textured ? kAxes : kPlaneAxes; }
  /// Returns the normal times twice the area, in lattice steps.
  [[nodiscard]] std::array<double, 3> normal() const;
};

/// Returns the plane across a normal with slopes of this precision (0..3).
[[nodiscard]] Plane plane_across(const std::array<double, 3>& normal, int precision);

using Numbers = std::array<std::uint64_t, kAxes>;

/// Differences of a polygon's corners, as written.
class Differences {
 public:
  Differences(const Polygon& polygon, const Plane& plane);

  /// Returns the bits of everything after the first corner.
  [[nodiscard]] std::uint64_t cost(const Code& code) const;
  [[nodiscard]] const std::vector<Numbers>& numbers() const { return numbers_; }
  [[nodiscard]] std::size_t axes() const { return axes_; }
  /// Writes the rings: corner counts and differences.
  void write(const Polygon& polygon, const Code& code, BitWriter& to) const;

 private:
  void add_ring(std::span<const Place> places);

  std::size_t axes_;
  std::vector<Numbers> numbers_, corrections_;
  std::vector<std::uint8_t> parallelograms_;  // by ring
  std::uint64_t fixed_cost_ = 0;              // bits that do not depend on the code
};

/// Returns the code that needs the fewest bits for all numbers.
[[nodiscard]] Code best_code(std::span<const Numbers> numbers, std::size_t axes);

/// Polygons of one appearance, as the records of a chunk.
struct Chunk {
  ChunkHead head;
  std::vector<std::byte> records;
  [[nodiscard]] std::vector<std::byte> payload(const LatticeBits& bits) const;
};

/// Properties shared by all chunks of an appearance.
struct ChunkKind {
  std::uint16_t appearance = 0;
  bool inner = false, textured = false;
};

/// Leaves `records` empty if a record exceeds 65,535 bytes.
[[nodiscard]] Chunk encode_chunk_of(std::span<const Polygon> polygons, const ChunkKind& kind);

}  // namespace gs::qnv::outline
