#pragma once

#include "app/view/values/slices.h"
#include "app/view/values/volume_display.h"
#include "app/view/values/volume_grid.h"
#include "base/parallel.h"
#include "qnv/base/geometry.h"
#include "render/scene/volume_look.h"
#include "vrml/mesh/mesh.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

/// Functions that compute content from the values of a volume. Any thread may call them. They return a message if there
/// is not enough memory, or if `progress` is cancelled. A null `progress` means that they cannot be cancelled.
namespace gs::app {

template <class Content>
using DerivedContent = std::variant<std::shared_ptr<const Content>, std::string>;

/// Maximum number of triangles of isosurface_mesh().
inline constexpr std::size_t kMostSurfaceTriangles = std::size_t{1} << 23;
/// Returns the isosurface of a grid in the space of the volume, with shared vertices. Uses every
/// `stride`th voxel. Doubles the stride while there are more than `most_triangles`.
[[nodiscard]] DerivedContent<vrml::Mesh> isosurface_mesh(const std::shared_ptr<const VolumeGrid>& grid, float isovalue,
                                                         const WorldBudget& budget, Progress* progress = nullptr,
                                                         std::size_t most_triangles = kMostSurfaceTriangles,
                                                         std::uint32_t stride = 1);

/// Returns the stride for an isosurface that takes little time to compute and to draw.
[[nodiscard]] std::uint32_t draft_stride(const VolumeGrid& grid);

/// Projection of the values along rays, for DrawItem::volume.
struct VolumeProjection {
  std::shared_ptr<const render::VolumeLook> look;
  glm::dmat4 volume_from_box{1.0};  // from the box of all volumes, -0.5 to 0.5, to the space of the volume
};
/// Colours of a projection.
struct ProjectionColors {
  VolumeMode mode = VolumeMode::maximum;
  std::optional<std::pair<float, float>> window;  // values of the first and last colour; nullopt means the full range
  std::string map;                                // name of a colour map
  friend bool operator==(const ProjectionColors&, const ProjectionColors&) = default;
};
/// Maximum number of voxels of projection_of(). It leaves out voxels of larger volumes.
inline constexpr std::size_t kMostProjectedVoxels = std::size_t{1} << 25;
/// Returns a projection of a grid. Low values of a maximum or an average are transparent.
[[nodiscard]] DerivedContent<VolumeProjection> projection_of(const VolumeGrid& grid, const ProjectionColors& colors,
                                                             const WorldBudget& budget,
                                                             std::size_t most_voxels = kMostProjectedVoxels);

/// Returns the gradient vectors of a share of the voxels, with all other properties of the volume `of`.
[[nodiscard]] DerivedContent<qnv::Geometry> vectors_of_share(const std::shared_ptr<const VolumeGrid>& grid,
                                                             const qnv::Volume& of, float share,
                                                             const WorldBudget& budget, Progress* progress = nullptr);

}  // namespace gs::app
