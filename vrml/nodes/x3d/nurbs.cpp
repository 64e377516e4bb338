#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"
#include "vrml/tessellation/tessellators.h"

// Rows of the X3D component NURBS (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kNurbsX3DRows[] = {
    {"Contour2D", "NURBS", 4, "trimmingContour", "X3DNode", Role::none, NodeKind::other, R"(
  eventIn      MFNode     addChildren  # NurbsCurve2D,ContourPolyline2D
  eventIn      MFNode     removeChildren  # NurbsCurve2D,ContourPolyline2D
  exposedField MFNode     children []  # NurbsCurve2D,ContourPolyline2D
)"},
    {"ContourPolyline2D", "NURBS", 3, "children", "X3DNurbsControlCurveNode", Role::none, NodeKind::other, R"(
  exposedField MFVec2d    controlPoint []
)"},
    {"NurbsCurve", "NURBS", 1, "geometry", "X3DParametricGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField SFNode     controlPoint NULL  # Coordinate,CoordinateDouble
  exposedField SFInt32    tessellation 0
  exposedField MFDouble   weight []  # (0,inf)
  field        SFBool     closed FALSE
  field        MFDouble   knot []
  field        SFInt32    order 3  # [2,inf)
)",
     tessellate_nurbs_curve},
    {"NurbsCurve2D", "NURBS", 3, "children", "X3DNurbsControlCurveNode", Role::none, NodeKind::other, R"(
  exposedField MFVec2d    controlPoint []
  exposedField SFInt32    tessellation 0
  exposedField MFDouble   weight []  # (0,inf)
  field        SFBool     closed FALSE
  field        MFDouble   knot []
  field        SFInt32    order 3  # [2,inf)
)"},
    {"NurbsOrientationInterpolator",
     "NURBS",
     1,
     "children",
     "X3DChildNode",
     Role::child,
     NodeKind::other,
     R"(
  eventIn      SFFloat    set_fraction
  exposedField SFNode     controlPoint NULL  # Coordinate,CoordinateDouble
  exposedField MFDouble   knot []
  exposedField SFInt32    order 3  # [2,inf)
  exposedField MFDouble   weight []
  eventOut     SFRotation value_changed
)",
     {},
     &kNurbsOrientationInterpolatorBehaviour},
    {"NurbsPatchSurface",
     "NURBS",
     1,
     "geometry",
     "X3DNurbsSurfaceGeometryNode",
     Role::geometry,
     NodeKind::other,
     R"(
  exposedField SFNode     controlPoint NULL  # Coordinate,CoordinateDouble
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,NurbsTextureCoordinate
  exposedField SFInt32    uTessellation 0
  exposedField SFInt32    vTessellation 0
  exposedField MFDouble   weight []  # (0,inf)
  field        SFBool     solid TRUE
  field        SFBool     uClosed FALSE
  field        SFInt32    uDimension 0  # [0,inf)
  field        MFDouble   uKnot []
  field        SFInt32    uOrder 3  # [2,inf)
  field        SFBool     vClosed FALSE
  field        SFInt32    vDimension 0  # [0,inf)
  field        MFDouble   vKnot []
  field        SFInt32    vOrder 3  # [2,inf)
)",
     {tessellate_nurbs_surface, nullptr, cost_of_nurbs_surface}},
    {"NurbsPositionInterpolator",
     "NURBS",
     1,
     "children",
     "X3DChildNode",
     Role::child,
     NodeKind::other,
     R"(
  eventIn      SFFloat    set_fraction
  exposedField SFNode     controlPoint NULL  # Coordinate,CoordinateDouble
  exposedField MFDouble   knot []
  exposedField SFInt32    order 3  # [2,inf)
  exposedField MFDouble   weight []
  eventOut     SFVec3f    value_changed
)",
     {},
     &kNurbsCurvePositionBehaviour},
    {"NurbsSet", "NURBS", 2, "children", "X3DChildNode X3DBoundedObject", Role::child, NodeKind::other, R"(
  eventIn      MFNode     addGeometry  # X3DParametricGeometryNode
  eventIn      MFNode     removeGeometry  # X3DParametricGeometryNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     geometry []  # X3DParametricGeometryNode
  exposedField SFFloat    tessellationScale 1.0  # (0,inf)
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"NurbsSurfaceInterpolator",
     "NURBS",
     1,
     "children",
     "X3DChildNode",
     Role::child,
     NodeKind::other,
     R"(
  eventIn      SFVec2f    set_fraction
  exposedField SFNode     controlPoint NULL  # Coordinate,CoordinateDouble
  exposedField MFDouble   weight []
  field        SFInt32    uDimension 0  # [0,inf)
  field        MFDouble   uKnot []
  field        SFInt32    uOrder 3  # [2,inf)
  field        SFInt32    vDimension 0  # [0,inf)
  field        MFDouble   vKnot []
  field        SFInt32    vOrder 3  # [2,inf)
  eventOut     SFVec3f    normal_changed
  eventOut     SFVec3f    position_changed
)",
     {},
     &kNurbsSurfaceInterpolatorBehaviour},
    {"NurbsSweptSurface", "NURBS", 3, "geometry", "X3DParametricGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField SFNode     crossSectionCurve NULL  # X3DNurbsControlCurveNode
  exposedField SFNode     trajectoryCurve NULL  # NurbsCurve
  field        SFBool     ccw TRUE
  field        SFBool     solid TRUE
)",
     tessellate_nurbs_swept_surface},
    {"NurbsSwungSurface", "NURBS", 3, "geometry", "X3DParametricGeometryNode", Role::geometry, NodeKind::other, R"(
  exposedField SFNode     profileCurve NULL  # X3DNurbsControlCurveNode
  exposedField SFNode     trajectoryCurve NULL  # X3DNurbsControlCurveNode
  field        SFBool     ccw TRUE
  field        SFBool     solid TRUE
)",
     tessellate_nurbs_swung_surface},
    {"NurbsTextureCoordinate", "NURBS", 1, "texCoord", "X3DNode", Role::geometric_property,
     NodeKind::nurbs_texture_surface, R"(
  exposedField MFVec2f    controlPoint []
  exposedField MFDouble   weight []  # (0,inf)
  field        SFInt32    uDimension 0  # [0,inf)
  field        MFDouble   uKnot []
  field        SFInt32    uOrder 3  # [2,inf)
  field        SFInt32    vDimension 0  # [0,inf)
  field        MFDouble   vKnot []
  field        SFInt32    vOrder 3  # [2,inf)
)"},
    {"NurbsTrimmedSurface",
     "NURBS",
     4,
     "geometry",
     "X3DNurbsSurfaceGeometryNode",
     Role::geometry,
     NodeKind::other,
     R"(
  eventIn      MFNode     addTrimmingContour  # Contour2D
  eventIn      MFNode     removeTrimmingContour  # Contour2D
  exposedField SFNode     controlPoint NULL  # Coordinate,CoordinateDouble
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode,NurbsTextureCoordinate
  exposedField MFNode     trimmingContour []  # Contour2D
  exposedField SFInt32    uTessellation 0
  exposedField SFInt32    vTessellation 0
  exposedField MFDouble   weight []  # (0,inf)
  field        SFBool     solid TRUE
  field        SFBool     uClosed FALSE
  field        SFInt32    uDimension 0  # [0,inf)
  field        MFDouble   uKnot []
  field        SFInt32    uOrder 3  # [2,inf)
  field        SFBool     vClosed FALSE
  field        SFInt32    vDimension 0  # [0,inf)
  field        MFDouble   vKnot []
  field        SFInt32    vOrder 3  # [2,inf)
)",
     {tessellate_nurbs_trimmed_surface, nullptr, cost_of_nurbs_surface}},
};

}  // namespace

std::span<const X3DRow> x3d_nurbs_rows() { return kNurbsX3DRows; }

}  // namespace gs::vrml
