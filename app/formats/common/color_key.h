#pragma once

#include "vrml/scene/field_value.h"

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
/// WorldInfo, so that it survives export. Authors of worlds can write it, too:
///
///     color key: LOW HIGH #RRGGBB #RRGGBB ... TITLE
///
/// The colours, two to 64, are spaced evenly from value LOW to value HIGH and interpolated linearly. TITLE is the name
/// of the values with their unit, "pressure (Pa)"; it is optional.
struct ColorKey {
  std::string title;
  double low = 0, high = 1;
  std::vector<vrml::Color> colors;  // at least two

  /// Returns the colour of a value. Clamps values outside the range; returns grey for NaN.
  [[nodiscard]] vrml::Color color_of(double value) const;
  /// Returns the value with the nearest colour.
  [[nodiscard]] double value_of(const vrml::Color& color) const;
};

/// Returns five sample colours of Viridis (matplotlib).
[[nodiscard]] std::vector<vrml::Color> viridis_colors();

/// Builds a key from the minimum to the maximum of the finite values.
[[nodiscard]] ColorKey color_key_over(std::span<const float> values, std::vector<vrml::Color> colors,
                                      std::string title);

/// Formats a key for a WorldInfo's `info`.
[[nodiscard]] std::string color_key_text(const ColorKey& key);
/// Metadata key of QNV streams; the value is the text without "color key:".
inline constexpr std::string_view kColorKeyMetadata = "color key";
[[nodiscard]] std::pair<std::string, std::string> color_key_metadata(const ColorKey& key);
/// Returns the first valid key in the metadata.
[[nodiscard]] std::optional<ColorKey> color_key_of(std::span<const std::pair<std::string, std::string>> metadata);

/// Adds the key to the scene under construction.
void add_color_key(SceneBuilder& builder, const ColorKey& key);
/// Parses the text of a key. Returns nullopt if it is not valid.
[[nodiscard]] std::optional<ColorKey> read_color_key(std::string_view text);
/// Returns the first key in a WorldInfo of the scene.
[[nodiscard]] std::optional<ColorKey> color_key_of(const vrml::SceneGraph& scene);

}  // namespace gs::app
