#include "render/scene/camera.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gs::render {
namespace {

constexpr float kDefaultFieldOfView = 0.785398f;
constexpr float kMinAngle = 1e-7f;  // minimum angle of view of far_camera(), radians
constexpr double kFrameMargin = 1.05;  // distance factor that leaves a margin around the bounds
constexpr double kDepthMargin = 0.01;  // margin of near and far plane, as a share of the depth range
// Maximum far / near: for 24-bit depth, and for reversed float depth, which works for any ratio.
constexpr double kLargestDepthRatio = 1e4, kLargestReversedRatio = 1e10;
constexpr float kDefaultNear = 0.1f, kDefaultFar = 1000.0f;

struct HalfAngles {
  double tan_x, tan_y;
};

HalfAngles half_angles(float field_of_view, float width, float height) {
  const float angle =
      field_of_view > 0 && std::isfinite(field_of_view) ? std::min(field_of_view, 3.13f) : kDefaultFieldOfView;
  const double smaller = std::tan(std::max(angle, kMinAngle) * 0.5);
  const double aspect = width > 0 && height > 0 ? static_cast<double>(width) / height : 1.0;
  return aspect >= 1 ? HalfAngles{smaller * aspect, smaller} : HalfAngles{smaller, smaller / aspect};
}

std::array<glm::dvec3, 8> corners(const WideBox& bounds) {
  std::array<glm::dvec3, 8> points;
  for (int i = 0; i < 8; ++i)
    points[i] = {i & 1 ? bounds.upper.x : bounds.lower.x, i & 2 ? bounds.upper.y : bounds.lower.y,
                 i & 4 ? bounds.upper.z : bounds.lower.z};
  return points;
}

}  // namespace

glm::dmat4 camera_from_world_of(const Camera& camera) {
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(camera.world_from_camera));
  glm::dmat4 matrix(rotation);
  matrix[3] = glm::dvec4(-(rotation * glm::dvec3(camera.world_from_camera[3])), 1);
  return matrix;
}

Camera whole_camera(const Camera& camera) {
  Camera whole = camera;
  whole.part = {};
  return whole;
}

glm::vec2 whole_size(const Camera& camera, const glm::vec2& size) {
  const PicturePart& part = camera.part;
  return {static_cast<float>(static_cast<double>(size.x) * 2 / (part.right - part.left)),
          static_cast<float>(static_cast<double>(size.y) * 2 / (part.top - part.bottom))};
}

Projection projection(const Camera& camera, float width, float height, bool reversed) {
  const PicturePart& part = camera.part;
  const glm::vec2 whole = whole_size(camera, {width, height});
  const HalfAngles angles = half_angles(camera.field_of_view, whole.x, whole.y);
  const double tan_x = angles.tan_x * (part.right - part.left) / 2, tan_y = angles.tan_y * (part.top - part.bottom) / 2;
  const double center_x = angles.tan_x * (part.left + part.right) / 2 + camera.shift;
  const double center_y = angles.tan_y * (part.bottom + part.top) / 2;
  const double near_plane = camera.near_plane, far_plane = camera.far_plane;
  const double range = far_plane - near_plane, product = far_plane * near_plane;
  Projection result;
  result.reversed = reversed;
  result.depth_offset = static_cast<float>(reversed ? -near_plane / range : far_plane / range);
  result.depth_scale = static_cast<float>((reversed ? product : -product) / range);
  glm::dmat4 clip_from_camera(0.0);
  clip_from_camera[0][0] = 1 / tan_x;
  clip_from_camera[1][1] = 1 / tan_y;
  clip_from_camera[2][0] = center_x / tan_x;
  clip_from_camera[2][1] = center_y / tan_y;
  clip_from_camera[2][2] = reversed ? near_plane / range : -(far_plane + near_plane) / range;
  clip_from_camera[2][3] = -1;
  clip_from_camera[3][2] = (reversed ? product : -2 * product) / range;
  result.clip_from_camera = glm::mat4(clip_from_camera);
  clip_from_camera[3] -= clip_from_camera[2] * camera.back;
  result.clip_from_viewer = glm::mat4(clip_from_camera);
  result.back = static_cast<float>(camera.back);
  return result;
}

Camera far_camera(const Camera& camera, const WideBox& bounds) {
  if (!(camera.height > 0)) return camera;
  Camera far = camera;
  double middle = 0, extent = camera.height;
  const glm::dvec3 eye(camera.world_from_camera[3]), forward(-camera.world_from_camera[2]);
  if (!bounds.empty()) {
    middle = glm::dot((glm::dvec3(bounds.lower) + glm::dvec3(bounds.upper)) * 0.5 - eye, forward);
    extent = std::max(extent, glm::length(glm::dvec3(bounds.upper) - glm::dvec3(bounds.lower)));
  }
  const double distance = extent / 2 / kFarParallax;
  far.world_from_camera[3] = glm::dvec4(eye + forward * (middle - distance), 1);
  far.field_of_view = static_cast<float>(2 * std::atan(camera.height / 2 / distance));
  far.back = distance - middle;
  if (far.far_plane > 0) far.far_plane += static_cast<float>(far.back);
  far.near_plane = 0;
  far.height = 0;
  return far;
}

