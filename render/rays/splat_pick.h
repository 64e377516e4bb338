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

/// Work limits of a ray per point set.
struct PickLimits {
  std::size_t vectors = std::size_t{1} << 23;        // for larger point sets, the first ones, enlarged, represent all
  std::size_t level_vectors = std::size_t{1} << 18;  // point sets with levels: size of the cut along the ray
  unsigned threads = 0;
};

/// Nearest splat of a surface hit by a ray.
struct DiscPick {
  float distance = 0;              // world units
  std::optional<qnv::Rgb8> color;  // of the splat itself; nullopt means that of the point set
};

/// Returns the nearest splat of a surface on the ray: the distance in world units, and the splat's colour. The hit is
/// the one that an image sample shows by the definition in tests/render/rays/raycast.h, with splats no smaller than
/// drawn ones. Back-facing splats count only if the point set is two-sided. Accepts any affine matrix; returns nullopt
/// if the point set's arrays are inconsistent or the matrix is singular.
///
/// For a point set with levels it decodes the cut along the ray, like LodStream::cut for the viewport kPickViewport;
/// call it on the drawing thread. Otherwise it tests every splat in about 6 ns. Accepts any numbers.
[[nodiscard]] std::optional<DiscPick> pick_disc(const qnv::Geometry& geometry, const glm::dmat4& world_from_node,
                                                const PickRay& ray, const PickLimits& limits = {});
/// Returns only the distance.
[[nodiscard]] inline std::optional<float> pick_surface(const qnv::Geometry& geometry, const glm::dmat4& world_from_node,
                                                       const PickRay& ray, const PickLimits& limits = {}) {
  const auto hit = pick_disc(geometry, world_from_node, ray, limits);
  return hit ? std::optional(hit->distance) : std::nullopt;
}
inline constexpr std::uint32_t kPickViewport = 0xFFFFFFFF;

/// Hit of a ray on a volume.
struct VolumePick {
  float distance = 0;  // world units: where half of the light, or half of the total absorption, is absorbed
  float opacity = 0;   // of the volume along the whole ray, 0..1
};

/// Returns the point of a volume before which half of the light is absorbed, by equation (1) of the paper. Opacities
/// are those of `model` and `options`; `options.clip` is in node space. Splats face the ray here, and the camera in
/// images. If the whole ray absorbs less than half, it returns the point at half of the total absorption; nullopt below
/// one percent. Accepts any numbers.
[[nodiscard]] std::optional<VolumePick> pick_volume(const qnv::Volume& volume, const VolumeModel& model,
                                                    const VolumeOptions& options, const glm::dmat4& world_from_node,
                                                    const PickRay& ray, const PickLimits& limits = {});

}  // namespace gs::render
