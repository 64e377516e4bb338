#pragma once

#include "render/scene/stereo.h"

#include <glm/vec2.hpp>

#include <optional>

namespace gs::app {

inline constexpr int kMaxPictureSide = 65536;  // pixels; max width or height
inline constexpr double kUsualDots = 300;  // dots per inch; default for a size on paper

/// Options of a saved picture that do not concern its content.
struct PictureRequest {
  bool transparent = false;
  bool color_bar = false;  // has an effect only if colours stand for values
  render::Stereo stereo = render::Stereo::none;
  double eye_distance = 0;  // metres in the world; 0 means a fraction of the distance to the scene's centre
  double dots_per_inch = 0;  // resolution that is written to the file; 0 means none
  std::optional<glm::dvec2> paper;  // size on paper in mm; replaces the size in pixels
};

/// Returns the size in pixels of the requested size on paper. Returns nullopt if a side is under one pixel or over
/// kMaxPictureSide. Uses kUsualDots per inch if no resolution is requested.
[[nodiscard]] std::optional<glm::ivec2> pixels_of(const PictureRequest& request);

}  // namespace gs::app
