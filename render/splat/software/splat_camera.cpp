#include "render/splat/software/splat_camera.h"

#include "render/splat/software/splat_raster.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gs::render {

std::optional<SplatCamera> splat_camera(const SplatView& view) {
  SplatCamera c{};
  c.camera_from_node = view.camera_from_node;
  const glm::mat3 linear(view.camera_from_node);
  const float determinant = glm::determinant(linear);
  if (!(std::abs(determinant) > 1e-30f) || !std::isfinite(determinant)) return std::nullopt;
  const glm::mat3 inverse = glm::inverse(linear);
  c.normal_matrix = glm::transpose(inverse);
  c.eye = -(inverse * glm::vec3(view.camera_from_node[3]));
  c.scale = 0;
  for (int i = 0; i < 3; ++i) c.scale = std::max(c.scale, glm::length(linear[i]));
  c.width = view.width * view.supersample;
  c.height = view.height * view.supersample;
  const float step_x = 2 * view.tangents.x / static_cast<float>(c.width);
  const float step_y = 2 * view.tangents.y / static_cast<float>(c.height);
  c.rays.right = inverse[0] * step_x;
  c.rays.up = inverse[1] * step_y;
  c.rays.origin = inverse * glm::vec3(view.center - view.tangents + 0.5f * glm::vec2(step_x, step_y), -1.0f);
  c.rays.near_plane = view.near_plane;
  c.pixels = 1 / std::min(step_x, step_y);
  c.clip = view.clip;
  for (std::size_t i = 0; i < c.clip.count; ++i) c.clip.planes[i].w += glm::dot(glm::vec3(c.clip.planes[i]), c.eye);
  c.tangents = view.tangents;
  c.center = view.center;
  return c;
}

}  // namespace gs::render
