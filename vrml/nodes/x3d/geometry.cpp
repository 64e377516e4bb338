#include "vrml/nodes/x3d/components.h"
#include "vrml/tessellation/tessellators.h"

// Rows of the X3D components Geometry2D, Geometry3D (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kGeometryX3DRows[] = {
    {"Arc2D", "Geometry2D", 2, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        SFFloat    endAngle 1.570796  # (-6.2832,6.2832)
  field        SFFloat    radius 1  # (0,inf)
  field        SFFloat    startAngle 0  # (-6.2832,6.2832)
)",
     tessellate_arc_2d},
    {"ArcClose2D", "Geometry2D", 2, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        SFString   closureType "PIE"
  field        SFFloat    endAngle 1.570796  # (-6.2832,6.2832)
  field        SFFloat    radius 1  # (0,inf)
  field        SFBool     solid FALSE
  field        SFFloat    startAngle 0  # (-6.2832,6.2832)
)",
     tessellate_arc_close_2d},
    {"Box", "Geometry3D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        SFVec3f    size 2 2 2
  field        SFBool     solid TRUE
)"},
    {"Circle2D", "Geometry2D", 2, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        SFFloat    radius 1  # (0,inf)
)",
     tessellate_circle_2d},
    {"Cone", "Geometry3D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField SFBool     bottom TRUE
  exposedField SFBool     side TRUE
  field        SFFloat    bottomRadius 1  # (0,inf)
  field        SFFloat    height 2  # (0,inf)
  field        SFBool     solid TRUE
)"},
    {"Cylinder", "Geometry3D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField SFBool     bottom TRUE
  exposedField SFBool     side TRUE
  exposedField SFBool     top TRUE
  field        SFFloat    height 2  # (0,inf)
  field        SFFloat    radius 1  # (0,inf)
  field        SFBool     solid TRUE
)"},
    {"Disk2D", "Geometry2D", 2, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        SFFloat    innerRadius 0  # [0,inf)
  field        SFFloat    outerRadius 1  # (0,inf)
  field        SFBool     solid FALSE
)",
     tessellate_disk_2d},
    {"ElevationGrid", "Geometry3D", 3, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  eventIn      MFFloat    set_height
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        SFFloat    creaseAngle 0  # [0,inf)
  field        MFFloat    height []
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
  field        SFInt32    xDimension 0  # [0,inf)
  field        SFFloat    xSpacing 1.0  # (0,inf)
  field        SFInt32    zDimension 0  # [0,inf)
  field        SFFloat    zSpacing 1.0  # (0,inf)
)"},
    {"Extrusion", "Geometry3D", 4, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  eventIn      MFVec2f    set_crossSection
  eventIn      MFRotation set_orientation
  eventIn      MFVec2f    set_scale
  eventIn      MFVec3f    set_spine
  field        SFBool     beginCap TRUE
  field        SFBool     ccw TRUE
  field        SFBool     convex TRUE
  field        SFFloat    creaseAngle 0  # [0,inf)
  field        MFVec2f    crossSection [1 1 1 -1 -1 -1 -1 1 1 1]
  field        SFBool     endCap TRUE
  field        MFRotation orientation [0 0 1 0]
  field        MFVec2f    scale [1 1]
  field        SFBool     solid TRUE
  field        MFVec3f    spine [0 0 0 0 1 0]
)"},
    {"IndexedFaceSet", "Geometry3D", 2, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other, R"(
  eventIn      MFInt32    set_colorIndex  # [-1,inf)
  eventIn      MFInt32    set_coordIndex  # [-1,inf)
  eventIn      MFInt32    set_normalIndex  # [-1,inf)
  eventIn      MFInt32    set_texCoordIndex  # [-1,inf)
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,MultiTextureCoordinate
  field        SFBool     ccw TRUE
  field        MFInt32    colorIndex []  # [-1,inf)
  field        SFBool     colorPerVertex TRUE
  field        SFBool     convex TRUE
  field        MFInt32    coordIndex []  # [-1,inf)
  field        SFFloat    creaseAngle 0  # [0,inf)
  field        MFInt32    normalIndex []  # [-1,inf)
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
  field        MFInt32    texCoordIndex []  # [-1,inf)
)"},
    {"Polyline2D", "Geometry2D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        MFVec2f    lineSegments []
)",
     tessellate_polyline_2d},
    {"Polypoint2D", "Geometry2D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField MFVec2f    point []
)",
     tessellate_polypoint_2d},
    {"Rectangle2D", "Geometry2D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        SFVec2f    size 2 2
  field        SFBool     solid FALSE
)",
     tessellate_rectangle_2d},
    {"Sphere", "Geometry3D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  field        SFFloat    radius 1  # (0,inf)
  field        SFBool     solid TRUE
)"},
    {"TriangleSet2D", "Geometry2D", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField MFVec2f    vertices []
  field        SFBool     solid FALSE
)",
     tessellate_triangle_set_2d},
};

}  // namespace

std::span<const X3DRow> x3d_geometry_rows() { return kGeometryX3DRows; }

}  // namespace gs::vrml
