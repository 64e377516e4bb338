#pragma once

#include "vrml/mesh/polygon.h"
#include "vrml/mesh/text_shaper.h"

#include <glm/vec2.hpp>

#include <vector>

namespace gs::render {

/// Closed curves as polygons, without a corner for the way back to the first one.
using Contours = std::vector<std::vector<glm::dvec2>>;

/// Leaves out corners that lie nearer to the polygon without them than `tolerance`; at least three stay, where there
/// are three.
[[nodiscard]] std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& contour, double tolerance);

/// What the contours enclose by the rule of non-zero winding, whichever way they turn, as triangles that turn
/// counter-clockwise. Contours that cross each other give triangles that overlap.
[[nodiscard]] vrml::GlyphShape fill(const Contours& contours, vrml::PolygonTriangulator& triangulator);

}  // namespace gs::render
