#include "vrml/nodes/families.h"
#include "vrml/tessellation/tessellators.h"

namespace gs::vrml {
namespace {

// Rows of the geometry nodes (VRML97 4.6.3), with their tessellators. QNV and OutlineGroup are extensions
// (docs/formats.md); the renderer draws a QNV from the vectors of its stream.
constexpr NodeRow kGeometryRows[] = {
    {"Box",
     "6.7",
     Role::geometry,
     NodeKind::other,
     R"(
  field        SFVec3f    size             2 2 2            # (0,inf)
)",
     {tessellate_box, scale_of_box}},
    {"Cone",
     "6.11",
     Role::geometry,
     NodeKind::other,
     R"(
  field        SFFloat    bottomRadius     1                # (0,inf)
  field        SFFloat    height           2                # (0,inf)
  field        SFBool     side             TRUE
  field        SFBool     bottom           TRUE
)",
     {tessellate_cone, scale_of_cone}},
    {"Cylinder",
     "6.14",
     Role::geometry,
     NodeKind::other,
     R"(
  field        SFBool     bottom           TRUE
  field        SFFloat    height           2                # (0,inf)
  field        SFFloat    radius           1                # (0,inf)
  field        SFBool     side             TRUE
  field        SFBool     top              TRUE
)",
     {tessellate_cylinder, scale_of_cylinder}},
    {"ElevationGrid",
     "6.17",
     Role::geometry,
     NodeKind::other,
     R"(
  eventIn      MFFloat    set_height
  exposedField SFNode     color            NULL
  exposedField SFNode     normal           NULL
  exposedField SFNode     texCoord         NULL
  field        MFFloat    height           []               # (-inf,inf)
  field        SFBool     ccw              TRUE
  field        SFBool     colorPerVertex   TRUE
  field        SFFloat    creaseAngle      0                # [0,inf]
  field        SFBool     normalPerVertex  TRUE
  field        SFBool     solid            TRUE
  field        SFInt32    xDimension       0                # [0,inf)
  field        SFFloat    xSpacing         1.0              # (0,inf)
  field        SFInt32    zDimension       0                # [0,inf)
  field        SFFloat    zSpacing         1.0              # (0,inf)
)",
     {tessellate_elevation_grid, nullptr, cost_of_elevation_grid}},
    {"Extrusion",
     "6.18",
     Role::geometry,
     NodeKind::other,
     R"(
  eventIn      MFVec2f    set_crossSection
  eventIn      MFRotation set_orientation
  eventIn      MFVec2f    set_scale
  eventIn      MFVec3f    set_spine
  field        SFBool     beginCap         TRUE
  field        SFBool     ccw              TRUE
  field        SFBool     convex           TRUE
  field        SFFloat    creaseAngle      0                # [0,inf)
  field        MFVec2f    crossSection     [ 1 1, 1 -1, -1 -1, -1 1, 1  1 ]  # (-inf,inf)
  field        SFBool     endCap           TRUE
  field        MFRotation orientation      0 0 1 0          # [-1,1],(-inf,inf)
  field        MFVec2f    scale            1 1              # (0,inf)
  field        SFBool     solid            TRUE
  field        MFVec3f    spine            [ 0 0 0, 0 1 0 ]  # (-inf,inf)
)",
     {tessellate_extrusion, nullptr, cost_of_extrusion}},
    {"IndexedFaceSet", "6.23", Role::geometry, NodeKind::indexed_face_set, R"(
  eventIn      MFInt32    set_colorIndex
  eventIn      MFInt32    set_coordIndex
  eventIn      MFInt32    set_normalIndex
  eventIn      MFInt32    set_texCoordIndex
  exposedField SFNode     color            NULL
  exposedField SFNode     coord            NULL
  exposedField SFNode     normal           NULL
  exposedField SFNode     texCoord         NULL
  field        SFBool     ccw              TRUE
  field        MFInt32    colorIndex       []               # [-1,inf)
  field        SFBool     colorPerVertex   TRUE
  field        SFBool     convex           TRUE
  field        MFInt32    coordIndex       []               # [-1,inf)
  field        SFFloat    creaseAngle      0                # [0,inf)
  field        MFInt32    normalIndex      []               # [-1,inf)
  field        SFBool     normalPerVertex  TRUE
  field        SFBool     solid            TRUE
  field        MFInt32    texCoordIndex    []               # [-1,inf)
)",
     tessellate_indexed_face_set},
    {"IndexedLineSet", "6.24", Role::geometry, NodeKind::indexed_line_set, R"(
  eventIn      MFInt32    set_colorIndex
  eventIn      MFInt32    set_coordIndex
  exposedField SFNode     color            NULL
  exposedField SFNode     coord            NULL
  field        MFInt32    colorIndex       []               # [-1,inf)
  field        SFBool     colorPerVertex   TRUE
  field        MFInt32    coordIndex       []               # [-1,inf)
)",
     tessellate_indexed_line_set},
    {"NurbsCurve", kAmendmentClause, Role::geometry, NodeKind::other, R"(
  exposedField MFVec3f    controlPoint     []               # (-inf,inf)
  exposedField SFInt32    tessellation     0                # (-inf,inf)
  exposedField MFFloat    weight           []               # (0,inf)
  field        MFFloat    knot             []               # (-inf,inf)
  field        SFInt32    order            3                # [2,inf)
)",
     tessellate_nurbs_curve},
    {"NurbsSurface",
     kAmendmentClause,
     Role::geometry,
     NodeKind::other,
     R"(
  exposedField MFVec3f    controlPoint     []               # (-inf,inf)
  exposedField SFNode     texCoord         NULL
  exposedField SFInt32    uTessellation    0                # (-inf,inf)
  exposedField SFInt32    vTessellation    0                # (-inf,inf)
  exposedField MFFloat    weight           []               # (0,inf)
  field        SFBool     ccw              TRUE
  field        SFBool     solid            TRUE
  field        SFInt32    uDimension       0                # [0,inf)
  field        MFFloat    uKnot            []               # (-inf,inf)
  field        SFInt32    uOrder           3                # [2,inf)
  field        SFInt32    vDimension       0                # [0,inf)
  field        MFFloat    vKnot            []               # (-inf,inf)
  field        SFInt32    vOrder           3                # [2,inf)
)",
     {tessellate_nurbs_surface, nullptr, cost_of_nurbs_surface}},
    {"OutlineGroup", "GhostSpace", Role::geometry, NodeKind::outline_group, R"(
  exposedField MFString   url              []
  exposedField SFBool     complete         FALSE
  exposedField SFNode     refines          NULL
  field        SFFloat    creaseAngle      0                # [0,inf)
  field        SFBool     solid            TRUE
  field        MFInt32    outlineGroup     []               # [0,inf)
  field        MFInt32    groupSize        []               # [0,inf)
  field        MFVec3f    outline          []               # (-inf,inf)
  field        MFInt32    outlineIndex     []               # [-1,inf)
  field        MFVec2f    outlineTexCoord  []               # (-inf,inf)
  field        MFInt32    group            []               # [-1,inf)
  field        MFVec3f    point            []               # (-inf,inf)
  field        MFInt32    coordIndex       []               # [-1,inf)
  field        MFVec2f    texCoord         []               # (-inf,inf)
)",
     tessellate_outline_group, nullptr, UrlContent::outlines},
    {"PointSet", "6.36", Role::geometry, NodeKind::point_set, R"(
  exposedField SFNode     color            NULL
  exposedField SFNode     coord            NULL
)",
     tessellate_point_set},
    {"QNV", "GhostSpace", Role::geometry, NodeKind::qnv, R"(
  exposedField MFString   url              []
  exposedField SFFloat    detail           1                # (0,inf)
  exposedField SFString   profile          "SURFACE"
  exposedField MFFloat    transfer         []               # [0,1]
  field        MFInt32    vectors          []               # (-inf,inf)
  field        SFVec3f    bboxCenter       0 0 0            # (-inf,inf)
  field        SFVec3f    bboxSize         -1 -1 -1         # (0,inf) or -1,-1,-1
  eventOut     SFFloat    progress_changed
  eventOut     SFTime     loadTime
)",
     nullptr, nullptr, UrlContent::vectors},
    {"Sphere",
     "6.43",
     Role::geometry,
     NodeKind::other,
     R"(
  field        SFFloat    radius           1                # (0,inf)
)",
     {tessellate_sphere, scale_of_sphere}},
    {"Text",
     "6.47",
     Role::geometry | Role::viewer_dependent,
     NodeKind::other,
     R"(
  exposedField MFString   string           []
  exposedField SFNode     fontStyle        NULL
  exposedField MFFloat    length           []               # [0,inf)
  exposedField SFFloat    maxExtent        0.0              # [0,inf)
)",
     {tessellate_text, nullptr, cost_of_text}},
};

}  // namespace

std::span<const NodeRow> geometry_rows() { return kGeometryRows; }

}  // namespace gs::vrml
