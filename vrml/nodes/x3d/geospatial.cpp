#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"
#include "vrml/tessellation/tessellators.h"

// Rows of the X3D component Geospatial (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kGeospatialX3DRows[] = {
    {"GeoCoordinate", "Geospatial", 1, "coord", "X3DCoordinateNode", Role::geometric_property, NodeKind::geo_coordinate,
     R"(
  exposedField MFVec3d    point []
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
)"},
    {"GeoElevationGrid",
     "Geospatial",
     1,
     "geometry",
     "X3DGeometryNode",
     Role::geometry,
     NodeKind::other,
     R"(
  eventIn      MFDouble   set_height
  exposedField SFNode     color NULL  # X3DColorNode
  exposedField SFNode     normal NULL  # X3DNormalNode
  exposedField SFNode     texCoord NULL  # X3DSingleTextureCoordinateNode
  exposedField SFFloat    yScale 1  # [0,inf)
  field        SFBool     ccw TRUE
  field        SFBool     colorPerVertex TRUE
  field        SFDouble   creaseAngle 0  # [0,inf)
  field        SFVec3d    geoGridOrigin 0 0 0
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
  field        MFDouble   height [0 0]
  field        SFBool     normalPerVertex TRUE
  field        SFBool     solid TRUE
  field        SFInt32    xDimension 0  # [0,inf)
  field        SFDouble   xSpacing 1.0  # (0,inf)
  field        SFInt32    zDimension 0  # [0,inf)
  field        SFDouble   zSpacing 1.0  # (0,inf)
)",
     {tessellate_geo_elevation_grid, nullptr, cost_of_geo_elevation_grid}},
    {"GeoLOD", "Geospatial", 1, "children", "X3DChildNode X3DBoundedObject", Role::child | Role::grouping,
     NodeKind::geo_lod, R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFVec3d    center 0 0 0
  field        MFString   child1Url []
  field        MFString   child2Url []
  field        MFString   child3Url []
  field        MFString   child4Url []
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
  field        SFFloat    range 10  # [0,inf)
  field        MFNode     rootNode []  # X3DChildNode
  field        MFString   rootUrl []
  eventOut     MFNode     children  # X3DChildNode
  eventOut     SFInt32    level_changed  # [0,1]
)",
     {},
     &kGeoLodBehaviour},
    {"GeoLocation",
     "Geospatial",
     1,
     "children",
     "X3DGroupingNode",
     Role::child | Role::grouping,
     NodeKind::geo_group,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFVec3d    geoCoords 0 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
)",
     {},
     &kGeoLocationBehaviour},
    {"GeoMetadata", "Geospatial", 1, "children", "X3DInfoNode X3DUrlObject", Role::child, NodeKind::other, R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField MFNode     data []  # X3DNode
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   summary []
  exposedField MFString   url []
)"},
    {"GeoOrigin", "Geospatial", 1, "geoOrigin", "X3DNode", Role::none, NodeKind::other, R"(
  exposedField SFVec3d    geoCoords 0 0 0
  field        MFString   geoSystem ["GD" "WE"]
  field        SFBool     rotateYUp FALSE
)"},
    {"GeoPositionInterpolator",
     "Geospatial",
     1,
     "children",
     "X3DInterpolatorNode",
     Role::child | Role::interpolator,
     NodeKind::other,
     R"(
  eventIn      SFFloat    set_fraction
  exposedField MFFloat    key []
  exposedField MFVec3d    keyValue []
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
  eventOut     SFVec3d    geovalue_changed
  eventOut     SFVec3f    value_changed
)",
     {},
     &kGeoPositionInterpolatorBehaviour},
    {"GeoProximitySensor",
     "Geospatial",
     2,
     "children",
     "X3DEnvironmentalSensorNode",
     Role::child | Role::sensor,
     NodeKind::other,
     R"(
  exposedField SFVec3d    center 0 0 0
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFVec3d    geoCenter 0 0 0
  exposedField SFVec3f    size 0 0 0  # [0,inf)
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
  eventOut     SFVec3f    centerOfRotation_changed
  eventOut     SFTime     enterTime
  eventOut     SFTime     exitTime
  eventOut     SFVec3d    geoCoord_changed
  eventOut     SFBool     isActive
  eventOut     SFRotation orientation_changed
  eventOut     SFVec3f    position_changed
)",
     {},
     &kGeoProximitySensorBehaviour},
    {"GeoTouchSensor",
     "Geospatial",
     1,
     "children",
     "X3DTouchSensorNode",
     Role::child | Role::sensor,
     NodeKind::other,
     R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
  eventOut     SFVec3d    hitGeoCoord_changed
  eventOut     SFVec3f    hitNormal_changed
  eventOut     SFVec3f    hitPoint_changed
  eventOut     SFVec2f    hitTexCoord_changed
  eventOut     SFBool     isActive
  eventOut     SFBool     isOver
  eventOut     SFTime     touchTime
)",
     {},
     &kGeoTouchSensorBehaviour},
    {"GeoTransform",
     "Geospatial",
     2,
     "children",
     "X3DGroupingNode",
     Role::child | Role::grouping,
     NodeKind::geo_group,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFVec3d    geoCenter 0 0 0
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    scale 1 1 1
  exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField SFVec3f    translation 0 0 0
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
)",
     {},
     &kGeoTransformBehaviour},
    {"GeoViewpoint",
     "Geospatial",
     1,
     "children",
     "X3DViewpointNode",
     Role::child | Role::bindable,
     NodeKind::viewpoint,
     R"(
  eventIn      SFBool     set_bind
  exposedField SFVec3d    centerOfRotation 0 0 0
  exposedField SFString   description ""
  exposedField SFFloat    farDistance -1
  exposedField SFFloat    fieldOfView 0.7854  # (0,3.1416)
  exposedField SFBool     jump TRUE
  exposedField SFNode     navigationInfo NULL  # NavigationInfo
  exposedField SFFloat    nearDistance -1
  exposedField SFRotation orientation 0 0 1 0
  exposedField SFVec3d    position 0 0 100000
  exposedField SFBool     retainUserOffsets FALSE
  exposedField SFBool     viewAll FALSE
  field        SFNode     geoOrigin NULL  # GeoOrigin
  field        MFString   geoSystem ["GD" "WE"]
  field        SFFloat    speedFactor 1.0  # [0,inf)
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
)",
     {},
     &kGeoViewpointBehaviour},
};

}  // namespace

std::span<const X3DRow> x3d_geospatial_rows() { return kGeospatialX3DRows; }

}  // namespace gs::vrml
