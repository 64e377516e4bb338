#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace gs::render {

/// Pixels per point of a usual screen: 96 pixels and 72 points per inch.
inline constexpr double kUsualPixelsPerPoint = 96.0 / 72;

/// Orientation, lens and picture of a viewer, without the position. Content with sizes in pixels depends on them.
struct Sight {
  glm::dmat3 orientation{1.0};      // of the camera in world space
  float field_of_view = 0.785398f;  // radians, along the smaller side of the picture
  double height = 0;                // world units along the smaller side in parallel projection; 0 means perspective
  glm::dvec2 pixels{1024, 768};     // size of the picture
  double pixels_per_point = kUsualPixelsPerPoint;
  friend bool operator==(const Sight&, const Sight&) = default;
};

/// Returns the length of a pixel in world units, at the distance `depth` along the view axis.
[[nodiscard]] double pixel_length(const Sight& sight, double depth);
/// Returns the pixels per radian at the centre of a picture in perspective.
[[nodiscard]] float pixels_per_radian(const Sight& sight);
/// Returns Camera::height for which a picture of this size shows a rectangle of `extent`.
[[nodiscard]] double height_for(const glm::dvec2& extent, const glm::dvec2& pixels);

}  // namespace gs::render
