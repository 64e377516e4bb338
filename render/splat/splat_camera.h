#pragma once

#include "render/splat/splat_tile.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace gs::render {

struct SplatView;

/// View in the form that the surface splatters use.
struct SplatCamera {
  glm::mat4 camera_from_node;
  glm::mat3 normal_matrix;  // camera space
  glm::vec3 eye;            // node space
  float scale;              // largest factor by which lengths grow
  SplatRays rays;
  float pixels;  // samples per unit at depth 1
  glm::vec2 tangents, center;
  int width, height;  // samples
};

/// Returns nullopt if the node is flattened or not finite in camera space, so that nothing is visible.
[[nodiscard]] std::optional<SplatCamera> splat_camera(const SplatView& view);

}  // namespace gs::render
