#include "vrml/nodes/vrml97_equivalents.h"

#include "vrml/printing/equivalents.h"

#include <algorithm>
#include <iterator>

namespace gs::vrml {
namespace {

// Nodes of VRML97 that are written for nodes that only X3D has. Other geometry nodes are tessellated; other nodes are
// left out.
constexpr Vrml97Equivalent kEquivalents[] = {
    {"CADAssembly", "Group"},
    {"CADFace", "Group", group_of_cad_face},
    {"CADLayer", "Group"},
    {"CADPart", "Transform"},
    {"ColorRGBA", "Color", color_of_color_rgba, "ColorRGBA becomes Color: the transparency is left out"},
    {"CoordinateDouble", "Coordinate", coordinate_of_doubles,
     "CoordinateDouble becomes Coordinate: numbers have single precision"},
    {"HAnimHumanoid", "Transform", transform_of_humanoid,
     "HAnimHumanoid becomes Transform: the skin does not move with the joints"},
    {"HAnimJoint", "Transform"},
    {"HAnimSegment", "Group"},
    {"HAnimSite", "Transform"},
    {"IndexedQuadSet", "IndexedFaceSet", faces_of_quad_set},
    {"IndexedTriangleFanSet", "IndexedFaceSet", faces_of_triangle_fan_set},
    {"IndexedTriangleSet", "IndexedFaceSet", faces_of_triangle_set},
    {"IndexedTriangleStripSet", "IndexedFaceSet", faces_of_triangle_strip_set},
    {"LineSet", "IndexedLineSet", lines_of_line_set},
    {"OrthoViewpoint", "Viewpoint", viewpoint_of_ortho,
     "OrthoViewpoint becomes Viewpoint: the parallel view becomes a narrow perspective"},
    {"PhysicalMaterial", "Material", material_of_physical,
     "PhysicalMaterial becomes Material: metallic, roughness and textures are left out"},
    {"PickableGroup", "Group"},
    {"QuadSet", "IndexedFaceSet", faces_of_quad_set},
    {"StaticGroup", "Group"},
    {"TextureBackground", "Background", nullptr, "TextureBackground becomes Background: the textures are left out"},
    {"TriangleFanSet", "IndexedFaceSet", faces_of_triangle_fan_set},
    {"TriangleSet", "IndexedFaceSet", faces_of_triangle_set},
    {"TriangleStripSet", "IndexedFaceSet", faces_of_triangle_strip_set},
    {"TwoSidedMaterial", "Material", nullptr,
     "TwoSidedMaterial becomes Material: the colours of back faces are left out"},
    {"UnlitMaterial", "Material", material_of_unlit},
    {"ViewpointGroup", "Group"},
};
constexpr Vrml97Equivalent kTessellated{{}, "IndexedFaceSet", tessellated_node};

}  // namespace

const Vrml97Equivalent* vrml97_equivalent(const NodeType& type) {
  const auto* const found = std::find_if(std::begin(kEquivalents), std::end(kEquivalents),
                                         [&](const Vrml97Equivalent& each) { return each.x3d_type == type.name; });
  if (found != std::end(kEquivalents)) return found;
  return has(type.role, Role::geometry) && type.tessellator.tessellate ? &kTessellated : nullptr;
}

}  // namespace gs::vrml
