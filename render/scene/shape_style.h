#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::render {

/// Maximum ClipPlanes that affect one item; the outermost are used (X3D 11.4.1 asks for six).
inline constexpr std::size_t kMaxClipPlanes = 8;

/// Style of the lines, points and fillings of a Shape: LineProperties, PointProperties and FillProperties (X3D 12.4).
struct ShapeStyle {
  static constexpr std::uint32_t kSolidLine = UINT32_MAX;
  /// Rows of a pattern of hatches, from the bottom; bit 0 is on the left.
  using Hatch = std::array<std::uint32_t, 32>;

  float line_width = 1;                         // pixels
  std::uint32_t line_pattern = kSolidLine;      // bit i: the line is drawn at i line widths after the start of a period
  bool sized_points = false;                    // PointProperties apply
  float point_size = 1;                         // pixels, before attenuation
  glm::vec3 point_attenuation{1, 0, 0};         // divides the size by a + b * r + c * r * r, with r in metres
  float smallest_point = 1, largest_point = 1;  // pixels; limits of attenuated sizes
  bool filled = true;                           // surfaces are filled between hatches
  bool hatched = false;
  glm::vec3 hatch_color{1};
  int hatch_style = 1;

  friend bool operator==(const ShapeStyle&, const ShapeStyle&) = default;
};

/// Returns the pattern of LineProperties.linetype; types without a pattern of dashes are solid.
[[nodiscard]] std::uint32_t line_pattern(int line_type);
/// Returns the pattern of FillProperties.hatchStyle, 1 to 19. Other styles are drawn as style 1.
[[nodiscard]] const ShapeStyle::Hatch& hatch_pattern(int hatch_style);

}  // namespace gs::render
