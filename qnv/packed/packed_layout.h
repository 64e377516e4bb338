#pragma once

#include "qnv/packed/packed.h"
#include "qnv/packed/packed_tables.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <cstdlib>

namespace gs::qnv {

// What the encoder and the decoder of the packed payload agree on, in integers.

constexpr std::size_t kResidualContexts = 3;

/// The parameters of a cluster: bytes 14 to 21 of its payload.
struct ClusterParameters {
  std::uint8_t occupancy = 0;  // model
  bool doubles = false;        // some voxel is double, or one of the run is
  bool colored = false;
  bool normals_around = false;  // normals are predicted from neighbours too
  bool offsets_around = false;  // offsets likewise
  std::uint8_t normal_shift = 6, offset_shift = 2, color_shift = 3;
  std::array<std::uint8_t, kResidualContexts> normal{}, offset{};  // models by the parent's activity
  std::uint8_t luma = 0, chroma = 0;                               // models
};
constexpr std::size_t kClusterHeaderSize = 22;
/// A cluster gives at most this many voxels a byte, so that a few bytes cannot ask for much.
constexpr std::size_t kVoxelsPerByte = 64;
constexpr std::uint32_t kDoubleProbability = 512;  // of 4096

/// The normal of 1-norm kOctahedral that octahedral coordinates stand for.
inline std::array<int, 3> octahedral_normal(int u, int v) {
  const int au = std::abs(u), av = std::abs(v), w = kOctahedral - au - av;
  if (w >= 0) return {u, v, w};
  return {u < 0 ? av - kOctahedral : kOctahedral - av, v < 0 ? au - kOctahedral : kOctahedral - au, w};
}

/// Coordinates outside the square continue on its other side (mirrored at the middle of the edge).
inline void wrap_octahedral(int& u, int& v) {
  if (u > kOctahedral || u < -kOctahedral) {
    u = (u < 0 ? -2 : 2) * kOctahedral - u;
    v = -v;
  }
  if (v > kOctahedral || v < -kOctahedral) {
    v = (v < 0 ? -2 : 2) * kOctahedral - v;
    u = -u;
  }
  // Only what no encoder writes still lies outside.
  u = u < -kOctahedral ? -kOctahedral : (u > kOctahedral ? kOctahedral : u);
  v = v < -kOctahedral ? -kOctahedral : (v > kOctahedral ? kOctahedral : v);
}

/// The opposite normal.
inline void flip_octahedral(int& u, int& v) {
  const int fu = kOctahedral - std::abs(v), fv = kOctahedral - std::abs(u);
  u = u < 0 ? fu : -fu;
  v = v < 0 ? fv : -fv;
}

/// How far child `c` lies along a normal of 1-norm kOctahedral, times 2 kOctahedral, in edges of the child.
inline int along(const std::array<int, 3>& normal, unsigned c) {
  return ((c & 1) != 0 ? normal[0] : -normal[0]) + ((c & 2) != 0 ? normal[1] : -normal[1]) +
         ((c & 4) != 0 ? normal[2] : -normal[2]);
}

/// Which entry of an occupancy model stands for a child.
inline std::size_t occupancy_bin(int along_normal, int parent_offset) {
  const int margin = kOctahedral - std::abs(along_normal - (2 * 2 * kOctahedral / kOffsetUnits) * parent_offset);
  const int bin = (margin + 2 * kOctahedral) >> 7;
  return static_cast<std::size_t>(bin < 0 ? 0 : (bin > 23 ? 23 : bin));
}

/// Where the parent's plane lies in a child.
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

/// The area of a plane inside a unit cube, from its normal of 1-norm 1 and its offset, with the profile along the
/// normal taken as a trapezium. Its mean over all offsets is exact. Never less than a tenth of the largest.
[[nodiscard]] float plane_section(const glm::vec3& one_norm_normal, float offset);

/// What level 0 is divided from when a cluster has no parent.
[[nodiscard]] PackedVoxels root_voxel(bool colored);
/// Some voxels, in the order of their indices.
[[nodiscard]] PackedVoxels chosen_voxels(const PackedVoxels& from, std::span<const std::uint32_t> indices);

/// Bytes 0 to 13 of every cluster, of whatever octree: where it stands. Safe for untrusted bytes.
[[nodiscard]] std::variant<ClusterHeader, PackedError> read_cluster_place(std::span<const std::byte> payload,
                                                                          std::size_t header_bytes);
void write_cluster_place(const ClusterHeader& header, std::vector<std::byte>& out);

[[nodiscard]] ClusterParameters read_parameters(std::span<const std::byte> header);
void write_cluster_header(const ClusterHeader& header, const ClusterParameters& parameters,
                          std::vector<std::byte>& out);

/// Luma -255..255 ranges as in YCoCg-R (Malvar and Sullivan 2003).
inline std::array<int, 3> ycocg_of(int r, int g, int b) {
  const int co = r - b, t = b + (co >> 1), cg = g - t;
  return {t + (cg >> 1), co, cg};
}
inline std::array<int, 3> rgb_of(int y, int co, int cg) {
  const int t = y - (cg >> 1), g = cg + t, b = t - (co >> 1);
  return {b + co, g, b};
}

}  // namespace gs::qnv
