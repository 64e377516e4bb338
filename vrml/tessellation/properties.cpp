#include "vrml/tessellation/properties.h"

namespace gs::vrml {

Coordinates coordinates_of(const SceneGraph& scene, NodeId geometry) {
  return {property_of<MFVec3f>(scene, geometry, "coord", NodeKind::coordinate, "point")};
}

Colors colors_of(const SceneGraph& scene, NodeId geometry) {
  return {property_of<MFColor>(scene, geometry, "color", NodeKind::color, "color"), {}};
}

void set_properties(FaceSet& faces, const SceneGraph& scene, NodeId geometry, MFInt32 color_index,
                    MFInt32 normal_index) {
  Colors colors = colors_of(scene, geometry);
  faces.color = {std::move(colors.colors), scene.get<SFBool>(geometry, "colorPerVertex"), std::move(color_index)};
  faces.opacities = std::move(colors.opacities);
  faces.normal = {normals_of(scene, geometry), scene.get<SFBool>(geometry, "normalPerVertex"), std::move(normal_index)};
  faces.fog_depths = fog_depths_of(scene, geometry);
}

}  // namespace gs::vrml
