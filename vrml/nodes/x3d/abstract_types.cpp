#include "vrml/nodes/x3d/x3d_row.h"

#include <algorithm>
#include <iterator>

// Abstract node types and object types of X3D (ISO/IEC 19775-1), which state where a node may stand.
namespace gs::vrml {
namespace {

/// Abstract type with the types that it derives from, separated by blanks.
struct AbstractType {
  std::string_view name, bases;
};

constexpr AbstractType kAbstractTypes[] = {
    {"X3DAppearanceChildNode", "X3DNode"},
    {"X3DAppearanceNode", "X3DNode"},
    {"X3DArrayField", ""},
    {"X3DBackgroundNode", "X3DBindableNode"},
    {"X3DBindableNode", "X3DChildNode"},
    {"X3DBoundedObject", ""},
    {"X3DChaserNode", "X3DFollowerNode"},
    {"X3DChildNode", "X3DNode"},
    {"X3DColorNode", "X3DGeometricPropertyNode"},
    {"X3DComposableVolumeRenderStyleNode", "X3DVolumeRenderStyleNode"},
    {"X3DComposedGeometryNode", "X3DGeometryNode"},
    {"X3DCoordinateNode", "X3DGeometricPropertyNode"},
    {"X3DDamperNode", "X3DFollowerNode"},
    {"X3DDragSensorNode", "X3DPointingDeviceSensorNode"},
    {"X3DEnvironmentTextureNode", "X3DTextureNode"},
    {"X3DEnvironmentalSensorNode", "X3DSensorNode"},
    {"X3DField", ""},
    {"X3DFogObject", ""},
    {"X3DFollowerNode", "X3DChildNode"},
    {"X3DFontStyleNode", "X3DNode"},
    {"X3DGeometricPropertyNode", "X3DNode"},
    {"X3DGeometryNode", "X3DNode"},
    {"X3DGroupingNode", "X3DChildNode X3DBoundedObject"},
    {"X3DInfoNode", "X3DChildNode"},
    {"X3DInterpolatorNode", "X3DChildNode"},
    {"X3DKeyDeviceSensorNode", "X3DSensorNode"},
    {"X3DLayerNode", "X3DNode X3DPickableObject"},
    {"X3DLayoutNode", "X3DChildNode"},
    {"X3DLightNode", "X3DChildNode"},
    {"X3DMaterialNode", "X3DAppearanceChildNode"},
    {"X3DMetadataObject", ""},
    {"X3DNBodyCollidableNode", "X3DChildNode X3DBoundedObject"},
    {"X3DNBodyCollisionSpaceNode", "X3DNode X3DBoundedObject"},
    {"X3DNetworkSensorNode", "X3DSensorNode"},
    {"X3DNode", ""},
    {"X3DNormalNode", "X3DGeometricPropertyNode"},
    {"X3DNurbsControlCurveNode", "X3DNode"},
    {"X3DNurbsSurfaceGeometryNode", "X3DParametricGeometryNode"},
    {"X3DOneSidedMaterialNode", "X3DMaterialNode"},
    {"X3DParametricGeometryNode", "X3DGeometryNode"},
    {"X3DParticleEmitterNode", "X3DNode"},
    {"X3DParticlePhysicsModelNode", "X3DNode"},
    {"X3DPickSensorNode", "X3DSensorNode"},
    {"X3DPickableObject", ""},
    {"X3DPointingDeviceSensorNode", "X3DSensorNode"},
    {"X3DProductStructureChildNode", "X3DChildNode"},
    {"X3DProgrammableShaderObject", ""},
    {"X3DPrototypeInstance", "X3DNode"},
    {"X3DRigidJointNode", "X3DNode"},
    {"X3DScriptNode", "X3DChildNode X3DUrlObject"},
    {"X3DSensorNode", "X3DChildNode"},
    {"X3DSequencerNode", "X3DChildNode"},
    {"X3DShaderNode", "X3DAppearanceChildNode"},
    {"X3DShapeNode", "X3DChildNode X3DBoundedObject"},
    {"X3DSingleTextureCoordinateNode", "X3DTextureCoordinateNode"},
    {"X3DSingleTextureNode", "X3DTextureNode"},
    {"X3DSingleTextureTransformNode", "X3DTextureTransformNode"},
    {"X3DSoundChannelNode", "X3DSoundNode"},
    {"X3DSoundDestinationNode", "X3DSoundNode"},
    {"X3DSoundNode", "X3DChildNode"},
    {"X3DSoundProcessingNode", "X3DTimeDependentNode X3DSoundNode"},
    {"X3DSoundSourceNode", "X3DTimeDependentNode X3DSoundNode"},
    {"X3DStatement", ""},
    {"X3DTexture2DNode", "X3DSingleTextureNode"},
    {"X3DTexture3DNode", "X3DTextureNode"},
    {"X3DTextureCoordinateNode", "X3DGeometricPropertyNode"},
    {"X3DTextureNode", "X3DAppearanceChildNode"},
    {"X3DTextureProjectorNode", "X3DLightNode"},
    {"X3DTextureTransformNode", "X3DAppearanceChildNode"},
    {"X3DTimeDependentNode", "X3DChildNode"},
    {"X3DTouchSensorNode", "X3DPointingDeviceSensorNode"},
    {"X3DTriggerNode", "X3DChildNode"},
    {"X3DUrlObject", ""},
    {"X3DVertexAttributeNode", "X3DGeometricPropertyNode"},
    {"X3DViewpointNode", "X3DBindableNode"},
    {"X3DViewportNode", "X3DGroupingNode"},
    {"X3DVolumeDataNode", "X3DChildNode X3DBoundedObject"},
    {"X3DVolumeRenderStyleNode", "X3DNode"},
};

// Calls `visit` for each word of `words` until it returns true. Returns whether it did.
template <class Visit>
bool any_word(std::string_view words, const Visit& visit) {
  while (!words.empty()) {
    const std::string_view word = words.substr(0, words.find(' '));
    if (visit(word)) return true;
    words.remove_prefix(std::min(words.size(), word.size() + 1));
  }
  return false;
}

std::string_view bases_of(std::string_view abstract) {
  const auto found = std::lower_bound(std::begin(kAbstractTypes), std::end(kAbstractTypes), abstract,
                                      [](const AbstractType& type, std::string_view name) { return type.name < name; });
  return found != std::end(kAbstractTypes) && found->name == abstract ? found->bases : std::string_view{};
}

}  // namespace

bool is_derived(std::string_view name, std::string_view bases, std::string_view wanted) {
  return name == wanted ||
         any_word(bases, [&](std::string_view base) { return is_derived(base, bases_of(base), wanted); });
}

}  // namespace gs::vrml
