#pragma once

#include "app/commands/options/options.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

/// Options of pictures and animations, and the parsers of their values.
namespace gs::app {

/// Returns the rows of these options, which option_rows() includes.
[[nodiscard]] std::span<const OptionRow> picture_option_rows();

/// Parses a paper size such as "210x297mm", "10x15cm" or "8.5x11in". Returns the size in millimetres, or nullopt.
[[nodiscard]] std::optional<glm::dvec2> read_paper(std::string_view text);
/// Parses a colour: "#rrggbb", or "R,G,B" with numbers from 0 to 1. Returns nullopt if the text is invalid.
[[nodiscard]] std::optional<glm::vec3> read_color(std::string_view text);
/// Each of these functions sets a value in `request`. It returns the expected form if the text is wrong, else nullopt.
[[nodiscard]] std::optional<std::string> read_stereo(std::string_view text, PictureRequest& request);
[[nodiscard]] std::optional<std::string> read_eye_distance(std::string_view text, PictureRequest& request);
[[nodiscard]] std::optional<std::string> read_dots(std::string_view text, PictureRequest& request);

/// Parses a time range in seconds, such as "2..10". Returns nullopt unless 0 <= first < second.
[[nodiscard]] std::optional<std::pair<double, double>> read_times(std::string_view text);

}  // namespace gs::app
