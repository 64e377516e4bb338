#pragma once

#include "qnv/surface/patch_surface.h"
#include "render/rays/box_tree.h"

#include <array>
#include <cstdint>
#include <optional>

namespace gs::render {

/// Where a line meets a triangle of a displaced surface; in the surface's own space.
struct PatchHit {
  double distance = 0;                 // in lengths of the line's direction
  std::uint32_t part = 0, patch = 0;   // of SurfacePatches
  std::array<glm::vec3, 3> corners{};  // of the triangle
  glm::dvec3 weights{0};               // of the corners; 0 to 1, their sum is 1
  glm::vec3 normal{0};                 // that is shaded there; 0: none
  glm::vec3 vertex{0};                 // the corner nearest to the point
  std::optional<glm::vec3> color;      // 0..1, between those of the corners; nothing: the surface has none of its own
};

/// The nearest triangle that the line meets, from either side, of the surface as it is drawn for an eye where the line
/// begins, whose picture has pixels of the width `pixel` at distance 1. Takes some ns for every patch of the surface,
/// and microseconds for each that the line may meet. `line` in the surface's space.
[[nodiscard]] std::optional<PatchHit> pick_patches(const qnv::SurfacePatches& surface, const SightLine& line,
                                                   float pixel);

}  // namespace gs::render
