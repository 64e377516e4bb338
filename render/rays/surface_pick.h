#pragma once

#include "qnv/codecs/displaced/tessellation/patch_surface.h"
#include "render/rays/box_tree.h"

#include <array>
#include <cstdint>
#include <optional>

namespace gs::render {

/// Hit of a line on a triangle of a patch, in the surface's space.
struct PatchHit {
  double distance = 0;  // multiple of the length of the line's direction
  std::uint32_t part = 0, patch = 0;  // indexes in SurfacePatches
  std::array<glm::vec3, 3> corners{};  // corners of the triangle
  glm::dvec3 weights{0};  // barycentric coordinates of the hit: each from 0 to 1, sum 1
  glm::vec3 normal{0};  // shading normal; 0 means that there is none
  glm::vec3 vertex{0};  // corner of the triangle nearest to the hit
  std::optional<glm::vec3> color;  // interpolated colour, 0 to 1; nullopt if the surface has no own colours
};

/// Returns the nearest triangle on the line, from either side. The triangles are those that a camera at the line's
/// origin would draw, with pixels of width `pixel` at distance 1. Takes a few ns per patch, and microseconds per patch
/// near the line. `line` is in the surface's space.
[[nodiscard]] std::optional<PatchHit> pick_patches(const qnv::SurfacePatches& surface, const SightLine& line,
                                                   float pixel);

}  // namespace gs::render