float pixels_per_radian(float field_of_view, float width, float height) {
  return std::min(width, height) / (2 * std::tan(field_of_view / 2));
}

Camera orbit_camera(const WideBox& bounds, float azimuth, float elevation, float field_of_view, float width,
                    float height) {
  const double ca = std::cos(double{azimuth}), sa = std::sin(double{azimuth});
  const double ce = std::cos(double{elevation}), se = std::sin(double{elevation});
  const glm::dvec3 right(ca, 0, -sa), up(-sa * se, ce, -ca * se), back(sa * ce, se, ca * ce);
  const auto [tan_x, tan_y] = half_angles(field_of_view, width, height);

  glm::dvec3 center(0);
  double distance = 10;  // distance of the default Viewpoint in metres (VRML97 6.53)
  if (!bounds.empty()) {
    center = (glm::dvec3(bounds.lower) + glm::dvec3(bounds.upper)) * 0.5;
    distance = 0;
    for (const glm::dvec3& corner : corners(bounds)) {
      const glm::dvec3 p = corner - center;
      const double wanted = std::max(std::abs(glm::dot(p, right)) / tan_x, std::abs(glm::dot(p, up)) / tan_y);
      distance = std::max(distance, glm::dot(p, back) + wanted * kFrameMargin);
    }
    if (!(distance > 0)) distance = 1;  // the bounds are a single point
  }
  const glm::dvec3 eye = center + back * distance;
  Camera camera;
  camera.field_of_view = field_of_view;
  camera.world_from_camera =
      glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
  return camera;
}

Camera first_camera(const WideBox& bounds, float field_of_view, float width, float height) {
  constexpr float kFlat = 0.12f, kAside = 0.6f;
  const glm::vec3 size = bounds.empty() ? glm::vec3(1) : bounds.size();
  const bool lies = size.y <= kFlat * std::max(size.x, size.z) && size.z > kFlat * size.x;
  const bool edge_on = size.x <= kFlat * std::max(size.y, size.z) && size.z > kFlat * size.y;
  return orbit_camera(bounds, edge_on ? kAside : 0, lies ? kAside : 0, field_of_view, width, height);
}

double parallel_height(const Camera& camera, const WideBox& bounds, float width, float height) {
  if (bounds.empty()) return 1;
  const double smaller = std::max(1.0, static_cast<double>(std::min(width, height)));
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  double result = 0;
  for (const glm::dvec3& corner : corners(bounds)) {
    const glm::dvec3 p(camera_from_world * glm::dvec4(corner, 1));
    result = std::max({result, 2 * std::abs(p.x) * smaller / std::max(1.0, double{width}),
                       2 * std::abs(p.y) * smaller / std::max(1.0, double{height})});
  }
  return result > 0 ? result : 1;
}

bool has_in_view(const Camera& camera, const WideBox& bounds, float width, float height) {
  if (bounds.empty()) return true;
  const auto [tan_x, tan_y] = half_angles(camera.field_of_view, width, height);
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  for (const glm::dvec3& corner : corners(bounds)) {
    const glm::dvec3 p(camera_from_world * glm::dvec4(corner, 1));
    if (camera.height > 0) {
      const double side = camera.height / 2 / std::min(tan_x, tan_y);
      if (!(std::abs(p.x) <= side * tan_x && std::abs(p.y) <= side * tan_y)) return false;
      continue;
    }
    if (!(p.z < 0 && std::abs(p.x) <= -p.z * tan_x && std::abs(p.y) <= -p.z * tan_y)) return false;
  }
  return true;
}

Camera fit_depth(Camera camera, const WideBox& bounds, bool reversed) {
  double nearest = kDefaultNear, farthest = kDefaultFar;
  if (!bounds.empty()) {
    const glm::dvec3 eye(camera.world_from_camera[3]), forward(-camera.world_from_camera[2]);
    nearest = HUGE_VAL;
    farthest = -HUGE_VAL;
    double largest = 0;  // largest absolute coordinate; the planes get a margin for its rounding
    for (const glm::dvec3& corner : corners(bounds)) {
      const double depth = glm::dot(corner - eye, forward);
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
      for (int axis = 0; axis < 3; ++axis) largest = std::max({largest, std::abs(corner[axis]), std::abs(eye[axis])});
    }
    const double margin = (farthest - nearest) * kDepthMargin + largest * 1e-6;
    nearest -= margin;
    farthest += margin;
    if (!(farthest > 0) || !std::isfinite(farthest)) {  // all bounds are behind the camera
      nearest = kDefaultNear;
      farthest = kDefaultFar;
    }
  }
  constexpr double kSmallest = 1e-30, kLargest = 1e30;  // range in which products of float32 numbers are safe
  const double far_plane = camera.far_plane > 0 ? double{camera.far_plane} : std::clamp(farthest, kSmallest, kLargest);
  if (!(camera.near_plane > 0)) {
    const double before_far = nearest < far_plane ? nearest : far_plane * 0.5;
    camera.near_plane =
        static_cast<float>(std::max(before_far, far_plane / (reversed ? kLargestReversedRatio : kLargestDepthRatio)));
  }
  if (!(camera.far_plane > 0)) camera.far_plane = static_cast<float>(std::max(far_plane, camera.near_plane * 1.01));
  return camera;
}

}  // namespace gs::render
