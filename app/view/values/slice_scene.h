#pragma once

#include "app/view/values/slices.h"
#include "app/view/values/volume_grid.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace gs::app {

/// The plane of voxels that a slice shows, of the file's.
[[nodiscard]] std::uint32_t slice_voxel(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis);
/// The corners of that plane, in the volume's space, from one to the next around it.
[[nodiscard]] std::array<glm::dvec3, 4> slice_corners(const VolumeGrid& grid, const VolumeSlices& slices,
                                                      std::size_t axis);
/// Its picture: a pixel a voxel that is kept, the first axis across it to the right, the second one upwards, of x, y
/// and z but the slice's own. RGB, RGBA where values are missing, which are transparent.
[[nodiscard]] render::Image slice_image(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis);

/// What a world's list shows with slices of its volume: planes, seen from both sides, with edges of their own colours;
/// without the volume where that is wanted. Keeps what did not change. One thread.
class SliceScene {
 public:
  /// `list`, or one like it that lives until the next call. `grid` null: it is not there yet.
  const render::RenderList& with_slices(const render::RenderList& list, const std::shared_ptr<const VolumeGrid>& grid,
                                        const VolumeSlices& slices);

 private:
  const render::RenderList* of_ = nullptr;
  std::uint64_t generation_ = 0, changes_ = 0;
  std::size_t items_ = 0;
  std::shared_ptr<const VolumeGrid> grid_;
  VolumeSlices slices_;
  glm::dmat4 world_from_node_{0.0};
  std::array<std::shared_ptr<const render::Image>, 3> images_;
  render::RenderList list_;
};

/// Where a volume's space is in the world: of the first volume of the list; nothing where it has none.
[[nodiscard]] std::optional<glm::dmat4> world_from_volume(const render::RenderList& list);

}  // namespace gs::app
