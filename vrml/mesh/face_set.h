#pragma once

#include "vrml/mesh/attribute.h"
#include "vrml/mesh/mesh.h"
#include "vrml/scene/budget.h"

#include <memory>

namespace gs::vrml {

/// Faces as IndexedFaceSet describes them (VRML97 6.23): what ElevationGrid and Extrusion are turned
/// into as well. Arrays may be shared with fields and stay shared where the mesh can use them as they are.
struct FaceSet {
  MFInt32 coord_index;
  MFVec3f points;
  Attribute<glm::vec3> normal;  // none: generated with crease_angle
  Attribute<Color> color;
  Attribute<glm::vec2> texture_coordinate;
  bool default_texture_coordinates = false;  // where there are none: those of 6.23, by the bounding box
  bool ccw = true;
  bool convex = true;
  bool solid = true;
  float crease_angle = 0;
  std::shared_ptr<Budget> budget;  // that the memory for the work is drawn from; null: none
};

/// The triangles of the faces. Given normals are made unit vectors; a corner whose normal is missing
/// or has no direction gets that of its face. A missing colour is the one of the corner's vertex or
/// the last one, a missing texture coordinate is (0, 0). Where all normals are generated and flat,
/// faces without area are dropped. Without a face, and `left_out`, where the budget does not allow the work; with those
/// that were made where it stops.
[[nodiscard]] Mesh make_mesh(FaceSet faces);

/// Puts the triangles of `more` behind those of `mesh`. An attribute that only one of them has is
/// filled up: normals and texture coordinates with zeros, colours with white.
void append(Mesh& mesh, const Mesh& more);

}  // namespace gs::vrml
