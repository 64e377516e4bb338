#pragma once

#include "render/splat/splat_tile.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace gs::render {

struct SplatView;

/// A view as the surface splatters use it.
struct SplatCamera {
  glm::mat4 camera_from_node;
  glm::mat3 normal_matrix;  // camera space
  glm::vec3 eye;            // node space
  float scale;              // the largest factor by which lengths grow
  SplatRays rays;
  float pixels;  // samples a unit at depth 1
  glm::vec2 tangents, center;
  int width, height;  // samples
};

/// Empty when the node is flattened or not finite in camera space, so that nothing of it can be seen.
[[nodiscard]] std::optional<SplatCamera> splat_camera(const SplatView& view);

}  // namespace gs::render
