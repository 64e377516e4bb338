#pragma once

#include "qnv/codecs/octree/packed_layout.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Decisions of one level of one cluster while it is encoded, in decoding order.
struct LevelSymbols {
  struct Parent {
    std::uint32_t index;               // among the divided voxels
    std::uint8_t mask;                 // existing children
    std::array<std::uint8_t, 8> bins;  // occupancy bins of the children
    std::uint32_t first_child;
    double gain = 0;  // improvement of the picture; see FORMAT.md, "Order"
  };
  struct Child {
    std::uint8_t code;
    bool doubled, asks_flip, flip;
    std::uint8_t context;
    int du, dv, offset, luma, co, cg;
  };
  std::vector<Parent> parents;
  std::vector<Child> children;
  PackedVoxels voxels;  // the children as the decoder will see them
};

/// Quantises the true voxels below decoded voxels, with exactly the decoder's predictions. `below` lists for each
/// decoded voxel its true children, in order. `edge` is the children's edge divided by the cube's.
[[nodiscard]] LevelSymbols quantize_level(const PackedVoxels& from, std::span<const std::span<const Voxel>> below,
                                          double edge, const ClusterParameters& shifts);

/// Returns the symbols of a run of the parents.
[[nodiscard]] LevelSymbols chosen_symbols(const LevelSymbols& all, std::size_t first, std::size_t count);

/// Returns the size of the normal and offset residuals under their cheapest models, in 1/256 bits.
[[nodiscard]] std::uint64_t plane_cost(std::span<const LevelSymbols> levels);

/// Chooses the cheapest models for the symbols of some levels.
void choose_models(std::span<const LevelSymbols> levels, ClusterParameters& parameters);

/// Writes the symbols of one level.
void put_level(const LevelSymbols& level, const ClusterParameters& parameters, RansEncoder& rans);

/// Returns the area of the plane inside the cube, relative to a face, as append_discs() computes it.
[[nodiscard]] float plane_section(int u, int v, int offset);

}  // namespace gs::qnv
