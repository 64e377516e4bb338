#include "qnv/codecs/octree/decode/divide_cluster.h"
#include "qnv/codecs/octree/decode/packed_kernels.h"
#include "qnv/codecs/voxels/voxels_layout.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace gs::qnv {
namespace {

/// Decoder of one level of one cluster.
class VolumeLevelDecoder {
 public:
  VolumeLevelDecoder(RansDecoder& rans, const VolumeParameters& parameters, const VoxelLattice& lattice,
                     const VolumeVoxels& from, std::size_t first, std::size_t count)
      : rans_(rans), p_(parameters), lattice_(lattice), from_(from), first_(first), count_(count) {}

  bool run(VolumeVoxels& out, std::size_t most, bool linked) {
    occupancy();
    first_child_.reserve(count_ + 1);
    for (const std::uint8_t mask : masks_) {
      if (mask == 0) return false;  // rejects a divided voxel without children, which would vanish
      first_child_.push_back(static_cast<std::uint32_t>(size_));
      size_ += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(mask)));
    }
    first_child_.push_back(static_cast<std::uint32_t>(size_));
    if (size_ > most) return false;
    out.resize(size_ + kKernelSlack);
    context_.resize(size_ + kKernelSlack);
    residual_.resize(size_ + kKernelSlack);
    values(out);
    magnitudes(out);
    directions(out);
    out.resize(size_);
    if (linked) link_neighbours(from_, first_, masks_, first_child_, out);
    return true;
  }

 private:
  // Decodes with a local copy of the decoder, which stays in registers.
  void occupancy() {
    masks_.resize(count_);
    RansDecoder rans = rans_;
    const OccupancyOdds& odds = occupancy_odds();
    const auto& logistic = logistic_table();
    const int steepness = kSteepness[p_.occupancy];
    const int all = kOddsOfAll + 2 * (static_cast<int>(p_.bias) - VolumeParameters::kNoBias);
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t parent = first_ + i;
      const ChildOdds children(odds, octahedral_normal(from_.u[parent], from_.v[parent]), from_.neighbours[parent]);
      unsigned mask = 0;
      for (unsigned c = 0; c < 8; ++c) {
        const std::uint32_t probability = probability_of(all + children.of(c, mask), logistic, steepness);
        const bool there = rans.peek(c) < probability;
        rans.advance(c, there ? 0 : probability, there ? probability : kRansTotal - probability);
        mask |= (there ? 1u : 0u) << c;
      }
      masks_[i] = static_cast<std::uint8_t>(mask);
    }
    rans_ = rans;
  }

  // Calls work(parent, code of the child, child) for every child.
  template <class Work>
  void for_each_child(Work&& work) const {
    std::size_t next = 0;
    for (std::size_t i = 0; i < count_; ++i)
      for (unsigned mask = masks_[i]; mask != 0; mask &= mask - 1)
        work(first_ + i, static_cast<unsigned>(std::countr_zero(mask)), next++);
  }

  void read(const std::array<std::uint8_t, kResidualContexts>& chosen) {
    const std::array<std::uint32_t, kResidualContexts> models{chosen[0], chosen[1], chosen[2]};
    packed_kernels().residuals(rans_, models.data(), context_.data(), size_, residual_.data());
  }

  void values(VolumeVoxels& out) {
    for_each_child([&](std::size_t parent, unsigned c, std::size_t i) {
      out.x[i] = static_cast<std::uint16_t>(from_.x[parent] * 2 + (c & 1));
      out.y[i] = static_cast<std::uint16_t>(from_.y[parent] * 2 + (c >> 1 & 1));
      out.z[i] = static_cast<std::uint16_t>(from_.z[parent] * 2 + (c >> 2));
      context_[i] = static_cast<std::uint8_t>(residual_context(static_cast<std::uint8_t>(from_.activity[parent] >> 2)));
    });
    read(p_.value);
    std::size_t i = 0;
    for (std::size_t p = first_; p < first_ + count_; ++p) {
      const std::array<int, 3> direction = octahedral_normal(from_.u[p], from_.v[p]);
      for (unsigned mask = masks_[p - first_]; mask != 0; mask &= mask - 1, ++i) {
        const auto c = static_cast<unsigned>(std::countr_zero(mask));
        const int residual = residual_[i];
        const int value = predicted_value(from_.value[p], direction, c, lattice_, p_.slope) +
                          residual * static_cast<int>(p_.value_step);
        out.value[i] = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
        out.activity[i] = static_cast<std::uint8_t>(std::min(std::abs(residual), 3) << 2);
      }
    }
  }

  void magnitudes(VolumeVoxels& out) {
    read({p_.magnitude, p_.magnitude, p_.magnitude});
    for_each_child([&](std::size_t parent, unsigned, std::size_t i) {
      const int magnitude = from_.magnitude[parent] + residual_[i] * static_cast<int>(p_.magnitude_step);
      out.magnitude[i] = static_cast<std::uint8_t>(std::clamp(magnitude, 0, kMaxMagnitude));
    });
  }

  void directions(VolumeVoxels& out) {
    const ValueTurns turns(p_, lattice_);
    const int step = p_.direction_step * kDirectionUnit;
    for_each_child([&](std::size_t parent, unsigned, std::size_t i) {
      context_[i] = static_cast<std::uint8_t>(residual_context(from_.activity[parent]));
    });
    read(p_.direction);
    const std::vector<std::int16_t> du = residual_;
    read(p_.direction);
    std::size_t i = 0;
    for (std::size_t p = first_; p < first_ + count_; ++p) {
      const unsigned all = masks_[p - first_];
      const DirectionsAround around(from_, p);
      std::array<std::uint8_t, 8> values{};
      std::size_t next = i;
      for (unsigned mask = all; mask != 0; mask &= mask - 1)
        values[static_cast<std::size_t>(std::countr_zero(mask))] = out.value[next++];
      for (unsigned mask = all; mask != 0; mask &= mask - 1, ++i) {
        const OctahedralPoint expected =
            predicted_direction(around, static_cast<unsigned>(std::countr_zero(mask)), all, values, turns);
        int u = expected.u + du[i] * step, v = expected.v + residual_[i] * step;
        wrap_octahedral(u, v);
        out.u[i] = static_cast<std::int16_t>(u);
        out.v[i] = static_cast<std::int16_t>(v);
        const int size = std::max(std::abs(static_cast<int>(du[i])), std::abs(static_cast<int>(residual_[i])));
        out.activity[i] = static_cast<std::uint8_t>(out.activity[i] | std::min(size, 3));
      }
    }
  }

  RansDecoder& rans_;
  const VolumeParameters& p_;
  const VoxelLattice& lattice_;
  const VolumeVoxels& from_;
  std::size_t first_, count_, size_ = 0;
  std::vector<std::uint8_t> masks_, context_;
  std::vector<std::uint32_t> first_child_;
  std::vector<std::int16_t> residual_;
};

}  // namespace

