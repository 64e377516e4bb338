#include "app/picture/animation.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gs::app {

std::optional<std::string> plan_animation(const AnimationRequest& request, std::vector<AnimationStep>& steps) {
  const double legs = request.tour.empty() ? 0 : static_cast<double>(request.tour.size() - 1);
  if (!request.turntable && request.tour.size() < 2 && !request.times)
    return "nothing would move; expected --turntable, --during FROM..TO, or --tour with two Viewpoints or more";
  if (request.turntable && !request.tour.empty()) return "expected --turntable or --tour, not both";
  double seconds = request.times ? request.times->second - request.times->first : 0;
  if (request.turntable) seconds = request.length > 0 ? request.length : request.times ? seconds : kTurntableSeconds;
  if (legs > 0) seconds = legs * (request.length > 0 ? request.length : kTourSeconds);
  const double wanted =
      request.pictures > 0 ? static_cast<double>(request.pictures) : std::round(seconds * request.rate);
  if (!(wanted <= static_cast<double>(kMaxPictures)))
    return "an animation has at most " + std::to_string(kMaxPictures) + " pictures";
  const auto count = static_cast<std::size_t>(std::max(wanted, 1.0));
  steps.clear();
  for (std::size_t i = 0; i < count; ++i) {
    AnimationStep step;
    const double all = static_cast<double>(count), place = static_cast<double>(i);
    if (request.times) step.time = request.times->first + (request.times->second - request.times->first) * place / all;
    if (request.turntable) step.turned = 2 * std::numbers::pi * place / all;
    if (legs > 0) {
      const double at = count > 1 ? legs * place / (all - 1) : 0;  // the last picture is at the last Viewpoint
      const double leg = std::min(std::floor(at), legs - 1);
      step.from = static_cast<std::size_t>(leg);
      step.part = at - leg;
    }
    steps.push_back(step);
  }
  return std::nullopt;
}

render::Camera turned_camera(render::Camera camera, const glm::dvec3& center, const glm::dvec3& up, double angle) {
  glm::dmat4 turn = glm::translate(glm::dmat4(1), center);
  turn = glm::rotate(turn, -angle, up);
  turn = glm::translate(turn, -center);
  camera.world_from_camera = turn * camera.world_from_camera;
  return camera;
}

render::Camera camera_between(const render::Camera& from, const render::Camera& to, double part) {
  part = std::clamp(part, 0.0, 1.0);
  const double eased = part * part * (3 - 2 * part);
  const glm::dquat turn = glm::slerp(glm::quat_cast(glm::dmat3(from.world_from_camera)),
                                     glm::quat_cast(glm::dmat3(to.world_from_camera)), eased);
  render::Camera camera = from;
  camera.world_from_camera = glm::dmat4(glm::mat3_cast(turn));
  camera.world_from_camera[3] = glm::mix(from.world_from_camera[3], to.world_from_camera[3], eased);
  camera.height = glm::mix(from.height, to.height, eased);
  camera.field_of_view = glm::mix(from.field_of_view, to.field_of_view, static_cast<float>(eased));
  return camera;
}

}  // namespace gs::app
