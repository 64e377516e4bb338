#pragma once

#include "qnv/base/cloud.h"

#include <glm/vec4.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace gs::render {

/// What gives discs and voxels their colours; all but `own` are for those who look into streams.
enum class ColorBy : std::uint8_t {
  own,     // the cloud's or the material's
  normal,  // node space: -1..1 of x, y, z as red, green, blue
  level,   // of detail: coarse blue to fine red
  chunk,   // each in a colour of its own
  age,     // the order in which they came: first blue, latest red
};

/// What the viewer chooses for all clouds of a picture.
struct CloudLook {
  ColorBy color_by = ColorBy::own;
  // Volumes only.
  float opacity = 2;                         // times the optical depth
  float least_magnitude = 0;                 // shorter gradients are left out
  std::optional<glm::dvec4> clip;            // world space: what has clip.xyz . position + clip.w < 0 is left out
  std::vector<qnv::TransferPoint> transfer;  // in place of their own; sorted by value; empty: their own
  friend bool operator==(const CloudLook&, const CloudLook&) = default;
};

}  // namespace gs::render
