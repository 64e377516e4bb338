#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"
#include "vrml/tessellation/tessellators.h"

// Rows of the X3D component CADGeometry (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kCadX3DRows[] = {
    {"CADAssembly", "CADGeometry", 2, "children", "X3DGroupingNode X3DProductStructureChildNode",
     Role::child | Role::grouping, NodeKind::group, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFString   name ""
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kGroupBehaviour},
    {"CADFace", "CADGeometry", 2, "children", "X3DProductStructureChildNode X3DBoundedObject", Role::child,
     NodeKind::cad_face, R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFString   name ""
  exposedField SFNode     shape NULL  # Shape,LOD,Transform
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"CADLayer", "CADGeometry", 2, "children", "X3DGroupingNode", Role::child | Role::grouping, NodeKind::group, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFString   name ""
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kGroupBehaviour},
    {"CADPart", "CADGeometry", 2, "children", "X3DProductStructureChildNode X3DGroupingNode",
     Role::child | Role::grouping, NodeKind::transform, R"(
  eventIn      MFNode     addChildren  # CADFace
  eventIn      MFNode     removeChildren  # CADFace
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    center 0 0 0
  exposedField MFNode     children []  # CADFace
  exposedField SFString   name ""
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    scale 1 1 1
  exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField SFVec3f    translation 0 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kTransformBehaviour},
    {"IndexedQuadSet", "CADGeometry", 1, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other, R"(
  eventIn      MFInt32    set_index  # [0,inf)
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,MultiTextureCoordinate
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        MFInt32    index []  # [0,inf)
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
)",
     tessellate_indexed_quad_set},
    {"QuadSet", "CADGeometry", 1, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,MultiTextureCoordinate
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
)",
     tessellate_quad_set},
};

// Types of X3D 3 that have other fields in X3D 4.
constexpr X3DRow kFormerX3DRows[] = {
    {"CADLayer", "CADGeometry", 2, "children", "X3DGroupingNode", Role::child | Role::grouping, NodeKind::group, R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFString   name ""
  exposedField MFBool     visible []
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)",
     nullptr, &kGroupBehaviour},
};

}  // namespace

std::span<const X3DRow> x3d_cad_rows() { return kCadX3DRows; }
std::span<const X3DRow> x3d_former_rows() { return kFormerX3DRows; }

}  // namespace gs::vrml
