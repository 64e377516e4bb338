#pragma once

#include "qnv/codecs/octree/packed_layout.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Symbols of one level of one cluster, in the order in which a decoder reads them.
struct LevelSymbols {
  struct Parent {
    std::uint32_t index;  // index of the parent among the divided voxels
    std::uint8_t mask;  // one bit per existing child
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
  PackedVoxels voxels;  // children as a decoder obtains them
};

/// Quantises the true children of decoded voxels, with exactly the decoder's predictions. `below` lists for each
/// decoded voxel its true children, in order. `edge` is the edge of the children, relative to the edge of the cube.
[[nodiscard]] LevelSymbols quantize_level(const PackedVoxels& from, std::span<const std::span<const Voxel>> below,
                                          double edge, const ClusterParameters& shifts);

/// Returns the symbols of `count` parents from `first` on.
[[nodiscard]] LevelSymbols chosen_symbols(const LevelSymbols& all, std::size_t first, std::size_t count);

/// Returns the size of the normal and offset residuals with their cheapest models, in 1/256 bits.
[[nodiscard]] std::uint64_t plane_cost(std::span<const LevelSymbols> levels);

/// Chooses the cheapest models for the symbols of some levels.
void choose_models(std::span<const LevelSymbols> levels, ClusterParameters& parameters);

/// Writes the symbols of one level to `rans`.
void put_level(const LevelSymbols& level, const ClusterParameters& parameters, RansEncoder& rans);

/// Returns the area of the part of a plane that is inside a voxel, relative to a voxel face. append_discs() uses the
/// same formula.
[[nodiscard]] float plane_section(int u, int v, int offset);

}  // namespace gs::qnv
