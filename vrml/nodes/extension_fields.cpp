#include "vrml/scene/node_type.h"

#include <algorithm>
#include <iterator>

namespace gs::vrml {
namespace {

/// Field of other browsers, in nodes of one type, or of any type if `type` is empty.
struct ExtensionField {
  std::string_view type, name;
};
// Sorted by field. Sources: the X3D extensions of Castle Game Engine and view3dscene, X_ITE, InstantReality.
constexpr ExtensionField kFields[] = {
    {"", "alphaChannel"},
    {"", "alphaClipping"},
    {"Viewpoint", "autoCenterOfRotation"},
    {"Appearance", "blendMode"},
    {"FontStyle", "blending"},
    {"Viewpoint", "cameraInverseMatrix"},
    {"Viewpoint", "cameraMatrix"},
    {"Viewpoint", "cameraMatrixSendAlsoOnOffscreenRendering"},
    {"Viewpoint", "cameraRotationInverseMatrix"},
    {"Viewpoint", "cameraRotationMatrix"},
    {"", "ccw"},
    {"Shape", "collision"},
    {"FontStyle", "customFont"},
    {"BoundedPhysicsModel", "damping"},
    {"", "defaultShadowMap"},
    {"Viewpoint", "direction"},
    {"", "effects"},
    {"ImageTexture", "flipVertically"},
    {"MovieTexture", "flipVertically"},
    {"FontStyle", "format"},
    {"Viewpoint", "gravityTransform"},
    {"Viewpoint", "gravityUp"},
    {"TextureProperties", "guiTexture"},
    {"NavigationInfo", "headBobbing"},
    {"NavigationInfo", "headBobbingTime"},
    {"NavigationInfo", "headlightNode"},
    {"KambiNavigationInfo", "headlightNode"},
    {"", "heightMap"},
    {"", "heightMapScale"},
    {"", "kambiShadows"},
    {"", "kambiShadowsMain"},
    {"OrientationInterpolator", "keyValueQuaternions"},
    {"Text", "maxDisplayChars"},
    {"Material", "mirror"},
    {"Appearance", "normalMap"},
    {"TextureCoordinateGenerator", "projectedLight"},
    {"", "projectionAngle"},
    {"", "projectionFar"},
    {"", "projectionLocation"},
    {"", "projectionNear"},
    {"", "projectionRectangle"},
    {"Circle2D", "radiusY"},
    {"", "receiveShadows"},
    {"Shape", "render"},
    {"ParticleSystem", "scale"},
    {"ParticleSystem", "scaleKey"},
    {"ParticleSystem", "scaleRamp"},
    {"", "shaders"},
    {"Shape", "shading"},
    {"", "shadowCaster"},
    {"", "shadowMap"},
    {"", "shadowVolumes"},
    {"", "shadowVolumesMain"},
    {"", "skinJoints0"},
    {"", "skinWeights0"},
    {"", "slices"},
    {"", "stacks"},
    {"", "tangent"},
    {"", "texCoord"},
    {"ViewportInfo", "textColor"},
    {"NavigationInfo", "timeOriginAtLoad"},
    {"SpotLight", "up"},
    {"DirectionalLight", "up"},
    {"Viewpoint", "up"},
    {"Fog", "volumetric"},
    {"Fog", "volumetricDirection"},
    {"Fog", "volumetricVisibilityStart"},
};

}  // namespace

bool is_extension_field(const NodeType& type, std::string_view name) {
  constexpr std::string_view kSet = "set_", kChanged = "_changed";
  if (type.kind != NodeType::Kind::built_in) return false;
  if (name.starts_with(kSet)) name.remove_prefix(kSet.size());
  if (name.ends_with(kChanged)) name.remove_suffix(kChanged.size());
  return std::any_of(std::begin(kFields), std::end(kFields), [&](const ExtensionField& field) {
    return field.name == name && (field.type.empty() || field.type == type.name);
  });
}

}  // namespace gs::vrml
