#include "render/scene/fog.h"

#include <glm/glm.hpp>

#include <cmath>

namespace gs::render {

CameraFog camera_fog(const Fog& fog, const glm::mat3& world_from_camera, float back) {
  CameraFog result;
  if (!(fog.visibility_range > 0) || !std::isfinite(fog.visibility_range)) return result;
  const glm::dmat3 matrix =
      glm::dmat3(fog.fog_from_world) * glm::dmat3(world_from_camera) * (1 / double{fog.visibility_range});
  result.ranges_from_camera = glm::mat3(matrix);
  float sum = 0;
  for (int i = 0; i < 3; ++i) sum += glm::dot(result.ranges_from_camera[i], result.ranges_from_camera[i]);
  if (!std::isfinite(sum)) return result;
  result.on = true;
  result.exponential = fog.exponential;
  result.color = fog.color;
  result.back = back;
  return result;
}

float fog_interpolant(const CameraFog& fog, const glm::vec3& place) {
  if (!fog.on) return 1;
  const float ranges = glm::length(fog.ranges_from_camera * (place + glm::vec3(0, 0, fog.back)));
  if (!(ranges < 1)) return 0;
  return fog.exponential ? std::exp(-ranges / (1 - ranges)) : 1 - ranges;
}

glm::vec3 fogged(const CameraFog& fog, const glm::vec3& color, const glm::vec3& place) {
  return fog.on ? glm::mix(fog.color, color, fog_interpolant(fog, place)) : color;
}

}  // namespace gs::render
