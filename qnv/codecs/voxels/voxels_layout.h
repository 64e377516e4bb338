#pragma once

#include "qnv/codecs/octree/packed_layout.h"
#include "qnv/codecs/voxels/voxels.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

namespace gs::qnv {

// Rules that the encoder and the decoder of the voxels payload share. All arithmetic is in integers.

/// Coding parameters of a cluster: bytes 14 to 23 of its payload.
struct VolumeParameters {
  std::uint8_t occupancy = 3, bias = kNoBias;  // steepness of the probabilities; offset of the log odds
  std::uint8_t value_step = 12, direction_step = 20, magnitude_step = 4;
  std::uint8_t slope = 0;  // slope of the values along the parent's direction
  std::uint8_t turn = 0, trust = 0;  // rate at which value differences turn
                                                                     // directions, and its weight
  std::array<std::uint8_t, kResidualContexts> direction{}, value{};  // indices of models, by the parent's activity
  std::uint8_t magnitude = 0;                                        // index of the model

  static constexpr std::uint8_t kNoBias = 16;
};
constexpr std::size_t kVolumeClusterHeaderSize = 24;
constexpr int kDirectionUnit = 16;  // VoxelSteps::direction and VolumeParameters::direction_step are in units of
                                    // kDirectionUnit / kOctahedral

/// Log odds that a child exists, in 1/16: one term per axis. First index: share of the parent's direction along the
/// axis. Second: state of the child's sibling across the axis (0: not decoded yet, 1: absent, 2: exists). Third:
/// whether the parent has a neighbour on the child's side. Fourth: whether the parent has a neighbour on the other
/// side.
using OccupancyOdds = std::array<std::array<std::array<std::array<std::int8_t, 2>, 2>, 3>, 3>;
[[nodiscard]] const OccupancyOdds& occupancy_odds();
constexpr int kOddsOfAll = -12;
/// Returns the probabilities, in 1/4096, for log odds of 0, 1/8, 2/8, ...
[[nodiscard]] const std::array<std::uint16_t, 65>& logistic_table();
/// Steepness for each value of VolumeParameters::occupancy, in 1/16.
constexpr std::array<int, 8> kSteepness{6, 9, 12, 14, 16, 20, 25, 32};

/// Returns the share of a direction along an axis: 0 (small) to 2 (large). `component` belongs to a direction with
/// 1-norm kOctahedral.
inline unsigned share_along(int component) {
  const int size = std::abs(component);
  return size < 200 ? 0 : size < 420 ? 1 : 2;
}

/// Returns the probability, in 1/4096, for log odds in 1/16.
inline std::uint32_t probability_of(int odds, const std::array<std::uint16_t, 65>& logistic, int steepness) {
  const int eighths = std::clamp((odds * steepness) >> 5, -64, 64);
  return eighths >= 0 ? logistic[static_cast<unsigned>(eighths)]
                      : kRansTotal - logistic[static_cast<unsigned>(-eighths)];
}

/// Log odds that the children of one voxel exist, from the voxel's direction and neighbours.
struct ChildOdds {
  // Indices: axis; side of the child; sibling not decoded yet, absent or existing.
  std::array<std::array<std::array<std::int8_t, 3>, 2>, 3> parts;

  ChildOdds(const OccupancyOdds& odds, const std::array<int, 3>& direction,
            const std::array<std::uint16_t, 6>& neighbours) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t side = 0; side < 2; ++side) {
        const unsigned near = neighbours[2 * a + side] != kNoNeighbour,
                       far = neighbours[2 * a + 1 - side] != kNoNeighbour;
        for (std::size_t sibling = 0; sibling < 3; ++sibling)
          parts[a][side][sibling] = odds[share_along(direction[a])][sibling][near][far];
      }
  }
  /// Returns the log odds of child `c`. `mask` has the decoded children before `c`.
  [[nodiscard]] int of(unsigned c, unsigned mask) const {
    const auto part = [&](unsigned a) {
      const unsigned side = c >> a & 1;
      return parts[a][side][side == 0 ? 0 : 1 + (mask >> (c ^ (1u << a)) & 1)];
    };
    return part(0) + part(1) + part(2);
  }
};

