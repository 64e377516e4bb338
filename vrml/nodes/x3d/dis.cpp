#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component DIS (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kDisX3DRows[] = {
    {"DISEntityManager",
     "DIS",
     2,
     "children",
     "X3DChildNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFString   address "localhost"
  exposedField SFInt32    applicationID 0
  exposedField MFNode     children []  # DISEntityTypeMapping
  exposedField SFInt32    port 0
  exposedField SFInt32    siteID 0
  eventOut     MFNode     addedEntities  # EspduTransform
  eventOut     MFNode     removedEntities  # EspduTransform
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"DISEntityTypeMapping",
     "DIS",
     2,
     "children",
     "X3DInfoNode X3DUrlObject",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFInt32    category 0  # [0,255]
  field        SFInt32    country 0  # [0,65535]
  field        SFInt32    domain 0  # [0,255]
  field        SFInt32    extra 0  # [0,255]
  field        SFInt32    kind 0  # [0,255]
  field        SFInt32    specific 0  # [0,255]
  field        SFInt32    subcategory 0  # [0,255]
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"EspduTransform",
     "DIS",
     1,
     "children",
     "X3DGroupingNode X3DNetworkSensorNode",
     Role::child | Role::grouping | Role::sensor,
     NodeKind::other,
     R"(
  eventIn      MFNode     addChildren  # X3DChildNode
  eventIn      MFNode     removeChildren  # X3DChildNode
  eventIn      SFFloat    set_articulationParameterValue0
  eventIn      SFFloat    set_articulationParameterValue1
  eventIn      SFFloat    set_articulationParameterValue2
  eventIn      SFFloat    set_articulationParameterValue3
  eventIn      SFFloat    set_articulationParameterValue4
  eventIn      SFFloat    set_articulationParameterValue5
  eventIn      SFFloat    set_articulationParameterValue6
  eventIn      SFFloat    set_articulationParameterValue7
  exposedField SFString   address "localhost"
  exposedField SFInt32    applicationID 0
  exposedField MFFloat    articulationParameterArray []
  exposedField MFInt32    articulationParameterChangeIndicatorArray []
  exposedField SFInt32    articulationParameterCount 0
  exposedField MFInt32    articulationParameterDesignatorArray []
  exposedField MFInt32    articulationParameterIdPartAttachedToArray []
  exposedField MFInt32    articulationParameterTypeArray []
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    center 0 0 0
  exposedField MFNode     children []  # X3DChildNode
  exposedField SFInt32    collisionType 0
  exposedField SFInt32    deadReckoning 0
  exposedField SFString   description ""
  exposedField SFVec3f    detonationLocation 0 0 0
  exposedField SFVec3f    detonationRelativeLocation 0 0 0
  exposedField SFInt32    detonationResult 0
  exposedField SFBool     enabled TRUE
  exposedField SFInt32    entityCategory 0
  exposedField SFInt32    entityCountry 0
  exposedField SFInt32    entityDomain 0
  exposedField SFInt32    entityExtra 0
  exposedField SFInt32    entityID 0
  exposedField SFInt32    entityKind 0
  exposedField SFInt32    entitySpecific 0
  exposedField SFInt32    entitySubcategory 0
  exposedField SFInt32    eventApplicationID 0
  exposedField SFInt32    eventEntityID 0
  exposedField SFInt32    eventNumber 0
  exposedField SFInt32    eventSiteID 0
  exposedField SFBool     fired1 FALSE
  exposedField SFBool     fired2 FALSE
  exposedField SFInt32    fireMissionIndex 0
  exposedField SFFloat    firingRange 0
  exposedField SFInt32    firingRate 0
  exposedField SFInt32    forceID 0
  exposedField SFInt32    fuse 0
  exposedField SFVec3d    geoCoords 0 0 0
  exposedField SFVec3f    linearAcceleration 0 0 0
  exposedField SFVec3f    linearVelocity 0 0 0
  exposedField SFString   marking ""
  exposedField SFString   multicastRelayHost ""
  exposedField SFInt32    multicastRelayPort 0
  exposedField SFInt32    munitionApplicationID 0
  exposedField SFVec3f    munitionEndPoint 0 0 0
  exposedField SFInt32    munitionEntityID 0
  exposedField SFInt32    munitionQuantity 0
  exposedField SFInt32    munitionSiteID 0
  exposedField SFVec3f    munitionStartPoint 0 0 0
  exposedField SFString   networkMode "standAlone"
  exposedField SFInt32    port 0
  exposedField SFTime     readInterval 0.1  # [0,inf)
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFBool     rtpHeaderExpected FALSE
  exposedField SFVec3f    scale 1 1 1
  exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField SFInt32    siteID 0
  exposedField SFVec3f    translation 0 0 0
  exposedField SFBool     visible TRUE
  exposedField SFInt32    warhead 0
  exposedField SFTime     writeInterval 1.0  # [0,inf)
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        MFString   geoSystem ["GD" "WE"]
  eventOut     SFFloat    articulationParameterValue0_changed
  eventOut     SFFloat    articulationParameterValue1_changed
  eventOut     SFFloat    articulationParameterValue2_changed
  eventOut     SFFloat    articulationParameterValue3_changed
  eventOut     SFFloat    articulationParameterValue4_changed
  eventOut     SFFloat    articulationParameterValue5_changed
  eventOut     SFFloat    articulationParameterValue6_changed
  eventOut     SFFloat    articulationParameterValue7_changed
  eventOut     SFTime     collideTime
  eventOut     SFTime     detonateTime
  eventOut     SFTime     firedTime
  eventOut     SFBool     isActive
  eventOut     SFBool     isCollided
  eventOut     SFBool     isDetonated
  eventOut     SFBool     isNetworkReader
  eventOut     SFBool     isNetworkWriter
  eventOut     SFBool     isRtpHeaderHeard
  eventOut     SFBool     isStandAlone
  eventOut     SFTime     timestamp  # [0,inf)
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"ReceiverPdu",
     "DIS",
     1,
     "children",
     "X3DNetworkSensorNode X3DBoundedObject",
     Role::child | Role::sensor,
     NodeKind::other,
     R"(
  exposedField SFString   address "localhost"
  exposedField SFInt32    applicationID 0
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFInt32    entityID 0
  exposedField SFVec3d    geoCoords 0 0 0
  exposedField SFString   multicastRelayHost ""
  exposedField SFInt32    multicastRelayPort 0
  exposedField SFString   networkMode "standAlone"
  exposedField SFInt32    port 0
  exposedField SFInt32    radioID 0
  exposedField SFTime     readInterval 0.1  # [0,inf)
  exposedField SFFloat    receivedPower 0.0
  exposedField SFInt32    receiverState 0
  exposedField SFBool     rtpHeaderExpected FALSE
  exposedField SFInt32    siteID 0
  exposedField SFInt32    transmitterApplicationID 0
  exposedField SFInt32    transmitterEntityID 0
  exposedField SFInt32    transmitterRadioID 0
  exposedField SFInt32    transmitterSiteID 0
  exposedField SFBool     visible TRUE
  exposedField SFInt32    whichGeometry 1
  exposedField SFTime     writeInterval 1.0  # [0,inf)
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        MFString   geoSystem ["GD" "WE"]
  eventOut     SFBool     isActive
  eventOut     SFBool     isNetworkReader
  eventOut     SFBool     isNetworkWriter
  eventOut     SFBool     isRtpHeaderHeard
  eventOut     SFBool     isStandAlone
  eventOut     SFTime     timestamp  # [0,inf)
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"SignalPdu",
     "DIS",
     1,
     "children",
     "X3DNetworkSensorNode X3DBoundedObject",
     Role::child | Role::sensor,
     NodeKind::other,
     R"(
  exposedField SFString   address "localhost"
  exposedField SFInt32    applicationID 0
  exposedField SFBool     bboxDisplay FALSE
  exposedField MFInt32    data []
  exposedField SFInt32    dataLength 0
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFInt32    encodingScheme 0
  exposedField SFInt32    entityID 0
  exposedField SFVec3d    geoCoords 0 0 0
  exposedField SFString   multicastRelayHost ""
  exposedField SFInt32    multicastRelayPort 0
  exposedField SFString   networkMode "standAlone"
  exposedField SFInt32    port 0
  exposedField SFInt32    radioID 0
  exposedField SFTime     readInterval 0.1  # [0,inf)
  exposedField SFBool     rtpHeaderExpected FALSE
  exposedField SFInt32    sampleRate 0
  exposedField SFInt32    samples 0
  exposedField SFInt32    siteID 0
  exposedField SFInt32    tdlType 0
  exposedField SFBool     visible TRUE
  exposedField SFInt32    whichGeometry 1
  exposedField SFTime     writeInterval 1.0  # [0,inf)
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        MFString   geoSystem ["GD" "WE"]
  eventOut     SFBool     isActive
  eventOut     SFBool     isNetworkReader
  eventOut     SFBool     isNetworkWriter
  eventOut     SFBool     isRtpHeaderHeard
  eventOut     SFBool     isStandAlone
  eventOut     SFTime     timestamp  # [0,inf)
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"TransmitterPdu",
     "DIS",
     1,
     "children",
     "X3DNetworkSensorNode X3DBoundedObject",
     Role::child | Role::sensor,
     NodeKind::other,
     R"(
  exposedField SFString   address "localhost"
  exposedField SFVec3f    antennaLocation 0 0 0
  exposedField SFInt32    antennaPatternLength 0
  exposedField SFInt32    antennaPatternType 0
  exposedField SFInt32    applicationID 0
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFInt32    cryptoKeyID 0
  exposedField SFInt32    cryptoSystem 0
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFInt32    entityID 0
  exposedField SFInt32    frequency 0  # [0,inf)
  exposedField SFVec3d    geoCoords 0 0 0
  exposedField SFInt32    inputSource 0
  exposedField SFInt32    lengthOfModulationParameters 0
  exposedField SFInt32    modulationTypeDetail 0
  exposedField SFInt32    modulationTypeMajor 0
  exposedField SFInt32    modulationTypeSpreadSpectrum 0
  exposedField SFInt32    modulationTypeSystem 0
  exposedField SFString   multicastRelayHost ""
  exposedField SFInt32    multicastRelayPort 0
  exposedField SFString   networkMode "standAlone"
  exposedField SFInt32    port 0
  exposedField SFFloat    power 0.0
  exposedField SFInt32    radioEntityTypeCategory 0
  exposedField SFInt32    radioEntityTypeCountry 0
  exposedField SFInt32    radioEntityTypeDomain 0
  exposedField SFInt32    radioEntityTypeKind 0
  exposedField SFInt32    radioEntityTypeNomenclature 0
  exposedField SFInt32    radioEntityTypeNomenclatureVersion 0
  exposedField SFInt32    radioID 0
  exposedField SFTime     readInterval 0.1  # [0,inf)
  exposedField SFVec3f    relativeAntennaLocation 0 0 0
  exposedField SFBool     rtpHeaderExpected FALSE
  exposedField SFInt32    siteID 0
  exposedField SFFloat    transmitFrequencyBandwidth 0
  exposedField SFInt32    transmitState 0
  exposedField SFBool     visible TRUE
  exposedField SFInt32    whichGeometry 1
  exposedField SFTime     writeInterval 1.0  # [0,inf)
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        MFString   geoSystem ["GD" "WE"]
  eventOut     SFBool     isActive
  eventOut     SFBool     isNetworkReader
  eventOut     SFBool     isNetworkWriter
  eventOut     SFBool     isRtpHeaderHeard
  eventOut     SFBool     isStandAlone
  eventOut     SFTime     timestamp  # [0,inf)
)",
     {},
     nullptr,
     UrlContent::none,
     true},
};

}  // namespace

std::span<const X3DRow> x3d_dis_rows() { return kDisX3DRows; }

}  // namespace gs::vrml
