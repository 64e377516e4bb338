#pragma once

#include "vrml/mesh/polygon.h"
#include "vrml/mesh/text_shaper.h"

#include <glm/vec2.hpp>

#include <vector>

namespace gs::render {

/// Closed curves as polygons; the closing edge is implicit.
using Contours = std::vector<std::vector<glm::dvec2>>;

/// Removes corners that are closer than `tolerance` to the polygon without them; keeps at least three.
[[nodiscard]] std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& contour, double tolerance);

/// Triangulates the area enclosed by the contours under the non-zero winding rule, whatever their orientation.
/// Triangles are counter-clockwise. Contours that cross each other give overlapping triangles.
[[nodiscard]] vrml::GlyphShape fill(const Contours& contours, vrml::PolygonTriangulator& triangulator);

}  // namespace gs::render