/// Returns the predicted value of a child. Assumes that values rise linearly along the parent's direction.
inline int predicted_value(int value, const std::array<int, 3>& direction, unsigned c, const VoxelLattice& lattice,
                           int slope) {
  int along = 0;
  for (unsigned a = 0; a < 3; ++a) along += ((c >> a & 1) != 0 ? direction[a] : -direction[a]) * lattice.lengths[a];
  return std::clamp(value + ((slope * along + (1 << 19)) >> 20), 0, 255);
}

struct OctahedralPoint {
  int u, v;
};

/// Returns the octahedral coordinates of a direction with any length; (0, 0) for a zero direction.
inline OctahedralPoint octahedral_of(const std::array<int, 3>& d) {
  const int norm = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
  if (norm == 0) return {0, 0};
  const int u = d[0] * kOctahedral / norm, v = d[1] * kOctahedral / norm;
  if (d[2] >= 0) return {u, v};
  const int fu = kOctahedral - std::abs(v), fv = kOctahedral - std::abs(u);
  return {u < 0 ? -fu : fu, v < 0 ? -fv : fv};
}

/// Rates at which value differences turn directions, in units of the parent.
struct ValueTurns {
  std::array<int, 3> rate{};  // change of the direction component per unit of value difference, by axis
  int trust = 0;

  ValueTurns(const VolumeParameters& p, const VoxelLattice& lattice) : trust(p.trust) {
    for (std::size_t a = 0; a < 3; ++a) rate[a] = (p.turn << 8) / lattice.lengths[a];
  }
};

/// Directions of a divided voxel and of its neighbours. Negates neighbours that point away from the voxel's direction;
/// missing neighbours are zero.
struct DirectionsAround {
  std::array<int, 3> own;
  std::array<std::array<int, 3>, 6> neighbours;

  DirectionsAround(const VolumeVoxels& from, std::size_t voxel) : own(octahedral_normal(from.u[voxel], from.v[voxel])) {
    for (std::size_t side = 0; side < 6; ++side) {
      const std::uint16_t n = from.neighbours[voxel][side];
      if (n == kNoNeighbour) {
        neighbours[side] = {};
        continue;
      }
      const std::array<int, 3> d = octahedral_normal(from.u[n], from.v[n]);
      const int turn = d[0] * own[0] + d[1] * own[1] + d[2] * own[2] < 0 ? -1 : 1;
      for (std::size_t i = 0; i < 3; ++i) neighbours[side][i] = turn * d[i];
    }
  }
};

/// Returns the predicted direction of child `c`. Starts with the mean of the parent's direction and the directions of
/// the parent's neighbours on the child's side. Turns it towards siblings with higher values. `values` has the values
/// of the children in `mask`.
inline OctahedralPoint predicted_direction(const DirectionsAround& around, unsigned c, unsigned mask,
                                           const std::array<std::uint8_t, 8>& values, const ValueTurns& turns) {
  std::array<int, 3> sum{};
  const auto &x = around.neighbours[c & 1], &y = around.neighbours[2 + (c >> 1 & 1)],
             &z = around.neighbours[4 + (c >> 2)];
  for (unsigned i = 0; i < 3; ++i) sum[i] = 3 * around.own[i] + x[i] + y[i] + z[i];
  if (turns.trust != 0) {
    const int norm = std::abs(sum[0]) + std::abs(sum[1]) + std::abs(sum[2]);
    for (unsigned a = 0; a < 3; ++a) {
      const unsigned sibling = c ^ (1u << a);
      if ((mask >> sibling & 1) == 0) continue;
      const int difference = (c >> a & 1) != 0 ? values[c] - values[sibling] : values[sibling] - values[c];
      const int seen = std::clamp(difference * turns.rate[a], -kOctahedral, kOctahedral) * norm >> 10;
      sum[a] += (seen - sum[a]) * turns.trust >> 4;
    }
  }
  return octahedral_of(sum);
}

/// Returns the voxel of level 0, which the root cluster divides.
[[nodiscard]] VolumeVoxels root_volume_voxel();
/// Links neighbours among the children of a cluster. `first_child` has one more entry than there are divided voxels.
void link_neighbours(const VolumeVoxels& from, std::size_t first, std::span<const std::uint8_t> masks,
                     std::span<const std::uint32_t> first_child, VolumeVoxels& children);

[[nodiscard]] VolumeParameters read_volume_parameters(std::span<const std::byte> header);
void write_volume_cluster_header(const ClusterHeader& header, const VolumeParameters& parameters,
                                 std::vector<std::byte>& out);

}  // namespace gs::qnv
