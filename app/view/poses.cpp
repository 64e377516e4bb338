#include "app/view/navigation.h"
#include "base/finite.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

// Functions about viewer poses: views that show whole objects, and projections.
namespace gs::app {
namespace {


constexpr float kHalfTurn = std::numbers::pi_v<float>;
constexpr glm::vec3 kWorldUp(0, 1, 0);  // up direction of a world (VRML97 4.4.5)
constexpr double kLowest = 1e-9;  // world units; min height of a parallel projection

glm::vec3 unit_vector(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return finite(length) && length > 1e-6f ? v / length : otherwise;
}

// Rotates a pose about the origin of the world.
Pose turned(Pose pose, const glm::dmat3& rotation) {
  if (rotation == glm::dmat3(1)) return pose;
  pose.position = rotation * pose.position;
  pose.orientation = glm::quat(glm::quat_cast(rotation) * glm::dquat(pose.orientation));
  return pose;
}

WideBox turned(const WideBox& bounds, const glm::dmat3& rotation) {
  if (bounds.empty() || rotation == glm::dmat3(1)) return bounds;
  WideBox result;
  for (int i = 0; i < 8; ++i)
    result.add(glm::dvec3(rotation * glm::dvec3(i & 1 ? bounds.upper.x : bounds.lower.x,
                                                i & 2 ? bounds.upper.y : bounds.lower.y,
                                                i & 4 ? bounds.upper.z : bounds.lower.z)));
  return result;
}

/// Returns a pose that shows all of `bounds` from an azimuth and elevation in radians. Keeps the field of view and the
/// kind of projection of `pose`.
Pose fitted(const Pose& pose, const WideBox& bounds, const glm::vec2& viewport, const Upright& upright, float azimuth,
            float elevation) {
  if (bounds.empty()) return pose;
  const render::Camera camera = orbit_camera_of(bounds, azimuth, elevation, pose.field_of_view, viewport, upright);
  Pose to = pose_of(camera.world_from_camera, camera.field_of_view);
  if (pose.height > 0) to.height = fitting_height(camera, bounds, viewport);
  return valid_pose(to, pose);
}

glm::vec2 pointer_part(const glm::vec2& pointer, const glm::vec2& size, float unit) {
  const glm::vec2 part = (pointer - size * 0.5f) / unit;
  return finite(part) ? glm::clamp(part, glm::vec2(-1e4f), glm::vec2(1e4f)) : glm::vec2(0);
}

}  // namespace

Pose valid_pose(Pose pose, const Pose& otherwise) {
  if (!finite(pose.position)) pose.position = otherwise.position;
  pose.position = glm::clamp(pose.position, glm::dvec3(-kFarthest), glm::dvec3(kFarthest));
  const float length = glm::length(pose.orientation);
  pose.orientation = finite(pose.orientation) && length > 1e-3f ? pose.orientation / length : otherwise.orientation;
  if (!finite(pose.field_of_view)) pose.field_of_view = otherwise.field_of_view;
  pose.field_of_view = std::clamp(pose.field_of_view, 0.001f, kHalfTurn - 0.01f);
  if (!std::isfinite(pose.height) || pose.height < 0) pose.height = otherwise.height;
  if (pose.height > 0) pose.height = std::clamp(pose.height, kLowest, kFarthest);
  return pose;
}

render::Camera orbit_camera_of(const WideBox& bounds, float azimuth, float elevation, float field_of_view,
                               const glm::vec2& viewport, const Upright& upright) {
  const glm::dmat3 world_from_own = world_from_upright(upright);
  render::Camera camera = render::orbit_camera(turned(bounds, glm::transpose(world_from_own)), azimuth, elevation,
                                               field_of_view, std::max(viewport.x, 1.0f), std::max(viewport.y, 1.0f));
  if (upright != Upright{}) camera.world_from_camera = glm::dmat4(world_from_own) * camera.world_from_camera;
  return camera;
}

double fitting_height(const render::Camera& camera, const WideBox& bounds, const glm::vec2& viewport) {
  constexpr double kAir = 1.05;
  return kAir * render::parallel_height(camera, bounds, viewport.x, viewport.y);
}

Pose pose_that_fits(const Pose& given, const WideBox& whole, const glm::vec2& viewport, const glm::vec3& up) {
  if (whole.empty()) return given;
  const Upright upright = upright_along(up);
  const Pose pose = turned(given, glm::transpose(world_from_upright(upright)));
  const glm::vec3 back = -pose.forward();
  const glm::vec3 heading = std::abs(back.y) > 0.999f ? pose.up() * (back.y > 0 ? -1.0f : 1.0f) : back;
  const float azimuth = std::atan2(heading.x, heading.z);
  const float elevation = std::asin(std::clamp(back.y, -1.0f, 1.0f));
  return fitted(given, whole, viewport, upright, azimuth, elevation);
}

Pose pose_at_side(ViewSide side, const Pose& pose, const WideBox& bounds, const glm::vec2& viewport,
                  const Upright& upright) {
  struct Place {
    float azimuth, elevation;
  };
  static constexpr Place kPlaces[kSideCount] = {
      {0, 0}, {kHalfTurn, 0}, {-kHalfTurn / 2, 0}, {kHalfTurn / 2, 0}, {0, kHalfTurn / 2}, {0, -kHalfTurn / 2}};
  const Place place = kPlaces[static_cast<int>(side)];
  return fitted(pose, bounds, viewport, upright, place.azimuth, place.elevation);
}

Pose straightened(const Pose& pose, const glm::vec3& up) {
  const glm::vec3 ahead = pose.forward(), side = glm::cross(ahead, up);
  if (glm::length(side) < 1e-3f) return pose;
  const glm::vec3 right = glm::normalize(side);
  Pose level = pose;
  level.orientation = glm::quat_cast(glm::mat3(right, glm::cross(right, ahead), -ahead));
  return valid_pose(level, pose);
}

Pose first_pose(const WideBox& bounds, const glm::vec2& viewport, const Upright& upright) {
  const Pose pose;
  if (bounds.empty()) return pose;
  constexpr float kFromRight = 0.6f, kFromAbove = 0.5f;
  if (upright.three_quarter) return fitted(pose, bounds, viewport, upright, kFromRight, kFromAbove);
  const glm::dmat3 world_from_own = world_from_upright(upright);
  const render::Camera camera = render::first_camera(turned(bounds, glm::transpose(world_from_own)), pose.field_of_view,
                                                     std::max(viewport.x, 1.0f), std::max(viewport.y, 1.0f));
  return valid_pose(turned(pose_of(camera.world_from_camera, camera.field_of_view), world_from_own), pose);
}

Pose pose_of(const glm::dmat4& world_from_camera, float field_of_view) {
  Pose pose;
  pose.position = glm::dvec3(world_from_camera[3]);
  const glm::vec3 back = unit_vector(glm::vec3(world_from_camera[2]), glm::vec3(0, 0, 1));
  const glm::vec3 up = glm::vec3(world_from_camera[1]);
  const glm::vec3 sideways = std::abs(back.y) < 0.9f ? kWorldUp : glm::vec3(0, 0, -1);
  const glm::vec3 right =
      unit_vector(glm::cross(up, back), unit_vector(glm::cross(sideways, back), glm::vec3(1, 0, 0)));
  pose.orientation = glm::quat_cast(glm::mat3(right, glm::cross(back, right), back));
  pose.field_of_view = field_of_view;
  return valid_pose(pose, Pose{});
}

glm::dmat4 world_from_viewer(const Pose& pose) {
  glm::dmat4 matrix(glm::mat4_cast(glm::dquat(pose.orientation)));
  matrix[3] = glm::dvec4(pose.position, 1);
  return matrix;
}

render::Camera camera_of(const Pose& pose) {
  render::Camera camera;
  camera.world_from_camera = world_from_viewer(pose);
  camera.field_of_view = pose.field_of_view;
  camera.height = pose.height;
  return camera;
}

Pose with_parallel_rays(Pose pose, bool parallel, double distance) {
  const double tangent = std::tan(double{pose.field_of_view} / 2);
  if (parallel && pose.height <= 0) pose.height = 2 * distance * tangent;
  if (!parallel && pose.height > 0) {
    // Move to the position from which objects at `distance` keep their size in perspective.
    pose.position += glm::dvec3(pose.forward()) * (distance - pose.height / (2 * tangent));
    pose.height = 0;
  }
  return valid_pose(pose, pose);
}

double height_that_shows(const glm::dvec2& extent, const glm::vec2& viewport) {
  return render::height_for(extent, glm::dvec2(viewport));
}

float pixel_along_ray(const Pose& pose, const glm::vec2& size) {
  const float pixels = std::max(1.0f, std::min(size.x, size.y));
  if (pose.height > 0) return static_cast<float>(1 / (kParallelReach * double{pixels}));
  return 2 * std::tan(pose.field_of_view / 2) / pixels;
}

render::Camera viewpoint_camera(const render::RenderList& list, const vrml::Node* bound, const glm::vec2& size) {
  render::Camera camera;
  auto viewpoint = std::find_if(list.viewpoints.begin(), list.viewpoints.end(),
                                [&](const auto& candidate) { return &candidate.scene->node(candidate.node) == bound; });
  if (viewpoint == list.viewpoints.end()) viewpoint = list.viewpoints.begin();
  if (viewpoint == list.viewpoints.end() && list.default_extent.x > 0) {
    camera.world_from_camera[3] = {0, 0, 10, 1};
    camera.height = height_that_shows(list.default_extent, size);
    return camera;
  }
  if (viewpoint == list.viewpoints.end())
    return render::first_camera(list.bounds, camera.field_of_view, size.x, size.y);
  camera.world_from_camera = viewpoint->world_from_camera;
  camera.field_of_view = viewpoint->field_of_view;
  if (viewpoint->extent.x > 0) camera.height = height_that_shows(viewpoint->extent, size);
  return camera;
}

Ray ray_through(const Pose& pose, const glm::vec2& pointer, const glm::vec2& size) {
  const float unit = std::max(1.0f, std::min(size.x, size.y)) / 2;
  const glm::vec2 part = pointer_part(pointer, size, unit);
  if (pose.height > 0) {
    const glm::dvec3 aside(part.x * pose.height / 2, -part.y * pose.height / 2, kParallelReach * pose.height);
    return {pose.position + glm::dquat(pose.orientation) * aside, pose.forward()};
  }
  const glm::vec2 place = part * std::tan(pose.field_of_view / 2);
  const glm::vec3 direction = pose.orientation * glm::vec3(place.x, -place.y, -1);
  return {pose.position, unit_vector(direction, pose.forward())};
}

std::optional<glm::vec2> pixel_that_sees(const Pose& pose, const glm::dvec3& place, const glm::vec2& size) {
  const glm::dvec3 seen = glm::conjugate(glm::dquat(pose.orientation)) * (place - pose.position);
  if (pose.height <= 0 && !(seen.z < 0)) return std::nullopt;
  const double half =
      pose.height > 0 ? pose.height / 2 : -seen.z * std::tan(double{pose.field_of_view} / 2);  // half the smaller side
  const double unit = std::max(1.0, static_cast<double>(std::min(size.x, size.y))) / 2 / half;
  return glm::vec2(static_cast<double>(size.x) / 2 + seen.x * unit, static_cast<double>(size.y) / 2 - seen.y * unit);
}

}  // namespace gs::app
