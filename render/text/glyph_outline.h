#pragma once

#include "vrml/mesh/polygon.h"
#include "vrml/mesh/text_shaper.h"

#include <glm/vec2.hpp>

#include <vector>

namespace gs::render {

/// Closed contours as polygons. The last corner is connected to the first.
using Contours = std::vector<std::vector<glm::dvec2>>;

/// Removes corners that are less than `tolerance` away from the simplified polygon. Keeps at least three corners.
[[nodiscard]] std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& contour, double tolerance);

/// Triangulates the area inside the contours by the non-zero winding rule. The orientation of contours does not matter.
/// Triangles are counter-clockwise. They overlap if contours cross each other.
[[nodiscard]] vrml::GlyphShape fill(const Contours& contours, vrml::PolygonTriangulator& triangulator);

}  // namespace gs::render
