#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component Shape (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kShapeX3DRows[] = {
    {"AcousticProperties",
     "Shape",
     5,
     "acousticProperties",
     "X3DAppearanceChildNode",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFFloat    absorption 0  # [0,1]
  exposedField SFString   description ""
  exposedField SFFloat    diffuse 0  # [0,1]
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    refraction 0  # [0,1]
  exposedField SFFloat    specular 0  # [0,1]
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Appearance", "Shape", 1, "appearance", "X3DAppearanceNode", Role::appearance, NodeKind::other, R"(
  exposedField SFNode     acousticProperties NULL  # AcousticProperties
  exposedField SFFloat    alphaCutoff 0.5  # [0,1]
  exposedField SFString   alphaMode "AUTO"
  exposedField SFNode     backMaterial NULL  # X3DMaterialNode
  exposedField SFNode     fillProperties NULL  # FillProperties
  exposedField SFNode     lineProperties NULL  # LineProperties
  exposedField SFNode     material NULL  # X3DMaterialNode
  exposedField SFNode     pointProperties NULL  # PointProperties
  exposedField MFNode     shaders []  # X3DShaderNode
  exposedField SFNode     texture NULL  # X3DTextureNode
  exposedField SFNode     textureTransform NULL  # X3DTextureTransformNode
)"},
    {"FillProperties", "Shape", 3, "fillProperties", "X3DAppearanceChildNode", Role::none, NodeKind::fill_properties,
     R"(
  exposedField SFBool     filled TRUE
  exposedField SFColor    hatchColor 1 1 1  # [0,1]
  exposedField SFBool     hatched TRUE
  exposedField SFInt32    hatchStyle 1  # [0,inf)
)"},
    {"LineProperties", "Shape", 2, "lineProperties", "X3DAppearanceChildNode", Role::none, NodeKind::line_properties,
     R"(
  exposedField SFBool     applied TRUE
  exposedField SFInt32    linetype 1  # [0,inf)
  exposedField SFFloat    linewidthScaleFactor 0
)"},
    {"Material", "Shape", 1, "material", "X3DOneSidedMaterialNode", Role::material, NodeKind::other, R"(
  exposedField SFFloat    ambientIntensity 0.2  # [0,1]
  exposedField SFNode     ambientTexture NULL  # X3DSingleTextureNode
  exposedField SFString   ambientTextureMapping ""
  exposedField SFColor    diffuseColor 0.8 0.8 0.8  # [0,1]
  exposedField SFNode     diffuseTexture NULL  # X3DSingleTextureNode
  exposedField SFString   diffuseTextureMapping ""
  exposedField SFColor    emissiveColor 0 0 0  # [0,1]
  exposedField SFNode     emissiveTexture NULL  # X3DSingleTextureNode
  exposedField SFString   emissiveTextureMapping ""
  exposedField SFFloat    normalScale 1  # [0,inf)
  exposedField SFNode     normalTexture NULL  # X3DSingleTextureNode
  exposedField SFString   normalTextureMapping ""
  exposedField SFFloat    occlusionStrength 1  # [0,1]
  exposedField SFNode     occlusionTexture NULL  # X3DSingleTextureNode
  exposedField SFString   occlusionTextureMapping ""
  exposedField SFFloat    shininess 0.2  # [0,1]
  exposedField SFNode     shininessTexture NULL  # X3DSingleTextureNode
  exposedField SFString   shininessTextureMapping ""
  exposedField SFColor    specularColor 0 0 0  # [0,1]
  exposedField SFNode     specularTexture NULL  # X3DSingleTextureNode
  exposedField SFString   specularTextureMapping ""
  exposedField SFFloat    transparency 0  # [0,1]
)"},
    {"PhysicalMaterial", "Shape", 2, "material", "X3DOneSidedMaterialNode", Role::material, NodeKind::physical_material,
     R"(
  exposedField SFColor    baseColor 1 1 1  # [0,1]
  exposedField SFNode     baseTexture NULL  # X3DSingleTextureNode
  exposedField SFString   baseTextureMapping ""
  exposedField SFColor    emissiveColor 0 0 0  # [0,1]
  exposedField SFNode     emissiveTexture NULL  # X3DSingleTextureNode
  exposedField SFString   emissiveTextureMapping ""
  exposedField SFFloat    metallic 1  # [0,1]
  exposedField SFNode     metallicRoughnessTexture NULL  # X3DSingleTextureNode
  exposedField SFString   metallicRoughnessTextureMapping ""
  exposedField SFFloat    normalScale 1  # [0,inf)
  exposedField SFNode     normalTexture NULL  # X3DSingleTextureNode
  exposedField SFString   normalTextureMapping ""
  exposedField SFFloat    occlusionStrength 1  # [0,1]
  exposedField SFNode     occlusionTexture NULL  # X3DSingleTextureNode
  exposedField SFString   occlusionTextureMapping ""
  exposedField SFFloat    roughness 1  # [0,1]
  exposedField SFFloat    transparency 0  # [0,1]
)"},
    {"PointProperties", "Shape", 5, "pointProperties", "X3DAppearanceChildNode", Role::none, NodeKind::point_properties,
     R"(
  exposedField SFVec3f    attenuation 1 0 0
  exposedField SFFloat    pointSizeMaxValue 1  # [0,inf)
  exposedField SFFloat    pointSizeMinValue 1  # [0,inf)
  exposedField SFFloat    pointSizeScaleFactor 1  # [1,inf)
)"},
    {"Shape", "Shape", 1, "children", "X3DShapeNode", Role::child, NodeKind::other, R"(
  exposedField SFNode     appearance NULL  # X3DAppearanceNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFBool     castShadow TRUE
  exposedField SFNode     geometry NULL  # X3DGeometryNode
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"TwoSidedMaterial", "Shape", 4, "material", "X3DMaterialNode", Role::material, NodeKind::two_sided_material, R"(
  exposedField SFFloat    ambientIntensity 0.2  # [0,1]
  exposedField SFFloat    backAmbientIntensity 0.2  # [0,1]
  exposedField SFColor    backDiffuseColor 0.8 0.8 0.8  # [0,1]
  exposedField SFColor    backEmissiveColor 0 0 0  # [0,1]
  exposedField SFFloat    backShininess 0.2  # [0,1]
  exposedField SFColor    backSpecularColor 0 0 0  # [0,1]
  exposedField SFFloat    backTransparency 0  # [0,1]
  exposedField SFColor    diffuseColor 0.8 0.8 0.8  # [0,1]
  exposedField SFColor    emissiveColor 0 0 0  # [0,1]
  exposedField SFBool     separateBackColor FALSE
  exposedField SFFloat    shininess 0.2  # [0,1]
  exposedField SFColor    specularColor 0 0 0  # [0,1]
  exposedField SFFloat    transparency 0  # [0,1]
)"},
    {"UnlitMaterial", "Shape", 1, "material", "X3DOneSidedMaterialNode", Role::material, NodeKind::unlit_material, R"(
  exposedField SFColor    emissiveColor 1 1 1  # [0,1]
  exposedField SFNode     emissiveTexture NULL  # X3DSingleTextureNode
  exposedField SFString   emissiveTextureMapping ""
  exposedField SFFloat    normalScale 1  # [0,inf)
  exposedField SFNode     normalTexture NULL  # X3DSingleTextureNode
  exposedField SFString   normalTextureMapping ""
  exposedField SFFloat    transparency 0  # [0,1]
)"},
};

}  // namespace

std::span<const X3DRow> x3d_shape_rows() { return kShapeX3DRows; }

}  // namespace gs::vrml
