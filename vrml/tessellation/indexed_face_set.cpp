#include "vrml/mesh/face_set.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <utility>

namespace gs::vrml {

Mesh tessellate_indexed_face_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  FaceSet faces;
  faces.coord_index = scene.get<MFInt32>(geometry, "coordIndex");
  Coordinates coordinates = coordinates_of(scene, geometry);
  faces.points = std::move(coordinates.points);
  set_properties(faces, scene, geometry, scene.get<MFInt32>(geometry, "colorIndex"),
                 scene.get<MFInt32>(geometry, "normalIndex"));
  set_texture_coordinates(faces, scene, geometry, scene.get<MFInt32>(geometry, "texCoordIndex"));
  faces.default_texture_coordinates = options.texture_coordinates;
  faces.ccw = scene.get<SFBool>(geometry, "ccw");
  faces.convex = scene.get<SFBool>(geometry, "convex");
  faces.solid = scene.get<SFBool>(geometry, "solid");
  faces.crease_angle = scene.get<SFFloat>(geometry, "creaseAngle");
  faces.budget = scene.budget();
  Mesh mesh = make_mesh(std::move(faces));
  mesh.origin = coordinates.origin;
  return mesh;
}

}  // namespace gs::vrml