std::variant<VolumeCluster, PackedError> decode_volume_cluster(std::span<const std::byte> payload,
                                                               const VolumeCluster* parent,
                                                               const VoxelLattice& lattice) {
  auto read = read_volume_cluster_header(payload);
  if (auto* error = std::get_if<PackedError>(&read)) return std::move(*error);
  VolumeCluster cluster;
  cluster.header = std::get<ClusterHeader>(read);
  if (cluster.level() > lattice.depth)
    return PackedError{"a cluster of level " + std::to_string(cluster.level()) + "; the lattice ends at " +
                       std::to_string(lattice.depth)};
  const VolumeParameters parameters = read_volume_parameters(payload);
  auto problem = divide_cluster(
      payload, kVolumeClusterHeaderSize, parent, root_volume_voxel(), cluster,
      [&](RansDecoder& rans, const VolumeVoxels& from, std::size_t first, std::size_t count, int level,
          VolumeVoxels& next, std::size_t most) {
        return VolumeLevelDecoder(rans, parameters, lattice, from, first, count).run(next, most, level < lattice.depth);
      });
  if (problem) return std::move(*problem);
  return cluster;
}

void append_vectors(const VolumeCluster& cluster, std::size_t first, std::size_t count, const VoxelLattice& lattice,
                    Volume& volume) {
  const auto world = lattice.world_from_axes();
  if (!world) return;
  const VolumeVoxels& voxels = cluster.voxels;
  const int level = cluster.level();
  const float reach = lattice.reach(level);
  std::array<float, kMaxMagnitude + 1> magnitudes{};
  for (int m = 0; m <= kMaxMagnitude; ++m) magnitudes[static_cast<unsigned>(m)] = lattice.magnitude(m);
  for (std::size_t i = first; i < first + count; ++i) {
    const std::array<int, 3> d = octahedral_normal(voxels.u[i], voxels.v[i]);
    const glm::vec3 gradient = (*world)[0] * static_cast<float>(d[0]) + (*world)[1] * static_cast<float>(d[1]) +
                               (*world)[2] * static_cast<float>(d[2]);
    volume.positions.push_back(lattice.position(level, voxels.x[i], voxels.y[i], voxels.z[i]));
    volume.normals.push_back(glm::normalize(gradient));
    volume.weights.push_back(magnitudes[voxels.magnitude[i]]);
    volume.classes.push_back(voxels.value[i]);
    volume.cells.push_back({reach, 0});
  }
}

}  // namespace gs::qnv
