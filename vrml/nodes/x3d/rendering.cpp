#include "vrml/nodes/x3d/components.h"
#include "vrml/tessellation/tessellators.h"

// Rows of the X3D component Rendering (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kRenderingX3DRows[] = {
    {"ClipPlane", "Rendering", 5, "children", "X3DChildNode", Role::child, NodeKind::clip_plane, R"(
  exposedField SFBool     enabled TRUE
  exposedField SFVec4f    plane 0 1 0 0  # [-1,1]
)"},
    {"Color", "Rendering", 1, "color", "X3DColorNode", Role::geometric_property, NodeKind::other, R"(
  exposedField MFColor    color []  # [0,1]
)"},
    {"ColorRGBA", "Rendering", 1, "color", "X3DColorNode", Role::geometric_property, NodeKind::color_rgba, R"(
  exposedField MFColorRGBA color []  # [0,1]
)"},
    {"Coordinate", "Rendering", 1, "coord", "X3DCoordinateNode", Role::geometric_property, NodeKind::other, R"(
  exposedField MFVec3f    point []
)"},
    {"CoordinateDouble", "Rendering", 1, "coord", "X3DCoordinateNode", Role::geometric_property,
     NodeKind::coordinate_double, R"(
  exposedField MFVec3d    point []
)"},
    {"IndexedLineSet", "Rendering", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  eventIn      MFInt32    set_colorIndex  # [-1,inf)
  eventIn      MFInt32    set_coordIndex  # [-1,inf)
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  field        MFInt32    colorIndex []  # [-1,inf)
  field        SFBool     colorPerVertex TRUE
  field        MFInt32    coordIndex []  # [-1,inf)
)"},
    {"IndexedTriangleFanSet", "Rendering", 3, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other,
     R"(
  eventIn      MFInt32    set_index  # [-1,inf)
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,MultiTextureCoordinate
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        MFInt32    index []  # [-1,inf)
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
)",
     tessellate_indexed_triangle_fan_set},
    {"IndexedTriangleSet", "Rendering", 3, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other, R"(
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
     tessellate_indexed_triangle_set},
    {"IndexedTriangleStripSet", "Rendering", 3, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other,
     R"(
  eventIn      MFInt32    set_index  # [-1,inf)
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,MultiTextureCoordinate
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        MFInt32    index []  # [-1,inf)
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
)",
     tessellate_indexed_triangle_strip_set},
    {"LineSet", "Rendering", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField MFInt32    vertexCount []  # [2,inf)
)",
     tessellate_line_set},
    {"Normal", "Rendering", 2, "normal", "X3DNormalNode", Role::geometric_property, NodeKind::other, R"(
  exposedField MFVec3f    vector []  # [-1,1]
)"},
    {"PointSet", "Rendering", 1, "geometry", "X3DGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
)"},
    {"TriangleFanSet", "Rendering", 3, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField MFInt32    fanCount []  # [3,inf)
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,MultiTextureCoordinate
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
)",
     tessellate_triangle_fan_set},
    {"TriangleSet", "Rendering", 3, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other, R"(
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
     tessellate_triangle_set},
    {"TriangleStripSet", "Rendering", 3, "geometry", "X3DComposedGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField MFNode     attrib []  # X3DVertexAttributeNode
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFNode     fogCoord NULL  # FogCoordinate
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField MFInt32    stripCount []  # [3,inf)
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,MultiTextureCoordinate
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
)",
     tessellate_triangle_strip_set},
};

}  // namespace

std::span<const X3DRow> x3d_rendering_rows() { return kRenderingX3DRows; }

}  // namespace gs::vrml
