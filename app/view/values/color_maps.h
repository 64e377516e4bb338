#pragma once

#include "app/view/values/transfer_editor.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Colour map from the smallest value to the largest.
struct ColorMap {
  std::string_view name;   // name in options and files: "viridis"
  std::string_view label;  // "Viridis"
  std::string_view help;   // purpose
  std::string_view source;
  bool diverging = false;  // two directions from a neutral middle
  glm::vec3 (*color)(float place);
};
/// Returns all colour maps; the first one is grey.
[[nodiscard]] std::span<const ColorMap> color_maps();
/// Finds a map by name; null if there is none.
[[nodiscard]] const ColorMap* find_color_map(std::string_view name);
/// Returns the names, separated by commas.
[[nodiscard]] std::string color_map_names();

/// Returns the display-referred sRGB colour, 0..1, at a position from 0 to 1; clamps positions outside.
[[nodiscard]] glm::vec3 color_at(const ColorMap& map, float place);

/// Opacity curve of a transfer function over the values.
enum class OpacityRamp : std::uint8_t {
  linear,  // from transparent at the minimum to nearly opaque at the maximum
  ends,    // opaque at both ends, transparent in the middle; for diverging maps
  flat,    // constant
};
/// Builds a transfer function with the colours of a map.
[[nodiscard]] Transfer mapped_transfer(const ColorMap& map, OpacityRamp ramp);
/// Replaces the colours of a function by those of a map; keeps its opacities.
[[nodiscard]] Transfer recolored(const Transfer& transfer, const ColorMap& map);

}  // namespace gs::app
