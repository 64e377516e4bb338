#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::qnv {

/// Viewpoint and limits of a view that draws a surface. All positions are in the coordinates of the stream.
struct LodView {
  glm::vec3 eye{0};
  float pixels = 1000;  // size in pixels of one unit of length at distance 1
  std::array<glm::vec4, 5> planes{};  // the inside has dot(plane, (p, 1)) >= 0; all zero means no clipping
  std::size_t budget = 0;             // maximum splats; 0 means unlimited
  float error_pixels = 1;  // minimum useful voxel size on the screen, pixels
  std::uint32_t viewport = 0;  // identifier of the viewport; each viewport keeps its own detail
  std::size_t most_decoded = 0;  // maximum splats to decode now; 0 means no limit
  bool leave_backs = false;  // omits parts that face away, unless the stream is two-sided
  bool each_chunk = false;  // each Piece has splats of only one chunk
  friend bool operator==(const LodView&, const LodView&) = default;
};

}  // namespace gs::qnv
