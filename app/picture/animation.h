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

inline constexpr double kTurntableSeconds = 8, kTourSeconds = 3;  // defaults: for one turn, and between two Viewpoints
inline constexpr std::size_t kMaxPictures = 100'000;              // max pictures in an animation

/// One picture of an animation.
struct AnimationStep {
  double time = 0;                  // world time, in seconds from the start
  double turned = 0;  // angle of the turntable about the up axis, in radians
  std::optional<std::size_t> from;  // tour only: index of the last Viewpoint reached, in AnimationRequest::tour
  double part = 0;  // fraction of the way to the next Viewpoint, 0 to 1
};

/// Plans the pictures of a request, at least one, into `steps`. Returns a message if the request has too many pictures,
/// or if nothing would move. A turntable can loop: it omits the last picture, which would equal the first. With
/// AnimationRequest::times, world time also advances during a turntable or tour.
[[nodiscard]] std::optional<std::string> plan_animation(const AnimationRequest& request,
                                                        std::vector<AnimationStep>& steps);

/// Rotates the camera about the axis `up` through `center`. In the picture, the objects seem to turn in front of a
/// fixed camera. A positive angle, in radians, turns them counterclockwise as seen from above.
[[nodiscard]] render::Camera turned_camera(render::Camera camera, const glm::dvec3& center, const glm::dvec3& up,
                                           double angle);
/// Interpolates between two cameras, with smooth start and end. `part` is 0 at `from` and 1 at `to`.
[[nodiscard]] render::Camera camera_between(const render::Camera& from, const render::Camera& to, double part);

}  // namespace gs::app
