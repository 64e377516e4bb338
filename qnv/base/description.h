#pragma once

#include "base/box.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Returns the origin for the positions of a stream with the bounding box `box`, in source coordinates. Positions
/// relative to this origin keep their precision in float32. On each axis, the origin is the middle of the box, rounded
/// to float32, if the box is far from 0 compared to its size; otherwise 0. Subtracting the origin from float32
/// coordinates near it is exact.
[[nodiscard]] glm::dvec3 local_origin(const WideBox& box);

/// Display-referred sRGB colour, 8 bits per component.
struct Rgb8 {
  std::uint8_t r = 204, g = 204, b = 204;  // VRML97 6.27: diffuseColor 0.8
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// Meaning of the vectors of a stream (paper, section 2.1).
enum class Kind : std::uint8_t {
  surface = 0,  // weight = area, direction = outward normal
  volume = 1,  // vectors of voxels: weight = gradient magnitude, direction = gradient, towards higher values
};

/// Control point of a volume's transfer function. The function is piecewise linear in the value, which runs from 0 to 1
/// over Description::value_range.
struct TransferPoint {
  float value = 0;
  Rgb8 color;
  float opacity = 0;  // 0..1
  friend bool operator==(const TransferPoint&, const TransferPoint&) = default;
};

/// Properties that all vectors of a stream share.
struct Description {
  bool two_sided = false;  // surface: its back is visible too (VRML97 `solid FALSE`)
  /// Source coordinates of the point (0, 0, 0) of the stream's positions, boxes and lattices. Source coordinates are
  /// origin + position, computed in double. The origin keeps float32 precise if the source is far from its own 0.
  glm::dvec3 origin{0};
  Box box;                                    // of the source, relative to `origin`; contains every position
  double total = 0;  // surface: total area (units^2); volume: sum of all gradient magnitudes
  float spacing = 0;                          // volume: smallest distance between two voxels; surface: 0
  std::pair<float, float> value_range{0, 1};  // volume: values of classes 0 and 255
  std::vector<TransferPoint> transfer;        // volume; sorted by value
  std::vector<std::pair<std::string, std::string>> metadata;  // UTF-8: "title", "author", "units", "source", ...
  friend bool operator==(const Description&, const Description&) = default;
};

}  // namespace gs::qnv
