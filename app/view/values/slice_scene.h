#pragma once

#include "app/view/values/slices.h"
#include "app/view/values/volume_grid.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace gs::app {

/// Returns the index of the voxel plane that a slice shows, in voxels of the file.
[[nodiscard]] std::uint32_t slice_voxel(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis);
/// Returns the corners of that plane in the volume's space, in order around it.
[[nodiscard]] std::array<glm::dvec3, 4> slice_corners(const VolumeGrid& grid, const VolumeSlices& slices,
                                                      std::size_t axis);
/// Returns the picture of that plane, one pixel per kept voxel. Of the two other axes, the first points right and the
/// second up. RGB, or RGBA with transparency if values are missing.
[[nodiscard]] render::Image slice_image(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis);

/// Render list of a world with slices of its volume added: planes visible from both sides, with coloured edges.
/// Optionally omits the volume itself. Reuses unchanged parts. Use from one thread.
class SliceScene {
 public:
  /// Returns `list`, or a changed copy that is valid until the next call. A null `grid` means that it is not loaded
  /// yet.
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

/// Returns the world transform of the first volume in the list; nullopt if there is none.
[[nodiscard]] std::optional<glm::dmat4> world_from_volume(const render::RenderList& list);

}  // namespace gs::app
