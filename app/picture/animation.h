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

inline constexpr double kTurntableSeconds = 8, kTourSeconds = 3;  // usual: once around; from one Viewpoint to the next
inline constexpr std::size_t kMostPictures = 100'000;             // of an animation

/// One picture of an animation.
struct AnimationStep {
  double time = 0;                  // of the world, seconds from its start
  double turned = 0;                // of a turntable: radians about the up axis
  std::optional<std::size_t> from;  // of a tour: the Viewpoint that it comes from, in the order of the request,
  double part = 0;                  // and how far it is on the way to the next, 0..1
};

/// The pictures of a request, at least one; a message where there would be too many, or nothing is to move.
/// A turntable does not repeat its first picture at the end, so that it can go on and on. The world's time goes on with
/// a turntable or tour where `times` says so, evenly.
[[nodiscard]] std::optional<std::string> plan_animation(const AnimationRequest& request,
                                                        std::vector<AnimationStep>& steps);

/// The camera turned about an axis through `center`: who stands still and lets things turn, to the right as seen from
/// above for angles above 0, goes to the left himself.
[[nodiscard]] render::Camera turned_camera(render::Camera camera, const glm::dvec3& center, const glm::dvec3& up,
                                           double angle);
/// On the way from one to the other, which begins and ends gently.
[[nodiscard]] render::Camera camera_between(const render::Camera& from, const render::Camera& to, double part);

}  // namespace gs::app
