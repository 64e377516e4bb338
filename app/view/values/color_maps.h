#pragma once

#include "app/view/values/transfer_editor.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Colour map: colours from the minimum to the maximum value.
struct ColorMap {
  std::string_view name;   // name in options and files: "viridis"
  std::string_view label;  // "Viridis"
  std::string_view help;  // one line about the use of the map
  std::string_view source;
  bool diverging = false;  // colours differ in two directions from a neutral middle
  glm::vec3 (*color)(float place);
};
/// Returns all colour maps; the first one is grey.
[[nodiscard]] std::span<const ColorMap> color_maps();
/// Returns the colour map with this name; null if there is none.
[[nodiscard]] const ColorMap* find_color_map(std::string_view name);
/// Returns the names of all maps, separated by commas.
[[nodiscard]] std::string color_map_names();

/// Returns the colour at a position from 0 to 1, as sRGB components in 0..1 for display. Clamps other positions.
[[nodiscard]] glm::vec3 color_at(const ColorMap& map, float place);

/// Returns evenly spaced colours of a map, for SurfaceColors.
[[nodiscard]] std::vector<glm::vec3> palette_of(const ColorMap& map);

/// Shape of the opacity in a transfer function that is made from a map.
enum class OpacityRamp : std::uint8_t {
  linear,  // transparent at the minimum, nearly opaque at the maximum
  ends,  // nearly opaque at both ends, transparent in the middle; suits diverging maps
  flat,  // the same everywhere
};
/// Makes a transfer function with the colours of a map and opacities of this shape.
[[nodiscard]] Transfer mapped_transfer(const ColorMap& map, OpacityRamp ramp);
/// Returns a transfer function with the colours of a map and the opacities of `transfer`.
[[nodiscard]] Transfer recolored(const Transfer& transfer, const ColorMap& map);

}  // namespace gs::app
