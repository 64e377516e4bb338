#pragma once

#include "app/encode/mesh_surface.h"
#include "app/encode/surface_triangles.h"

#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace gs::test {

/// Returns all triangles of a surface, with positions relative to the origin of the file.
inline std::vector<qnv::Triangle> triangles_of(const app::MeshSurface& surface) {
  std::vector<qnv::Triangle> all;
  (void)app::for_each_triangle(
      surface,
      [&](std::span<const qnv::Triangle> some) {
        all.insert(all.end(), some.begin(), some.end());
        return true;
      },
      glm::dvec3(0));
  return all;
}

}  // namespace gs::test
