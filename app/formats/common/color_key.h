#pragma once

#include "vrml/scene/field_value.h"
#include "vrml/scene/scene_graph.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {

class SceneBuilder;

/// What the colours of a surface stand for: the values of a file that were made colours of its vertices or faces. A
/// scene says it in the `info` of a WorldInfo, so that it stays with it wherever it is written, and authors of worlds
/// can say it, too:
///
///     color key: LOW HIGH #RRGGBB #RRGGBB ... TITLE
///
/// The colours, two to 64, stand evenly from the value LOW to the value HIGH; between two of them they are mixed in
/// proportion. TITLE: what the values are, and their unit, "pressure (Pa)"; may be missing.
struct ColorKey {
  std::string title;
  double low = 0, high = 1;
  std::vector<vrml::Color> colors;  // at least two

  /// Of a value; of one outside as at the end, of none grey.
  [[nodiscard]] vrml::Color color_of(double value) const;
  /// The value whose colour is the nearest one.
  [[nodiscard]] double value_of(const vrml::Color& color) const;
};

/// Viridis (matplotlib), by five of its colours.
[[nodiscard]] std::vector<vrml::Color> viridis_colors();

/// From the least to the largest of the values that are numbers.
[[nodiscard]] ColorKey color_key_over(std::span<const float> values, std::vector<vrml::Color> colors,
                                      std::string title);

/// As a WorldInfo's `info` has it.
[[nodiscard]] std::string color_key_text(const ColorKey& key);
/// A stream says the same in its metadata, by this key: the text without "color key:".
inline constexpr std::string_view kColorKeyMetadata = "color key";
[[nodiscard]] std::pair<std::string, std::string> color_key_metadata(const ColorKey& key);
/// The first one of metadata that is whole.
[[nodiscard]] std::optional<ColorKey> color_key_of(std::span<const std::pair<std::string, std::string>> metadata);

/// Says it in the scene that is made.
void add_color_key(SceneBuilder& builder, const ColorKey& key);
/// Nothing: it is no such text, or not a whole one.
[[nodiscard]] std::optional<ColorKey> read_color_key(std::string_view text);
/// The first one that a WorldInfo of the scene says.
[[nodiscard]] std::optional<ColorKey> color_key_of(const vrml::SceneGraph& scene);

}  // namespace gs::app
