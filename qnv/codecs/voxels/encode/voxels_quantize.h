#pragma once

#include "qnv/codecs/voxels/voxels_layout.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Voxel of any level before quantisation.
struct TrueVoxel {
  std::uint64_t key = 0;  // Morton code of the voxel at its level
  glm::vec3 gradient{0};  // mean of the gradients, opposite ones negated; in lattice axes
  float value = 0, magnitude = 0;  // means over the voxel; the magnitude is in codes
  float vectors = 1;               // number of vectors inside
  float seen = 1;  // visible fraction, 0..1
};

/// Symbols of one level of one cluster, in an encoder.
struct VolumeSymbols {
  struct Parent {
    std::uint32_t index;  // index of the parent among the divided voxels
    std::uint8_t mask;
    std::array<std::int16_t, 8> odds;  // odds that each child exists, without the cluster's bias
    std::uint32_t first_child;
    double gain = 0;
  };
  struct Child {
    std::uint8_t direction_context, value_context;
    int du, dv, value, magnitude;
  };
  std::vector<Parent> parents;
  std::vector<Child> children;
  VolumeVoxels voxels;  // children as a decoder obtains them, without neighbours
};

/// Sets VolumeParameters::slope and `turn` to the values that fit a level best.
void fit_slopes(const VolumeVoxels& from, std::span<const std::span<const TrueVoxel>> below,
                const VoxelLattice& lattice, VolumeParameters& parameters);

/// Quantises the true children of decoded voxels, with exactly the decoder's predictions. `below` lists for each
/// decoded voxel its true children, in order. `edge` is the edge of the children, relative to the edge of the root
/// voxel.
[[nodiscard]] VolumeSymbols quantize_volume(const VolumeVoxels& from, std::span<const std::span<const TrueVoxel>> below,
                                            double edge, const VoxelLattice& lattice,
                                            const VolumeParameters& parameters);

/// Returns the symbols of `count` parents from `first` on.
[[nodiscard]] VolumeSymbols chosen_symbols(const VolumeSymbols& all, std::size_t first, std::size_t count);
/// Chooses the cheapest models for the symbols of some levels.
void choose_models(std::span<const VolumeSymbols> levels, VolumeParameters& parameters);
/// Writes the symbols of one level to `rans`.
void put_level(const VolumeSymbols& level, const VolumeParameters& parameters, RansEncoder& rans);
/// Links neighbouring children in the same way as a decoder.
void link_neighbours(const VolumeVoxels& from, std::size_t first, const VolumeSymbols& symbols, VolumeVoxels& children);

}  // namespace gs::qnv
