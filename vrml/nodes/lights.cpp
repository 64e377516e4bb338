#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of the light sources (VRML97 4.6.6).
constexpr NodeRow kLightsRows[] = {
    {"DirectionalLight", "6.16", Role::child | Role::light, NodeKind::directional_light, R"(
  exposedField SFFloat    ambientIntensity 0                # [0,1]
  exposedField SFColor    color            1 1 1            # [0,1]
  exposedField SFVec3f    direction        0 0 -1           # (-inf,inf)
  exposedField SFFloat    intensity        1                # [0,1]
  exposedField SFBool     on               TRUE
)"},
    {"PointLight", "6.35", Role::child | Role::light, NodeKind::point_light, R"(
  exposedField SFFloat    ambientIntensity 0                # [0,1]
  exposedField SFVec3f    attenuation      1 0 0            # [0,inf)
  exposedField SFColor    color            1 1 1            # [0,1]
  exposedField SFFloat    intensity        1                # [0,1]
  exposedField SFVec3f    location         0 0 0            # (-inf,inf)
  exposedField SFBool     on               TRUE
  exposedField SFFloat    radius           100              # [0,inf)
)"},
    {"SpotLight", "6.45", Role::child | Role::light, NodeKind::spot_light, R"(
  exposedField SFFloat    ambientIntensity 0                # [0,1]
  exposedField SFVec3f    attenuation      1 0 0            # [0,inf)
  exposedField SFFloat    beamWidth        1.570796         # (0,pi/2]
  exposedField SFColor    color            1 1 1            # [0,1]
  exposedField SFFloat    cutOffAngle      0.785398         # (0,pi/2]
  exposedField SFVec3f    direction        0 0 -1           # (-inf,inf)
  exposedField SFFloat    intensity        1                # [0,1]
  exposedField SFVec3f    location         0 0 0            # (-inf,inf)
  exposedField SFBool     on               TRUE
  exposedField SFFloat    radius           100              # [0,inf)
)"},
};

}  // namespace

std::span<const NodeRow> lights_rows() { return kLightsRows; }

}  // namespace gs::vrml
