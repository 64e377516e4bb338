#pragma once

#include "base/box.h"
#include "qnv/base/description.h"
#include "qnv/codecs/shared/lod_view.h"
#include "qnv/codecs/values/bricks/brick_places.h"
#include "qnv/sampling/volume/volume.h"

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {
struct Volume;
}

namespace gs::qnv::values {

/// Share of the voxels of each part of a volume that are vectors, at the level that viewers have as a whole.
class VectorShares {
 public:
  VectorShares() = default;
  /// `extent` is that of the level `level`, and `layout` its layout.
  VectorShares(const Volume& vectors, const VolumeLayout& layout, int level);

  /// Returns the share in a brick of a finer level. Small bricks get that of the cells around them.
  [[nodiscard]] double of(const BrickName& name) const;
  /// Reports whether a vector of the brick has a class that is not hidden. nullopt means the classes that the transfer
  /// function of the stream hides.
  [[nodiscard]] bool visible(const BrickName& name, const std::optional<std::bitset<256>>& hidden) const;

 private:
  static constexpr std::uint32_t kCell = 4;  // edge of a cell in voxels of the level
  struct Range {
    Extent first{}, last{};
  };
  [[nodiscard]] Range cells_of(const BrickName& name) const;

  int level_ = 0;
  Extent extent_{}, cells_{};
  std::vector<std::uint32_t> counts_;
  std::vector<std::bitset<256>> classes_;  // of the vectors of each cell
  std::bitset<256> hidden_;                // by the transfer function of the stream
};

/// Returns the index of the voxel of each vector in the layout, x first.
[[nodiscard]] std::vector<std::uint32_t> voxels_of_vectors(const Volume& vectors, const VolumeLayout& layout);

/// Input of a choice of bricks.
struct BrickChoice {
  const BrickLayout& layout;
  std::span<const VolumeLayout> levels;  // layouts of the levels 0 to BrickLayout::base()
  const VectorShares& shares;
  std::span<const LodView> views;
  std::size_t most_bytes = 0;  // estimated memory of all bricks, with all that comes from them
};
/// Chooses the bricks that the views need, most wanted first. A view needs a brick inside of it if the next coarser
/// level is too coarse there, and if the brick has vectors or touches a slice. Bricks come first where the coarser
/// voxels are larger on the screen. Slices count as larger, and parts without visible vectors as smaller. Bricks
/// with a point of VolumeNeeds come before all others, down to the finest level. Each brick follows its parent.
[[nodiscard]] std::vector<BrickName> choose_bricks(const BrickChoice& choice);

/// Reports whether a slice goes through a box, or is at most `margin` away.
[[nodiscard]] bool touches_slice(const Box& box, float margin, const VolumeNeeds& needs);

/// Returns the estimated memory of a brick: its samples, coefficients and vectors, and the copies of these for drawing.
[[nodiscard]] std::size_t brick_bytes(const BrickLayout& layout, const BrickName& name, double share);

/// Returns the bounds of samples, in the coordinates of the views. `level` is the layout of their level.
[[nodiscard]] Box samples_box(const SampleBox& samples, const VolumeLayout& level);
/// Returns the bounds of a brick, in the coordinates of the views. `level` is the layout of its level.
[[nodiscard]] Box brick_box(const BrickLayout& layout, const BrickName& name, const VolumeLayout& level);

}  // namespace gs::qnv::values
