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

/// Colours for numbers, from the least to the largest.
struct ColorMap {
  std::string_view name;   // as options and files have it: "viridis"
  std::string_view label;  // "Viridis"
  std::string_view help;   // what it is for
  std::string_view source;
  bool diverging = false;  // two directions from a neutral middle
  glm::vec3 (*color)(float place);
};
/// The table of all. The first is grey.
[[nodiscard]] std::span<const ColorMap> color_maps();
/// By its name; null: there is none.
[[nodiscard]] const ColorMap* find_color_map(std::string_view name);
/// The names, parted by commas.
[[nodiscard]] std::string color_map_names();

/// Display-referred sRGB, 0..1, at a place from 0 to 1; what lies outside is as at the end.
[[nodiscard]] glm::vec3 color_at(const ColorMap& map, float place);

/// How the opacity of a transfer function rises over the values.
enum class OpacityRamp : std::uint8_t {
  linear,  // from transparent at the least value to nearly opaque at the largest
  ends,    // opaque at both ends and transparent in the middle: of diverging maps
  flat,    // the same everywhere
};
/// A transfer function that has the colours of a map.
[[nodiscard]] Transfer mapped_transfer(const ColorMap& map, OpacityRamp ramp);
/// The same function with the colours of a map: its opacities stay.
[[nodiscard]] Transfer recolored(const Transfer& transfer, const ColorMap& map);

}  // namespace gs::app
