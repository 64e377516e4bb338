#pragma once

#include "app/commands/options/options.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

/// Options of pictures and animations, and their values.
namespace gs::app {

/// Returns these rows of option_rows().
[[nodiscard]] std::span<const OptionRow> picture_option_rows();

/// Parses a paper size such as "210x297mm", "10x15cm" or "8.5x11in". Returns millimetres, or nullopt.
[[nodiscard]] std::optional<glm::dvec2> read_paper(std::string_view text);
/// Parses a colour: "#rrggbb", or "R,G,B" from 0 to 1.
[[nodiscard]] std::optional<glm::vec3> read_color(std::string_view text);
/// These functions set a value in `request`. They return the expected form if the text is wrong.
[[nodiscard]] std::optional<std::string> read_stereo(std::string_view text, PictureRequest& request);
[[nodiscard]] std::optional<std::string> read_eye_distance(std::string_view text, PictureRequest& request);
[[nodiscard]] std::optional<std::string> read_dots(std::string_view text, PictureRequest& request);

/// Parses a time range such as "2..10", in seconds. Neither number is negative, and the second is larger.
[[nodiscard]] std::optional<std::pair<double, double>> read_times(std::string_view text);

}  // namespace gs::app
