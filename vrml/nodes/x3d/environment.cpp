#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"

// Rows of the X3D components EnvironmentalEffects, Lighting (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kEnvironmentX3DRows[] = {
    {"Background", "EnvironmentalEffects", 1, "children", "X3DBackgroundNode", Role::child | Role::bindable,
     NodeKind::other, R"(
  eventIn      SFBool     set_bind
  exposedField MFString   backUrl []
  exposedField MFString   bottomUrl []
  exposedField MFString   frontUrl []
  exposedField MFFloat    groundAngle []  # [0,1.5708]
  exposedField MFColor    groundColor []  # [0,1]
  exposedField MFString   leftUrl []
  exposedField MFString   rightUrl []
  exposedField MFFloat    skyAngle []  # [0,3.1416]
  exposedField MFColor    skyColor [0 0 0]  # [0,1]
  exposedField MFString   topUrl []
  exposedField SFFloat    transparency 0  # [0,1]
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
)"},
    {"DirectionalLight", "Lighting", 1, "children", "X3DLightNode", Role::child | Role::light, NodeKind::other, R"(
  exposedField SFFloat    ambientIntensity 0  # [0,1]
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFVec3f    direction 0 0 -1
  exposedField SFBool     global FALSE
  exposedField SFFloat    intensity 1  # [0,inf)
  exposedField SFBool     on TRUE
  exposedField SFFloat    shadowIntensity 1  # [0,1]
  exposedField SFBool     shadows FALSE
)"},
    {"Fog", "EnvironmentalEffects", 2, "children", "X3DBindableNode X3DFogObject", Role::child | Role::bindable,
     NodeKind::other, R"(
  eventIn      SFBool     set_bind
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFString   fogType "LINEAR"
  exposedField SFFloat    visibilityRange 0  # [0,inf)
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
)"},
    {"FogCoordinate", "EnvironmentalEffects", 4, "fogCoord", "X3DGeometricPropertyNode", Role::geometric_property,
     NodeKind::fog_coordinate, R"(
  exposedField MFFloat    depth []  # [0,1]
)"},
    {"LocalFog", "EnvironmentalEffects", 4, "children", "X3DChildNode X3DFogObject", Role::child, NodeKind::local_fog,
     R"(
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFBool     enabled TRUE
  exposedField SFString   fogType "LINEAR"
  exposedField SFFloat    visibilityRange 0  # [0,inf)
)"},
    {"PointLight", "Lighting", 2, "children", "X3DLightNode", Role::child | Role::light, NodeKind::other, R"(
  exposedField SFFloat    ambientIntensity 0  # [0,1]
  exposedField SFVec3f    attenuation 1 0 0  # [0,inf)
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFBool     global TRUE
  exposedField SFFloat    intensity 1  # [0,inf)
  exposedField SFVec3f    location 0 0 0
  exposedField SFBool     on TRUE
  exposedField SFFloat    radius 100  # [0,inf)
  exposedField SFFloat    shadowIntensity 1  # [0,1]
  exposedField SFBool     shadows FALSE
)"},
    {"SpotLight", "Lighting", 2, "children", "X3DLightNode", Role::child | Role::light, NodeKind::other, R"(
  exposedField SFFloat    ambientIntensity 0  # [0,1]
  exposedField SFVec3f    attenuation 1 0 0  # [0,inf)
  exposedField SFFloat    beamWidth 0.589049  # (0,1.570796]
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFFloat    cutOffAngle 1.570796  # (0,1.570796]
  exposedField SFVec3f    direction 0 0 -1
  exposedField SFBool     global TRUE
  exposedField SFFloat    intensity 1  # [0,inf)
  exposedField SFVec3f    location 0 0 0
  exposedField SFBool     on TRUE
  exposedField SFFloat    radius 100  # [0,inf)
  exposedField SFFloat    shadowIntensity 1  # [0,1]
  exposedField SFBool     shadows FALSE
)"},
    {"TextureBackground",
     "EnvironmentalEffects",
     3,
     "children",
     "X3DBackgroundNode",
     Role::child | Role::bindable,
     NodeKind::background,
     R"(
  eventIn      SFBool     set_bind
  exposedField SFNode     backTexture NULL  # X3DTexture2DNode,MultiTexture
  exposedField SFNode     bottomTexture NULL  # X3DTexture2DNode,MultiTexture
  exposedField SFNode     frontTexture NULL  # X3DTexture2DNode,MultiTexture
  exposedField MFFloat    groundAngle []  # [0,1.5708]
  exposedField MFColor    groundColor []  # [0,1]
  exposedField SFNode     leftTexture NULL  # X3DTexture2DNode,MultiTexture
  exposedField SFNode     rightTexture NULL  # X3DTexture2DNode,MultiTexture
  exposedField MFFloat    skyAngle []  # [0,3.1416]
  exposedField MFColor    skyColor [0 0 0]  # [0,1]
  exposedField SFNode     topTexture NULL  # X3DTexture2DNode,MultiTexture
  exposedField SFFloat    transparency 0  # [0,1]
  eventOut     SFTime     bindTime
  eventOut     SFBool     isBound
)",
     {},
     &kBindableBehaviour},
};

}  // namespace

std::span<const X3DRow> x3d_environment_rows() { return kEnvironmentX3DRows; }

}  // namespace gs::vrml
