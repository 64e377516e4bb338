#pragma once

#include "render/scene/stereo.h"

#include <glm/vec2.hpp>

#include <optional>

namespace gs::app {

inline constexpr int kMaxPictureSide = 65536;  // pixels
inline constexpr double kUsualDots = 300;      // default resolution, dots per inch

/// Output options of a saved picture, apart from its content.
struct PictureRequest {
  bool transparent = false;
  bool color_bar = false;  // only for content with values as colours
  render::Stereo stereo = render::Stereo::none;
  double eye_distance = 0;          // metres in the world; 0 derives it from the distance to the scene's centre
  double dots_per_inch = 0;         // resolution written to the file; 0 means none
  std::optional<glm::dvec2> paper;  // paper size in mm; replaces a size in pixels
};

/// Returns the size in pixels for the requested paper size. Returns nullopt if a side is empty or exceeds
/// kMaxPictureSide. Uses kUsualDots per inch if no resolution is requested.
[[nodiscard]] std::optional<glm::ivec2> pixels_of(const PictureRequest& request);

}  // namespace gs::app
