#include "render/volume/volume_lights.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace gs::render {
namespace {

constexpr std::size_t kMaxVolumeLights = 4;

/// Returns the unit vector in the direction of `v`, or 0 if it has none.
glm::vec3 unit(const glm::vec3& v) {
  const float length = std::sqrt(glm::dot(v, v));
  return length > 0 && std::isfinite(length) ? v / length : glm::vec3(0);
}

VolumeLight in_camera(const Light& light, const glm::dmat4& camera_from_world) {
  VolumeLight result;
  const glm::vec3 direction = unit(glm::vec3(glm::dmat3(camera_from_world) * glm::dvec3(light.direction)));
  result.directional = light.kind == Light::Kind::directional;
  result.place = result.directional ? -direction : glm::vec3(camera_from_world * glm::dvec4(light.location, 1));
  result.color = light.color * light.intensity;
  result.ambient = light.intensity > 0 ? light.ambient_intensity / light.intensity : 0.0f;
  result.attenuation = light.attenuation;
  result.radius = light.radius;
  if (light.kind == Light::Kind::spot) {
    result.direction = direction;
    result.beam_width = light.beam_width;
    result.cut_off_angle = light.cut_off_angle;
  }
  return result;
}

/// Estimates the brightness of a point or spot light at a position.
float strength_at(const VolumeLight& light, const glm::vec3& place) {
  const float distance = glm::distance(light.place, place);
  const glm::vec3& a = light.attenuation;
  return std::max({light.color.r, light.color.g, light.color.b}) /
         std::max(a.x + a.y * distance + a.z * distance * distance, 1.0f);
}

}  // namespace

std::vector<VolumeLight> volume_lights(const RenderList& list, const SplatItem& item,
                                       const glm::dmat4& camera_from_world, const glm::vec3& center, bool headlight) {
  std::vector<VolumeLight> lights, local;
  for (const std::uint16_t i : item.directional_lights)
    if (i < list.lights.size()) lights.push_back(in_camera(list.lights[i], camera_from_world));
  for (const Light& light : list.lights)
    if (!light.listed()) local.push_back(in_camera(light, camera_from_world));
  std::stable_sort(local.begin(), local.end(), [&](const VolumeLight& a, const VolumeLight& b) {
    return strength_at(a, center) > strength_at(b, center);
  });
  lights.insert(lights.end(), local.begin(), local.end());
  if (lights.size() > kMaxVolumeLights) lights.resize(kMaxVolumeLights);
  if (headlight) lights.push_back(volume_headlight().front());
  // The shader treats an empty list as a light at the viewer, so add a black light.
  if (lights.empty()) lights.push_back({.color = glm::vec3(0)});
  return lights;
}

}  // namespace gs::render
