#pragma once

#include "qnv/base/geometry.h"
#include "render/volume/volume_model.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

namespace gs::render {

/// Half line in world space for picking splats and volumes.
struct PickRay {
  glm::dvec3 origin{0};
  glm::vec3 direction{0, 0, -1};                            // unit length
  float pixel = 0.001f;                                     // width of an image pixel at distance 1
  float farthest = std::numeric_limits<float>::infinity();  // maximum distance of a hit
};

/// Limits of the work for one ray, per geometry.
struct PickLimits {
  std::size_t vectors = std::size_t{1} << 23;  // of a larger geometry, the first vectors represent all
  std::size_t level_vectors = std::size_t{1} << 18;  // geometries with levels: maximum vectors of a cut
  unsigned threads = 0;
};

/// Nearest hit of a ray on the splats of a surface.
struct DiscPick {
  float distance = 0;  // distance in world units
  std::optional<qnv::Rgb8> color;  // colour of the splat; nullopt means that the geometry has no colours per vector
};

/// Returns the nearest splat of a surface on the ray. It is the splat that an image sample shows, by the definition in
/// tests/render/rays/raycast.h. Small splats are enlarged as in images. Back faces can be hit only if the geometry is
/// two-sided.
///
/// If the geometry has levels, decodes the cut along the ray, like LodStream::cut for the viewport kPickViewport. Call
/// it on the drawing thread. Otherwise, tests all splats, in about 6 ns each.
///
/// Accepts any numbers and any affine matrix. Returns nullopt if the arrays of the geometry are inconsistent or the
/// matrix is singular.
[[nodiscard]] std::optional<DiscPick> pick_disc(const qnv::Geometry& geometry, const glm::dmat4& world_from_node,
                                                const PickRay& ray, const PickLimits& limits = {});
inline constexpr std::uint32_t kPickViewport = 0xFFFFFFFF;

/// Hit of a ray on a volume.
struct VolumePick {
  float distance = 0;  // world units: depth where half of the light, or half of the total absorption, is absorbed
  float opacity = 0;  // opacity of the volume along the whole ray, 0 to 1
};

/// Returns the depth in a volume at which half of the light is absorbed, by equation (1) of the paper. If the whole ray
/// absorbs less than half, returns the depth at half of the total absorption. Returns nullopt if it absorbs less than
/// one percent.
///
/// Opacities are those of `model` and `options`; `options.clip` is in node space. Splats face the ray here; in images
/// they face the camera. Accepts any numbers.
[[nodiscard]] std::optional<VolumePick> pick_volume(const qnv::Volume& volume, const VolumeModel& model,
                                                    const VolumeOptions& options, const glm::dmat4& world_from_node,
                                                    const PickRay& ray, const PickLimits& limits = {});

}  // namespace gs::render
