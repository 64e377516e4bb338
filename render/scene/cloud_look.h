#pragma once

#include "qnv/base/description.h"

#include <glm/vec4.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace gs::render {

/// Colour source of splats and voxels; all but `own` serve to inspect streams.
enum class ColorBy : std::uint8_t {
  own,     // colour of the point set or the material
  normal,  // node space: x, y, z from -1..1 as red, green, blue
  level,   // level of detail: coarse is blue, fine is red
  chunk,   // a colour per chunk
  age,     // order of arrival: first is blue, latest is red
};

/// User settings for all point sets of an image.
struct SplatStyle {
  ColorBy color_by = ColorBy::own;
  // Volumes only.
  float opacity = 2;                         // factor of the optical depth
  float least_magnitude = 0;                 // shorter gradients are hidden
  std::optional<glm::dvec4> clip;            // world space: hides points with clip.xyz . position + clip.w < 0
  std::vector<qnv::TransferPoint> transfer;  // replaces the volumes' own; sorted by value; empty means their own
  friend bool operator==(const SplatStyle&, const SplatStyle&) = default;
};

}  // namespace gs::render
