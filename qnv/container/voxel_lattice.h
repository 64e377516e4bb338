#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Magnitudes are powers of two: code m means unit * 2^((m - kMagnitudeOne) / kMagnitudesAnOctave).
constexpr int kMagnitudeOne = 64, kMagnitudesAnOctave = 4, kMaxMagnitude = 127;
/// Lengths of axes are relative to the longest, in 1/256.
constexpr int kLongestAxis = 256;

/// Lattice of the vectors of a voxel stream; an octree divides its indices. FORMAT.md, "Voxels payload".
struct VoxelLattice {
  glm::vec3 origin{0};  // centre of voxel (0, 0, 0), units of the source
  std::array<glm::vec3, 3> axes{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};  // step of one voxel
  std::array<std::uint32_t, 3> dimensions{1, 1, 1};
  float unit = 1;          // magnitude of code kMagnitudeOne, > 0
  std::uint8_t depth = 1;  // finest octree level, at which a voxel is one lattice point
  std::array<std::uint16_t, 3> lengths{kLongestAxis, kLongestAxis, kLongestAxis};  // of the axes, 1..kLongestAxis

  /// Returns the position of a voxel of a level: its centre, clamped to the lattice.
  [[nodiscard]] glm::vec3 position(int level, std::uint32_t x, std::uint32_t y, std::uint32_t z) const;
  /// Returns the maximum distance at which the vectors of a level are drawn, units of the source. Returns 0 at the
  /// finest level, where the lattice itself gives it. Coarse voxels are seldom full.
  [[nodiscard]] float reach(int level) const;
  /// Returns the inverse of the matrix of unit axes, which maps directions along the axes to world space. Returns
  /// nullopt if it is singular.
  [[nodiscard]] std::optional<std::array<glm::vec3, 3>> world_from_axes() const;
  [[nodiscard]] float magnitude(int code) const;
  friend bool operator==(const VoxelLattice&, const VoxelLattice&) = default;
};

/// Reports whether a lattice is valid: finite positions, axes that span space, a depth that fits the dimensions.
[[nodiscard]] bool sound(const VoxelLattice& lattice);

/// Returns the bytes of the header section.
[[nodiscard]] std::vector<std::byte> encode_voxel_lattice(const VoxelLattice& lattice);
/// Returns nullopt if the section is truncated or holds invalid numbers. Safe for untrusted bytes.
[[nodiscard]] std::optional<VoxelLattice> decode_voxel_lattice(std::span<const std::byte> section);

}  // namespace gs::qnv
