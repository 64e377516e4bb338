#pragma once

#include "app/picture/animation_request.h"
#include "app/view/navigation.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

inline constexpr double kTurntableSeconds = 8, kTourSeconds = 3;  // defaults: one turn; between Viewpoints
inline constexpr std::size_t kMaxPictures = 100'000;              // max pictures in an animation

/// One picture of an animation.
struct AnimationStep {
  double time = 0;                  // world time, in seconds from the start
  double turned = 0;                // turntable angle about the up axis, radians
  std::optional<std::size_t> from;  // tour: index of the previous Viewpoint in the request
  double part = 0;                  // fraction of the way to the next Viewpoint, 0..1
};

/// Plans the pictures of a request, at least one. Returns a message if there are too many, or if nothing would move. A
/// turntable does not repeat its first picture at the end, so that it loops. If `times` is set, world time advances
/// evenly during a turntable or tour.
[[nodiscard]] std::optional<std::string> plan_animation(const AnimationRequest& request,
                                                        std::vector<AnimationStep>& steps);

/// Rotates the camera about an axis through `center`, as if the objects turned in front of a fixed camera. Positive
/// angles turn the objects counterclockwise as seen from above.
[[nodiscard]] render::Camera turned_camera(render::Camera camera, const glm::dvec3& center, const glm::dvec3& up,
                                           double angle);
/// Interpolates between two cameras, with smooth acceleration and deceleration.
[[nodiscard]] render::Camera camera_between(const render::Camera& from, const render::Camera& to, double part);

}  // namespace gs::app
