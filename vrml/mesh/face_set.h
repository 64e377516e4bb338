#pragma once

#include "base/budget.h"
#include "vrml/mesh/attribute.h"
#include "vrml/mesh/mesh.h"

#include <memory>
#include <vector>

namespace gs::vrml {

/// Faces in the form of IndexedFaceSet (VRML97 6.23). ElevationGrid and Extrusion are converted to this form. Arrays
/// share storage with fields if the mesh can use them unchanged.
struct FaceSet {
  MFInt32 coord_index;
  MFVec3f points;
  Attribute<glm::vec3> normal;  // if there are none, generated with crease_angle
  Attribute<Color> color;
  Array<float> opacities;  // empty, or one per element of color.values
  Array<float> fog_depths;  // empty, or one per point; missing values repeat the last one
  Attribute<glm::vec2> texture_coordinate;
  /// All sets of texture coordinates, if there are several or if they have more than two components. The binding of
  /// `texture_coordinate`, which has the first set, holds for each of them.
  std::vector<CoordinateSet> coordinate_sets;
  bool default_texture_coordinates = false;  // if there are no coordinates, uses the bounding-box mapping of 6.23
  bool ccw = true;
  bool convex = true;
  bool solid = true;
  float crease_angle = 0;
  std::shared_ptr<Budget> budget;  // limits working memory; null means unlimited
};

/// Triangulates the faces. Normalizes given normals; a missing or zero normal becomes that of the face. A missing
/// colour becomes that of the vertex or the last one, a missing texture coordinate (0, 0). Drops faces without area if
/// all normals are generated and flat. If the budget does not allow the work, the mesh has no face and `limited` is
/// set; if the budget stops it, the mesh keeps the faces made so far.
[[nodiscard]] Mesh make_mesh(FaceSet faces);

/// Appends the triangles of `more` to `mesh`. Pads an attribute that only one of the two has: normals and texture
/// coordinates with zeros, colours with white.
void append(Mesh& mesh, const Mesh& more);

}  // namespace gs::vrml
