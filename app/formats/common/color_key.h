#pragma once

#include "app/formats/common/voxel_component.h"
#include "vrml/scene/values/field_value.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

class SceneBuilder;

/// Mapping from surface colours back to the data values of the source file. A scene stores it in the `info` of a
/// WorldInfo, so that exports keep it. World authors can write it, too:
///
///     color key: LOW HIGH #RRGGBB #RRGGBB ... TITLE
///
/// There are 2 to 64 colours, evenly spaced from the value LOW to the value HIGH; values in between are interpolated
/// linearly. TITLE is optional: a name for the values with their unit, such as "pressure (Pa)".
struct ColorKey {
  std::string title;
  double low = 0, high = 1;
  std::vector<vrml::Color> colors;  // at least two colours

  /// Returns the colour of a value. Clamps values outside the range. Returns grey for NaN.
  [[nodiscard]] vrml::Color color_of(double value) const;
  /// Returns the value with the colour that is nearest to `color`.
  [[nodiscard]] double value_of(const vrml::Color& color) const;
};

/// Returns five samples of the colour map Viridis (matplotlib).
[[nodiscard]] std::vector<vrml::Color> viridis_colors();

/// Builds a key that ranges from the minimum to the maximum of the finite values.
[[nodiscard]] ColorKey color_key_over(std::span<const float> values, std::vector<vrml::Color> colors,
                                      std::string title);

/// Builds a key with the range and the colours of a user's choice. Notes the whole range in VoxelComponent::found.
[[nodiscard]] ColorKey color_key_of_choice(std::span<const float> values, std::string title,
                                           const VoxelComponent& choice);

/// Formats a key as text for the `info` of a WorldInfo.
[[nodiscard]] std::string color_key_text(const ColorKey& key);
/// Metadata key of QNV streams. Its value is the text of a key without "color key:".
inline constexpr std::string_view kColorKeyMetadata = "color key";
[[nodiscard]] std::pair<std::string, std::string> color_key_metadata(const ColorKey& key);
/// Returns the first valid key in the metadata, or nullopt.
[[nodiscard]] std::optional<ColorKey> color_key_of(std::span<const std::pair<std::string, std::string>> metadata);

/// Adds a WorldInfo with the key to the scene under construction.
void add_color_key(SceneBuilder& builder, const ColorKey& key);
/// Parses the text of a key. Returns nullopt if the text is invalid.
[[nodiscard]] std::optional<ColorKey> read_color_key(std::string_view text);
/// Returns the first valid key in a WorldInfo of the scene, or nullopt.
[[nodiscard]] std::optional<ColorKey> color_key_of(const vrml::SceneGraph& scene);

}  // namespace gs::app
