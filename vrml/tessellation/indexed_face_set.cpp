#include "vrml/mesh/face_set.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <utility>

namespace gs::vrml {

Mesh tessellate_indexed_face_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  FaceSet faces;
  faces.coord_index = scene.get<MFInt32>(geometry, "coordIndex");
  faces.points = coordinates_of(scene, geometry);
  faces.normal = {normals_of(scene, geometry), scene.get<SFBool>(geometry, "normalPerVertex"),
                  scene.get<MFInt32>(geometry, "normalIndex")};
  faces.color = {colors_of(scene, geometry), scene.get<SFBool>(geometry, "colorPerVertex"),
                 scene.get<MFInt32>(geometry, "colorIndex")};
  TextureCoordinates coordinates = texture_coordinate_sets_of(scene, geometry);
  faces.texture_coordinate = {std::move(coordinates.first), true, scene.get<MFInt32>(geometry, "texCoordIndex")};
  faces.coordinate_sets = std::move(coordinates.sets);
  faces.default_texture_coordinates = options.texture_coordinates;
  faces.ccw = scene.get<SFBool>(geometry, "ccw");
  faces.convex = scene.get<SFBool>(geometry, "convex");
  faces.solid = scene.get<SFBool>(geometry, "solid");
  faces.crease_angle = scene.get<SFFloat>(geometry, "creaseAngle");
  faces.budget = scene.budget();
  return make_mesh(std::move(faces));
}

}  // namespace gs::vrml
