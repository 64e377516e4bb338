#pragma once

#include "app/view/values/color_bar.h"
#include "app/view/values/volume_grid.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

// Texts about the voxel under the pointer.
namespace gs::app {

/// Returns the coordinates of a position.
[[nodiscard]] inline std::string place_text(const glm::dvec3& p) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "%.5g, %.5g, %.5g", p.x, p.y, p.z);
  return buffer;
}

[[nodiscard]] inline std::string label_text(double label) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "label %.10g", label);
  return buffer;
}

[[nodiscard]] inline std::string color_text(const std::array<std::uint8_t, 4>& color) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "R G B %d %d %d", color[0], color[1], color[2]);
  return buffer + (color[3] < 255 ? ", opacity " + std::to_string(color[3]) : std::string());
}

/// Returns a text to follow a value that may differ from that of the source; empty if the error is unknown.
[[nodiscard]] inline std::string accuracy_text(const std::optional<float>& error) {
  if (!error) return {};
  return *error == 0 ? ", exact," : ", within " + readable_value(static_cast<double>(*error)) + ",";
}

/// Names the voxel of the whole volume at a position in voxels of a grid.
[[nodiscard]] inline std::string voxel_text(const VolumeGrid& grid, const glm::dvec3& p) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "voxel %.0f, %.0f, %.0f", p.x * grid.fineness(0), p.y * grid.fineness(1),
                p.z * grid.fineness(2));
  return buffer;
}

}  // namespace gs::app
