#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Magnitudes are powers of two: code m stands for unit * 2^((m - kMagnitudeOne) / kMagnitudesAnOctave).
constexpr int kMagnitudeOne = 64, kMagnitudesAnOctave = 4, kMostMagnitude = 127;
/// Lengths of axes are compared in 1/256 of the longest.
constexpr int kLongestAxis = 256;

/// The grid on which the vectors of a stream of voxels stand, and that an octree over its numbers divides. FORMAT.md,
/// "Voxels payload".
struct VoxelLattice {
  glm::vec3 origin{0};  // centre of voxel (0, 0, 0), units of the source
  std::array<glm::vec3, 3> axes{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};  // one voxel's step
  std::array<std::uint32_t, 3> dimensions{1, 1, 1};
  float unit = 1;          // the magnitude that code kMagnitudeOne stands for, > 0
  std::uint8_t depth = 1;  // the octree's finest level, where a voxel is one of the lattice
  std::array<std::uint16_t, 3> lengths{kLongestAxis, kLongestAxis, kLongestAxis};  // of the axes, 1..kLongestAxis

  /// Where a voxel of a level stands: its centre, but within the lattice.
  [[nodiscard]] glm::vec3 position(int level, std::uint32_t x, std::uint32_t y, std::uint32_t z) const;
  /// How far apart the vectors of a level are drawn at most, units of the source; 0 where a voxel is one of the
  /// lattice, and they are as far apart as they are. A voxel that stands for many is seldom full of them.
  [[nodiscard]] float reach(int level) const;
  /// Directions of gradients: each row of the matrix times a gradient is its part along one axis. The rows of the
  /// inverse; empty where there is none.
  [[nodiscard]] std::optional<std::array<glm::vec3, 3>> world_from_axes() const;
  [[nodiscard]] float magnitude(int code) const;
  friend bool operator==(const VoxelLattice&, const VoxelLattice&) = default;
};

/// Whether every number of it can be: finite positions, axes that span space, a depth that holds the dimensions.
[[nodiscard]] bool sound(const VoxelLattice& lattice);

/// The bytes of the header's section.
[[nodiscard]] std::vector<std::byte> encode_voxel_lattice(const VoxelLattice& lattice);
/// Nothing where it is cut, or holds impossible numbers. Safe for untrusted bytes.
[[nodiscard]] std::optional<VoxelLattice> decode_voxel_lattice(std::span<const std::byte> section);

}  // namespace gs::qnv
