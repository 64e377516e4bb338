#pragma once

#include "qnv/voxels/voxels_layout.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// A voxel of any level as it truly is.
struct TrueVoxel {
  std::uint64_t key = 0;           // Morton code at the level
  glm::vec3 gradient{0};           // mean of those inside, opposite ones turned; along the lattice's axes
  float value = 0, magnitude = 0;  // means; the magnitude in codes
  float vectors = 1;               // inside
  float seen = 1;                  // 0..1: how much of it can be seen
};

/// The decisions of one level of one cluster, in the encoder's hands.
struct VolumeSymbols {
  struct Parent {
    std::uint32_t index;  // among the voxels that are divided
    std::uint8_t mask;
    std::array<std::int16_t, 8> odds;  // of its children, without those of the cluster
    std::uint32_t first_child;
    double gain = 0;
  };
  struct Child {
    std::uint8_t direction_context, value_context;
    int du, dv, value, magnitude;
  };
  std::vector<Parent> parents;
  std::vector<Child> children;
  VolumeVoxels voxels;  // the children as they will be decoded, without neighbours
};

/// What of a level suits its values: VolumeParameters::slope and turn.
void fit_slopes(const VolumeVoxels& from, std::span<const std::span<const TrueVoxel>> below,
                const VoxelLattice& lattice, VolumeParameters& parameters);

/// Quantises the true voxels below decoded ones, following what the decoder will know. `below` gives for each of them
/// its true children in order; `edge` is that of the children over the root's.
[[nodiscard]] VolumeSymbols quantize_volume(const VolumeVoxels& from, std::span<const std::span<const TrueVoxel>> below,
                                            double edge, const VoxelLattice& lattice,
                                            const VolumeParameters& parameters);

/// The symbols of a run of the parents.
[[nodiscard]] VolumeSymbols chosen_symbols(const VolumeSymbols& all, std::size_t first, std::size_t count);
/// Chooses the models that make the symbols of some levels cheapest.
void choose_models(std::span<const VolumeSymbols> levels, VolumeParameters& parameters);
/// Writes the symbols of one level.
void put_level(const VolumeSymbols& level, const VolumeParameters& parameters, RansEncoder& rans);
/// The neighbours of the children, as the decoder will link them.
void link_neighbours(const VolumeVoxels& from, std::size_t first, const VolumeSymbols& symbols, VolumeVoxels& children);

}  // namespace gs::qnv
