#pragma once

#include "qnv/base/cloud.h"
#include "render/volume/volume_model.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

namespace gs::render {

/// A half line of world space that looks for clouds.
struct PickRay {
  glm::dvec3 origin{0};
  glm::vec3 direction{0, 0, -1};                            // of unit length
  float pixel = 0.001f;                                     // how wide a pixel of the picture is at distance 1
  float farthest = std::numeric_limits<float>::infinity();  // what lies beyond is not looked for
};

/// What a ray looks at, at the most, of one cloud.
struct PickLimits {
  std::size_t vectors = std::size_t{1} << 23;        // of a cloud that has more, the first ones, grown, stand for all
  std::size_t level_vectors = std::size_t{1} << 18;  // of a cloud with levels: of the cut along the ray
  unsigned threads = 0;
};

/// The nearest disc of a surface that a ray meets.
struct DiscPick {
  float distance = 0;              // world units
  std::optional<qnv::Rgb8> color;  // of the disc itself; nothing: it has that of the cloud
};

/// The distance, world units, at which the ray meets the nearest disc of a surface, and the disc's colour: what a
/// sample of the picture shows there by the definition of raycast_surface, with discs no smaller than they would be
/// drawn. Discs that show their back count only where the cloud is two-sided. The cloud is a surface under any affine
/// matrix; nothing when its arrays do not fit together or the matrix is singular.
///
/// Of a cloud with levels the cut along the ray is decoded, as LodStream::cut does for the viewport kPickViewport: on
/// the thread that draws it. Else every disc is looked at: about 6 ns each. Safe for any numbers.
[[nodiscard]] std::optional<DiscPick> pick_disc(const qnv::Cloud& cloud, const glm::dmat4& world_from_node,
                                                const PickRay& ray, const PickLimits& limits = {});
/// The distance alone.
[[nodiscard]] inline std::optional<float> pick_surface(const qnv::Cloud& cloud, const glm::dmat4& world_from_node,
                                                       const PickRay& ray, const PickLimits& limits = {}) {
  const auto hit = pick_disc(cloud, world_from_node, ray, limits);
  return hit ? std::optional(hit->distance) : std::nullopt;
}
inline constexpr std::uint32_t kPickViewport = 0xFFFFFFFF;

/// Where a ray meets a volume.
struct VolumePick {
  float distance = 0;  // world units: where half of the light is taken, or half of what is taken at all
  float opacity = 0;   // of the volume along the whole ray, 0..1
};

/// The place of a volume at which what lies in front of it takes half of the light (equation (1) of the paper, with
/// the opacities of `model` and `options`; `options.clip` is in node space), seen along the ray: discs that face the
/// ray, while the picture has discs that face the camera. Where the whole ray takes less than half the light, the place
/// that halves what it takes. Nothing where it takes less than one part in a hundred. Safe for any numbers.
[[nodiscard]] std::optional<VolumePick> pick_volume(const qnv::Cloud& cloud, const VolumeModel& model,
                                                    const VolumeOptions& options, const glm::dmat4& world_from_node,
                                                    const PickRay& ray, const PickLimits& limits = {});

}  // namespace gs::render
