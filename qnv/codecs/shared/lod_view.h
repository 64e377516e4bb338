#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::qnv {

/// Viewpoint and level of detail from which a surface is drawn. Node space: the units of the stream.
struct LodView {
  glm::vec3 eye{0};
  float pixels = 1000;                // size of one unit at distance one
  std::array<glm::vec4, 5> planes{};  // inside: dot(plane, (p, 1)) >= 0; all zero: no clipping
  std::size_t budget = 0;             // maximum splats; 0 means unlimited
  float error_pixels = 1;             // minimum useful voxel size on the screen
  std::uint32_t viewport = 0;         // each keeps its own detail
  std::size_t most_decoded = 0;       // maximum splats to decode now; 0 means as needed
  bool leave_backs = false;           // skip parts that face away, unless the stream is two-sided
  bool each_chunk = false;            // no piece holds splats of two chunks
  friend bool operator==(const LodView&, const LodView&) = default;
};

}  // namespace gs::qnv
