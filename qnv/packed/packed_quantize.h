#pragma once

#include "qnv/packed/packed_layout.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// The decisions of one level of one cluster, in the encoder's hands: what the decoder will take, in its order.
struct LevelSymbols {
  struct Parent {
    std::uint32_t index;               // among the voxels that are divided
    std::uint8_t mask;                 // which children there are
    std::array<std::uint8_t, 8> bins;  // occupancy bins of the children
    std::uint32_t first_child;
    double gain = 0;  // how much better the picture gets; see FORMAT.md, "Order"
  };
  struct Child {
    std::uint8_t code;
    bool doubled, asks_flip, flip;
    std::uint8_t context;
    int du, dv, offset, luma, co, cg;
  };
  std::vector<Parent> parents;
  std::vector<Child> children;
  PackedVoxels voxels;  // the children as they will be decoded
};

/// Quantises the true voxels below decoded ones, following what the decoder will know. `below` gives for each of
/// them its true children in order; `edge` is the edge of the children over that of the cube.
[[nodiscard]] LevelSymbols quantize_level(const PackedVoxels& from, std::span<const std::span<const Voxel>> below,
                                          double edge, const ClusterParameters& shifts);

/// The symbols of a run of the parents.
[[nodiscard]] LevelSymbols chosen_symbols(const LevelSymbols& all, std::size_t first, std::size_t count);

/// Bits of the residuals of normals and offsets with the models that make these cheapest, in 1/256.
[[nodiscard]] std::uint64_t plane_cost(std::span<const LevelSymbols> levels);

/// Chooses the models that make the symbols of some levels cheapest.
void choose_models(std::span<const LevelSymbols> levels, ClusterParameters& parameters);

/// Writes the symbols of one level.
void put_level(const LevelSymbols& level, const ClusterParameters& parameters, RansEncoder& rans);

/// The part of a cube's face that its plane covers inside the cube: what append_discs makes of it.
[[nodiscard]] float plane_section(int u, int v, int offset);

}  // namespace gs::qnv
