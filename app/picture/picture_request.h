#pragma once

#include "render/scene/stereo.h"

#include <glm/vec2.hpp>

#include <optional>

namespace gs::app {

inline constexpr int kMostPictureSide = 65536;  // pixels
inline constexpr double kUsualDots = 300;       // an inch

/// How a picture is to be that is kept, beside what it shows.
struct PictureRequest {
  bool transparent = false;
  bool color_bar = false;  // of what has numbers for colours
  render::Stereo stereo = render::Stereo::none;
  double eye_distance = 0;          // metres of the world; 0: by the distance to its middle
  double dots_per_inch = 0;         // that the file tells; 0: nothing
  std::optional<glm::dvec2> paper;  // millimetres, in place of a size in pixels
};

/// The size in pixels of what is printed on so much paper, or nothing where a side has none or more than
/// kMostPictureSide; kUsualDots an
/// inch where none are asked for.
[[nodiscard]] std::optional<glm::ivec2> pixels_of(const PictureRequest& request);

}  // namespace gs::app
