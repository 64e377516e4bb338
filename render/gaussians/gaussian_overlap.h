#pragma once

#include "qnv/base/geometry.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/scene/camera.h"
#include "render/scene/render_list.h"
#include "render/splat/software/splat_raster.h"
#include "render/volume/layers_together.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <span>
#include <vector>

namespace gs::render {

/// Returns true if the Gaussians of a list are behind its volumes, as seen from `eye` in world space. If a plane across
/// an axis separates their boxes, the volumes must be on the side of the eye. Otherwise the box with the nearer centre
/// is in front. Returns false if Gaussians or volumes are missing.
[[nodiscard]] bool are_gaussians_behind_volumes(const RenderList& list, const glm::dvec3& eye);
/// Reports whether the box of any Gaussians overlaps that of any volume in world space.
[[nodiscard]] bool do_boxes_of_gaussians_and_volumes_overlap(const RenderList& list);

/// Bounds of a volume in its own space.
struct VolumeBox {
  Box box;
  glm::mat4 camera_from_node{1.0f};
};
/// Returns the boxes of all volumes of a list.
[[nodiscard]] std::vector<VolumeBox> volume_boxes(const RenderList& list, const Camera& camera);

/// Returns the depths of Gaussians with centres in view and inside of a volume's box, from a sample of at most 65,536.
/// The number of slabs grows with the size of the region of these centres in the picture. Returns nullopt if there are
/// none. Accepts any numbers.
[[nodiscard]] std::optional<SharedDepths> shared_depths(std::span<const GaussianItem> items,
                                                        std::span<const VolumeBox> volumes, const SplatView& view);

}  // namespace gs::render
