#include "vrml/inventor/converter.h"
#include "vrml/inventor/item_types.h"

#include <algorithm>

// Nodekits with their parts, and nodes without effect.
namespace gs::vrml::inventor {
namespace {

// Parts in the order in which they act. Other parts follow.
constexpr std::string_view kPartOrder[] = {"callbackList",
                                           "pickStyle",
                                           "appearance",
                                           "units",
                                           "lightModel",
                                           "environment",
                                           "drawStyle",
                                           "material",
                                           "complexity",
                                           "font",
                                           "fontStyle",
                                           "texture2",
                                           "transform",
                                           "texture2Transform",
                                           "transformGroup",
                                           "topSeparator",
                                           "cameraList",
                                           "camera",
                                           "lightList",
                                           "light",
                                           "materialBinding",
                                           "normalBinding",
                                           "textureCoordinateBinding",
                                           "shapeHints",
                                           "coordinate3",
                                           "coordinate4",
                                           "normal",
                                           "textureCoordinate2",
                                           "textureCoordinateFunction",
                                           "profileCoordinate2",
                                           "profileCoordinate3",
                                           "localTransform",
                                           "shapeSeparator",
                                           "shape",
                                           "contents",
                                           "childList"};

void visit_parts(Converter& converter, const Item& item) {
  std::vector<const ItemField*> parts;
  for (const ItemField& field : item.fields)
    if (!field.nodes.empty()) parts.push_back(&field);
  const auto rank = [](const ItemField* part) {
    return std::find(std::begin(kPartOrder), std::end(kPartOrder), part->row->name) - std::begin(kPartOrder);
  };
  std::stable_sort(parts.begin(), parts.end(),
                   [&](const ItemField* a, const ItemField* b) { return rank(a) < rank(b); });
  for (const ItemField* part : parts)
    for (const ItemPtr& node : part->nodes) converter.visit(*node);
  converter.visit_children(item);
}

// Draws the container of a list of parts.
void apply_list_part(Converter& converter, const Item& item) { visit_parts(converter, item); }

constexpr std::string_view kUnseen = "not supported; ignored";

constexpr ItemRow kKitRows[] = {
    {"SeparatorKit ShapeKit SceneKit WrapperKit InteractionKit", ItemClass::kit, true, visit_parts},
    {"AppearanceKit CameraKit LightKit BaseKit", ItemClass::kit, false, visit_parts},
    {"NodeKitListPart", ItemClass::kit, false, apply_list_part,
     "SFName containerTypeName \"\" MFName childTypes [] SFNode containerNode"},
};

constexpr ItemRow kOtherRows[] = {
    {"Label", ItemClass::plain, false, nullptr, "SFName label \"\""},
    {"Callback EventCallback", ItemClass::plain, false, nullptr, "SFPath path"},
    {"PickStyle", ItemClass::plain, false, nullptr, "SFEnum style SHAPE"},
    {"TransparencyType", ItemClass::plain, false, nullptr, "SFEnum value BLEND"},
    {"ColorIndex", ItemClass::plain, false, nullptr, "MFInt32 index []", kUnseen},
    {"PolygonOffset", ItemClass::plain, false, nullptr,
     "SFFloat factor 1 SFFloat units 1 SFBitMask styles FILLED SFBool on TRUE"},
    {"ProfileCoordinate2", ItemClass::plain, false, nullptr, "MFVec2f point [ 0 0 ]", kUnseen},
    {"ProfileCoordinate3", ItemClass::plain, false, nullptr, "MFVec3f point [ 0 0 1 ]", kUnseen},
    {"LinearProfile", ItemClass::plain, false, nullptr, "MFInt32 index 0 SFEnum linkage START_FIRST", kUnseen},
    {"NurbsProfile", ItemClass::plain, false, nullptr,
     "MFInt32 index 0 SFEnum linkage START_FIRST MFFloat knotVector []", kUnseen},
    {"TextureScalePolicy TextureQuality", ItemClass::plain, false, nullptr,
     "SFEnum policy USE_TEXTURE_QUALITY SFFloat quality 0.5"},
    {"TextureUnit TextureCombine Texture3 Texture3Transform TextureCoordinate3 BumpMap BumpMapCoordinate "
     "BumpMapTransform SceneTexture2 TextureCubeMap TextureMatrixTransform",
     ItemClass::ignored,
     false,
     nullptr,
     {},
     kUnseen},
    {"Image Listener VertexShader FragmentShader ShaderProgram GeometryShader DepthBuffer AlphaTest CacheHint "
     "TransparencyGroup WWWInlineCallback Path ShadowStyle ShadowCulling ProfileElement",
     ItemClass::ignored,
     false,
     nullptr,
     {},
     kUnseen},
    // Engines and global fields.
    {"BoolOperation Calculator ComposeMatrix ComposeRotation ComposeRotationFromTo ComposeVec2f ComposeVec3f "
     "ComposeVec4f Compose DecomposeMatrix DecomposeRotation DecomposeVec2f DecomposeVec3f DecomposeVec4f Concatenate "
     "Counter ElapsedTime Fuse Gate HeightMapToNormalMap InterpolateFloat InterpolateRotation InterpolateVec2f "
     "InterpolateVec3f InterpolateVec4f OnOff OneShot SelectOne TimeCounter Timer Trigger TriggerAny "
     "ComputeBoundingBox "
     "Tesselate TransformVec3f ConvertAll GlobalField SwitchboardOperator Switchboard TimeSensor",
     ItemClass::ignored,
     false,
     nullptr,
     {},
     "engines are not supported; connected fields keep their values"},
    {"CenterballDragger DirectionalLightDragger DragPointDragger HandleBoxDragger JackDragger PointLightDragger "
     "RotateCylindricalDragger RotateDiscDragger RotateSphericalDragger Scale1Dragger Scale2Dragger "
     "Scale2UniformDragger ScaleUniformDragger SpotLightDragger TabBoxDragger TabPlaneDragger TrackballDragger "
     "TransformBoxDragger TransformerDragger Translate1Dragger Translate2Dragger",
     ItemClass::ignored,
     false,
     nullptr,
     {},
     "draggers are not supported; skipped"},
};

}  // namespace

std::span<const ItemRow> kit_rows() { return kKitRows; }
std::span<const ItemRow> other_rows() { return kOtherRows; }

}  // namespace gs::vrml::inventor
