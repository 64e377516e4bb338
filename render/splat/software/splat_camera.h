#pragma once

#include "render/scene/clip_space.h"
#include "render/splat/software/splat_tile.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace gs::render {

struct SplatView;

/// View in the form that the splatters of surfaces need.
struct SplatCamera {
  glm::mat4 camera_from_node;
  glm::mat3 normal_matrix;  // from node space to camera space
  glm::vec3 eye;            // eye in node space
  float scale;              // maximum factor by which camera_from_node scales lengths
  SplatRays rays;
  float pixels;  // samples per length 1 at depth 1
  glm::vec2 tangents, center;
  int width, height;  // size of the target in samples
  ClipSpace clip;     // in node space, relative to the eye
};

/// Returns the camera of a view. Returns nullopt if the node is flattened or not finite in camera space; nothing is
/// then visible.
[[nodiscard]] std::optional<SplatCamera> splat_camera(const SplatView& view);

}  // namespace gs::render
