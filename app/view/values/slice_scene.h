#pragma once

#include "app/view/values/slices.h"
#include "app/view/values/volume_grid.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gs::app {

/// Returns the voxel plane that a slice shows, in voxels of the grid. It is a plane of voxels of the whole volume, or
/// of those in memory if the grid omits some.
[[nodiscard]] double slice_voxel(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis);
/// Returns the corners of the plane that a slice shows, in the volume's space, in order around the plane.
[[nodiscard]] std::array<glm::dvec3, 4> slice_corners(const VolumeGrid& grid, const VolumeSlices& slices,
                                                      std::size_t axis);
/// Returns the planes that the slices show, in world space.
[[nodiscard]] std::vector<glm::dvec4> slice_planes(const VolumeGrid& grid, const VolumeSlices& slices,
                                                   const glm::dmat4& world_from_node);
/// Makes the picture of a slice, with one pixel for each voxel in memory. Of the two other axes, the first points to
/// the right and the second upwards. The picture is RGB; if values are missing, it is RGBA and transparent there.
/// Colours are RGBA, unless another colour map than the first one is chosen.
[[nodiscard]] render::Image slice_image(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis);

/// Copy of a world's render list with slices of its volume. A slice is a textured plane that is visible from both
/// sides, with coloured edges. The volume itself may be omitted. Unchanged parts are reused. One thread.
class SliceScene {
 public:
  /// Returns `list` itself if no slice is visible; otherwise a changed copy, which is valid until the next call. A null
  /// `grid` means that the values are not loaded yet.
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

/// Returns the values of the first volume in the list, if its stream has them; else null.
[[nodiscard]] std::shared_ptr<const qnv::VolumeValues> streamed_values(const render::RenderList& list);

/// Omits the volumes of a list. Those with finer detail for views stay, without being visible, so that their values
/// become finer.
void hide_volumes(render::RenderList& list);

/// Returns a number that changes when other threads have decoded finer vectors of the volumes in the list.
[[nodiscard]] std::uint64_t detail_revision(const render::RenderList& list);

/// Returns the transformation from the space of the first volume in the list to world space; nullopt if the list has no
/// volume.
[[nodiscard]] std::optional<glm::dmat4> world_from_volume(const render::RenderList& list);

}  // namespace gs::app
