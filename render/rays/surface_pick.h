#pragma once

#include "qnv/codecs/displaced/tessellation/patch_surface.h"
#include "render/rays/box_tree.h"

#include <array>
#include <cstdint>
#include <optional>

namespace gs::render {

/// Hit of a line on a triangle of a displaced surface, in the surface's space.
struct PatchHit {
  double distance = 0;                 // in lengths of the line's direction
  std::uint32_t part = 0, patch = 0;   // indices in SurfacePatches
  std::array<glm::vec3, 3> corners{};  // corners of the triangle
  glm::dvec3 weights{0};               // barycentric, each 0 to 1, sum 1
  glm::vec3 normal{0};                 // shading normal; 0 means none
  glm::vec3 vertex{0};                 // corner nearest to the hit
  std::optional<glm::vec3> color;      // 0..1, interpolated; nullopt if the surface has no own colours
};

/// Returns the nearest triangle on the line, from either side. Uses the triangles that would be drawn for an eye at the
/// line's origin, with pixels of width `pixel` at distance 1. Takes a few ns per patch, and microseconds per candidate
/// patch. `line` is in the surface's space.
[[nodiscard]] std::optional<PatchHit> pick_patches(const qnv::SurfacePatches& surface, const SightLine& line,
                                                   float pixel);

}  // namespace gs::render
