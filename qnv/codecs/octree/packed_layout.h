#pragma once

#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/octree/packed_tables.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <cstdlib>

namespace gs::qnv {

// Rules that the packed encoder and decoder share. All arithmetic is in integers.

constexpr std::size_t kResidualContexts = 3;

/// Coding parameters of a cluster: bytes 14 to 21 of its payload.
struct ClusterParameters {
  std::uint8_t occupancy = 0;  // index of the model
  bool doubles = false;  // some voxel of the parent run or of the result is two-sided
  bool colored = false;
  bool normals_around = false;  // also predicts normals from neighbours
  bool offsets_around = false;  // also predicts offsets from neighbours
  std::uint8_t normal_shift = 6, offset_shift = 2, color_shift = 3;
  std::array<std::uint8_t, kResidualContexts> normal{}, offset{};  // indices of models, by the parent's activity
  std::uint8_t luma = 0, chroma = 0;  // indices of models
};
constexpr std::size_t kClusterHeaderSize = 22;
/// Maximum number of voxels per byte of a cluster. Prevents a few bytes from requesting much memory.
constexpr std::size_t kVoxelsPerByte = 64;
constexpr std::uint32_t kDoubleProbability = 512;  // in units of 1/4096

/// Returns the normal with the octahedral coordinates (u, v). Its 1-norm is kOctahedral.
inline std::array<int, 3> octahedral_normal(int u, int v) {
  const int au = std::abs(u), av = std::abs(v), w = kOctahedral - au - av;
  if (w >= 0) return {u, v, w};
  return {u < 0 ? av - kOctahedral : kOctahedral - av, v < 0 ? au - kOctahedral : kOctahedral - au, w};
}

/// Wraps coordinates outside the square to its other side, mirrored at the midpoint of the crossed edge.
inline void wrap_octahedral(int& u, int& v) {
  if (u > kOctahedral || u < -kOctahedral) {
    u = (u < 0 ? -2 : 2) * kOctahedral - u;
    v = -v;
  }
  if (v > kOctahedral || v < -kOctahedral) {
    v = (v < 0 ? -2 : 2) * kOctahedral - v;
    u = -u;
  }
  // Clamps coordinates that are still outside. No valid encoder writes them.
  u = u < -kOctahedral ? -kOctahedral : (u > kOctahedral ? kOctahedral : u);
  v = v < -kOctahedral ? -kOctahedral : (v > kOctahedral ? kOctahedral : v);
}

/// Replaces the normal with octahedral coordinates (u, v) by its opposite.
inline void flip_octahedral(int& u, int& v) {
  const int fu = kOctahedral - std::abs(v), fv = kOctahedral - std::abs(u);
  u = u < 0 ? fu : -fu;
  v = v < 0 ? fv : -fv;
}

/// Returns the position of child `c` along a normal with 1-norm kOctahedral. The unit is the child's edge / (2
/// kOctahedral).
inline int along(const std::array<int, 3>& normal, unsigned c) {
  return ((c & 1) != 0 ? normal[0] : -normal[0]) + ((c & 2) != 0 ? normal[1] : -normal[1]) +
         ((c & 4) != 0 ? normal[2] : -normal[2]);
}

/// Returns the bin of the occupancy model for a child. `along_normal` is the result of along().
inline std::size_t occupancy_bin(int along_normal, int parent_offset) {
  const int margin = kOctahedral - std::abs(along_normal - (2 * 2 * kOctahedral / kOffsetUnits) * parent_offset);
  const int bin = (margin + 2 * kOctahedral) >> 7;
  return static_cast<std::size_t>(bin < 0 ? 0 : (bin > 23 ? 23 : bin));
}

/// Predicts the offset of a child's plane from the offset of its parent's plane.
inline int predicted_offset(int along_normal, int parent_offset) {
  const int offset = 2 * parent_offset - ((along_normal * (kOffsetUnits / 2) + kOctahedral / 2) >> 10);
  return offset < -kOffsetUnits / 2 ? -kOffsetUnits / 2 : (offset > kOffsetUnits / 2 ? kOffsetUnits / 2 : offset);
}

inline int clamp_offset(int offset) {
  return offset < -kOffsetUnits / 2 ? -kOffsetUnits / 2 : (offset > kOffsetUnits / 2 ? kOffsetUnits / 2 : offset);
}

inline std::size_t residual_context(std::uint8_t state) {
  const std::size_t activity = state & kActivity;
  return activity > 2 ? 2 : activity;
}

/// Returns the area of a plane inside a unit cube. The normal has 1-norm 1. Approximates the area as a function of the
/// offset by a trapezium with the exact mean. The result is at least a tenth of the maximum.
[[nodiscard]] float plane_section(const glm::vec3& one_norm_normal, float offset);

/// Returns the voxel of level 0, which the root cluster divides.
[[nodiscard]] PackedVoxels root_voxel(bool colored);
/// Returns the voxels with the given indices, in that order.
[[nodiscard]] PackedVoxels chosen_voxels(const PackedVoxels& from, std::span<const std::uint32_t> indices);

/// Reads the position of a cluster in the octree: bytes 0 to 13, which all octree payloads share. Safe for untrusted
/// bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_cluster_place(std::span<const std::byte> payload,
                                                                          std::size_t header_bytes);
void write_cluster_place(const ClusterHeader& header, std::vector<std::byte>& out);

[[nodiscard]] ClusterParameters read_parameters(std::span<const std::byte> header);
void write_cluster_header(const ClusterHeader& header, const ClusterParameters& parameters,
                          std::vector<std::byte>& out);

/// Converts RGB to YCoCg-R (Malvar and Sullivan 2003).
inline std::array<int, 3> ycocg_of(int r, int g, int b) {
  const int co = r - b, t = b + (co >> 1), cg = g - t;
  return {t + (cg >> 1), co, cg};
}
inline std::array<int, 3> rgb_of(int y, int co, int cg) {
  const int t = y - (cg >> 1), g = cg + t, b = t - (co >> 1);
  return {b + co, g, b};
}

}  // namespace gs::qnv
