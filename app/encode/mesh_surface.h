#pragma once

#include "app/encode/surface_corners.h"
#include "app/formats/common/mesh_asset.h"

#include <string>
#include <vector>

namespace gs::app {

/// Faces of a mesh file, tessellated to be encoded. Needs neither nodes nor the renderer.
struct MeshSurface {
  struct Part {
    vrml::Mesh mesh;
    glm::vec3 color;  // of vertices without colours
  };

  std::vector<Part> parts;
  std::vector<Share> shares;  // of the memory of the parts
  SurfaceSummary summary;
  std::optional<ColorKey> color_key;  // as read from a scene of the mesh
  bool face_colors = false;           // some faces have colours of their own
};

/// Tessellates the faces of a mesh as in its scene, by the same limits. Leaves out lines, points and textures. Reports
/// parts that exceed the budget.
[[nodiscard]] MeshSurface mesh_surface(MeshAsset mesh, const std::string& path, const WorldBudget& budget,
                                       Diagnostics& diagnostics);

/// Sends all triangles to `sink`, relative to `origin`. Returns false if the sink stopped. Deterministic.
bool for_each_triangle(const MeshSurface& surface, const qnv::TriangleSink& sink, const glm::dvec3& origin);

}  // namespace gs::app
