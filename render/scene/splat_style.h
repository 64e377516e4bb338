#pragma once

#include "qnv/base/description.h"

#include <glm/vec4.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace gs::render {

/// Source of the colour of splats and voxels. All values except `own` are for the inspection of streams.
enum class ColorBy : std::uint8_t {
  own,     // colour of the geometry or of the material
  normal,  // normal in node space: x, y, z from -1 to 1 become red, green, blue
  level,   // level of detail: coarse is blue, fine is red
  chunk,   // one colour per chunk
  age,     // order of receipt: first is blue, last is red
};

/// Values of a volume that a view shows besides its vectors, so that streams provide them.
struct VolumeReading {
  bool values = false;                // any values
  bool exact = false;                 // values that should be as exact as the stream has them
  bool only_slices = false;           // the slices hide the vectors
  std::vector<glm::dvec4> slices{};   // planes of slices in world space
  std::vector<glm::dvec3> points{};   // places in world space with values that come first, the most wanted one in front
  friend bool operator==(const VolumeReading&, const VolumeReading&) = default;
};

/// User settings for all splats and volumes of an image.
struct SplatStyle {
  ColorBy color_by = ColorBy::own;
  // The following fields apply to volumes only.
  float opacity = 2;                         // factor of the optical depth
  float least_magnitude = 0;                 // vectors with a smaller gradient magnitude are hidden
  std::optional<glm::dvec4> clip;            // world space: points with dot(clip.xyz, position) + clip.w < 0 are hidden
  VolumeReading reading{};                   // values to read besides the vectors
  std::vector<qnv::TransferPoint> transfer;  // transfer function, sorted by value; empty means that of each volume
  friend bool operator==(const SplatStyle&, const SplatStyle&) = default;
};

}  // namespace gs::render
