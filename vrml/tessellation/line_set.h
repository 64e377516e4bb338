#pragma once

#include "base/budget.h"
#include "vrml/mesh/attribute.h"
#include "vrml/mesh/mesh.h"

#include <memory>

namespace gs::vrml {

/// Polylines in the form of IndexedLineSet (VRML97 6.24).
struct LineSet {
  MFInt32 coord_index;
  MFVec3f points;
  Attribute<Color> color;
  Array<float> opacities;   // empty, or one per element of color.values
  Array<float> fog_depths;  // empty, or one per point; missing values repeat the last one
  MFVec3f normals;          // lines with one normal per point are lit
  glm::dvec3 origin{0};     // Mesh::origin
  bool lengths = false;     // MeshOptions::line_lengths
};
/// Makes the mesh of polylines. Its indices are in the order of the segments.
[[nodiscard]] Mesh make_lines(LineSet lines, const std::shared_ptr<Budget>& budget);

/// Points with their properties; see LineSet.
struct PointCloud {
  MFVec3f points;
  MFColor colors;
  Array<float> opacities, fog_depths;
  MFVec3f normals;
  glm::dvec3 origin{0};
};
[[nodiscard]] Mesh make_points(PointCloud cloud, const std::shared_ptr<Budget>& budget);

}  // namespace gs::vrml
