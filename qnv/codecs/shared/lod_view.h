#pragma once

#include "base/box.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace gs::qnv {

/// Parts of a volume that a view needs. All planes are in the coordinates of the stream.
struct VolumeNeeds {
  bool values = true;                             // values are read, not only vectors
  bool exact = false;                             // values are read, and should be as exact as the stream has them
  bool only_slices = false;                       // vectors are hidden
  std::uint32_t step = 0;                         // of a time series
  glm::vec4 clip{0};                              // vectors with dot(clip, (p, 1)) < 0 are hidden; zero means none
  std::array<glm::vec4, 3> slices{};              // planes that show values; zero means none
  std::array<std::optional<glm::vec3>, 4> points{};  // places that come first: under the pointer, and of the ruler
  std::optional<std::bitset<256>> hidden_classes; // of vectors; nullopt means those that the stream's transfer function
                                                  // hides
  friend bool operator==(const VolumeNeeds&, const VolumeNeeds&) = default;
};

/// Viewpoint and limits of a view that draws a surface. All positions are in the coordinates of the stream.
struct LodView {
  glm::vec3 eye{0};
  float pixels = 1000;                // size in pixels of one unit of length at distance 1
  std::array<glm::vec4, 5> planes{};  // the inside has dot(plane, (p, 1)) >= 0; all zero means no clipping
  std::size_t budget = 0;             // maximum splats; 0 means unlimited
  float error_pixels = 1;             // minimum useful voxel size on the screen, pixels
  std::uint32_t viewport = 0;         // identifier of the viewport; each viewport keeps its own detail
  std::size_t most_decoded = 0;       // maximum splats to decode now; 0 means no limit
  bool leave_backs = false;           // omits parts that face away, unless the stream is two-sided
  bool each_chunk = false;            // each Piece has splats of only one chunk
  VolumeNeeds volume{};               // needs of a volume
  friend bool operator==(const LodView&, const LodView&) = default;
};

/// Reports whether a box is entirely outside a view.
[[nodiscard]] inline bool outside(const Box& box, const LodView& view) {
  for (const glm::vec4& plane : view.planes) {
    if (plane == glm::vec4(0)) continue;
    // Corner that is farthest inside the plane.
    const glm::vec3 p(plane.x >= 0 ? box.upper.x : box.lower.x, plane.y >= 0 ? box.upper.y : box.lower.y,
                      plane.z >= 0 ? box.upper.z : box.lower.z);
    if (plane.x * p.x + plane.y * p.y + plane.z * p.z + plane.w < 0) return true;
  }
  return false;
}

}  // namespace gs::qnv
