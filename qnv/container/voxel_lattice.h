#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Constants of magnitude codes. Code m means unit * 2^((m - kMagnitudeOne) / kMagnitudesAnOctave).
constexpr int kMagnitudeOne = 64, kMagnitudesAnOctave = 4, kMaxMagnitude = 127;
/// Length of the longest axis. The lengths of all axes are in 1/256 of it.
constexpr int kLongestAxis = 256;

/// Lattice of the voxels of a volume stream. An octree divides its indices. FORMAT.md, "Voxels payload".
struct VoxelLattice {
  glm::vec3 origin{0};  // centre of voxel (0, 0, 0), in units of the source
  std::array<glm::vec3, 3> axes{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};  // step of one voxel
  std::array<std::uint32_t, 3> dimensions{1, 1, 1};
  float unit = 1;  // magnitude that code kMagnitudeOne means, > 0
  std::uint8_t depth = 1;  // finest octree level; a voxel there is one lattice point
  std::array<std::uint16_t, 3> lengths{kLongestAxis, kLongestAxis, kLongestAxis};  // of the axes, 1..kLongestAxis

  /// Returns the position of a voxel at an octree level: its centre, clamped to the lattice.
  [[nodiscard]] glm::vec3 position(int level, std::uint32_t x, std::uint32_t y, std::uint32_t z) const;
  /// Returns the maximum distance at which vectors of a level affect the drawing, in units of the source. The distance
  /// is less than a voxel edge, because coarse voxels are seldom full. Returns 0 at the finest level, where the lattice
  /// determines the distance.
  [[nodiscard]] float reach(int level) const;
  /// Returns the inverse of the matrix of unit axes. It maps gradients along the axes to world space. Returns nullopt
  /// if the matrix is singular.
  [[nodiscard]] std::optional<std::array<glm::vec3, 3>> world_from_axes() const;
  [[nodiscard]] float magnitude(int code) const;
  friend bool operator==(const VoxelLattice&, const VoxelLattice&) = default;
};

/// Reports whether a lattice is valid: positions are finite, the axes span space, and the depth fits the dimensions.
[[nodiscard]] bool sound(const VoxelLattice& lattice);

/// Encodes the header section.
[[nodiscard]] std::vector<std::byte> encode_voxel_lattice(const VoxelLattice& lattice);
/// Decodes the header section. Returns nullopt if it is truncated or contains invalid numbers. Safe for untrusted
/// bytes.
[[nodiscard]] std::optional<VoxelLattice> decode_voxel_lattice(std::span<const std::byte> section);

}  // namespace gs::qnv
