#pragma once

#include "render/splat/software/splat_raster.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <optional>

namespace gs::render {

inline constexpr float kVolumeLeastAlpha = 1 / 1024.0f;  // Minimum opacity of a vector that is drawn.

/// View of a volume, in the form that both splatters use.
struct VolumeLens {
  glm::mat4 camera_from_node;
  glm::mat3 normal_matrix;
  float scale;               // factor of lengths from node to camera space
  float pixels_x, pixels_y;  // pixels per length 1 at depth 1
  float middle_x, middle_y;  // pixel position of the optical axis, from the lower left corner
  int width, height;
};

/// Returns the lens for a view. Returns nullopt if nothing is visible: the volume is flattened, its matrix is not
/// finite, or the view is empty.
[[nodiscard]] inline std::optional<VolumeLens> volume_lens(const SplatView& view, const glm::mat4& camera_from_node) {
  VolumeLens lens{};
  lens.camera_from_node = camera_from_node;
  const glm::mat3 linear(camera_from_node);
  const float determinant = glm::determinant(linear);
  if (!(std::abs(determinant) > 1e-30f) || !std::isfinite(determinant)) return std::nullopt;
  const glm::vec4& place = camera_from_node[3];
  if (!std::isfinite(place.x) || !std::isfinite(place.y) || !std::isfinite(place.z)) return std::nullopt;
  lens.normal_matrix = glm::transpose(glm::inverse(linear));
  lens.scale = std::cbrt(std::abs(determinant));
  lens.pixels_x = static_cast<float>(view.width) / (2 * view.tangents.x);
  lens.pixels_y = static_cast<float>(view.height) / (2 * view.tangents.y);
  lens.middle_x = 0.5f * static_cast<float>(view.width) - view.center.x * lens.pixels_x;
  lens.middle_y = 0.5f * static_cast<float>(view.height) - view.center.y * lens.pixels_y;
  lens.width = view.width;
  lens.height = view.height;
  if (!(view.width > 0 && view.height > 0 && lens.pixels_x > 0 && lens.pixels_y > 0)) return std::nullopt;
  return lens;
}

}  // namespace gs::render
