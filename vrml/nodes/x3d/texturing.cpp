#include "vrml/nodes/x3d/components.h"

// Rows of the X3D components Texturing, Texturing3D, CubeMapTexturing, TextureProjection (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kTexturingX3DRows[] = {
    {"ComposedCubeMapTexture", "CubeMapTexturing", 1, "texture", "X3DEnvironmentTextureNode", Role::texture,
     NodeKind::composed_cube_map_texture, R"(
  exposedField SFNode     back NULL  # X3DTexture2DNode
  exposedField SFNode     bottom NULL  # X3DTexture2DNode
  exposedField SFString   description ""
  exposedField SFNode     front NULL  # X3DTexture2DNode
  exposedField SFNode     left NULL  # X3DTexture2DNode
  exposedField SFNode     right NULL  # X3DTexture2DNode
  exposedField SFNode     top NULL  # X3DTexture2DNode
  field        SFNode     textureProperties NULL  # TextureProperties
)"},
    {"ComposedTexture3D", "Texturing3D", 1, "texture", "X3DTexture3DNode", Role::texture, NodeKind::composed_texture_3d,
     R"(
  exposedField SFString   description ""
  exposedField MFNode     texture []  # X3DTexture2DNode
  field        SFBool     repeatR FALSE
  field        SFBool     repeatS FALSE
  field        SFBool     repeatT FALSE
  field        SFNode     textureProperties NULL  # TextureProperties
)"},
    {"GeneratedCubeMapTexture", "CubeMapTexturing", 3, "texture", "X3DEnvironmentTextureNode", Role::texture,
     NodeKind::generated_cube_map_texture, R"(
  exposedField SFString   description ""
  exposedField SFString   update "NONE"
  field        SFInt32    size 128  # (0,inf)
  field        SFNode     textureProperties NULL  # TextureProperties
)"},
    {"ImageCubeMapTexture",
     "CubeMapTexturing",
     2,
     "texture",
     "X3DEnvironmentTextureNode X3DUrlObject",
     Role::texture,
     NodeKind::image_cube_map_texture,
     R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFNode     textureProperties NULL  # TextureProperties
)",
     {},
     nullptr,
     UrlContent::image},
    {"ImageTexture", "Texturing", 1, "texture", "X3DTexture2DNode X3DUrlObject", Role::texture, NodeKind::other, R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFBool     repeatS TRUE
  field        SFBool     repeatT TRUE
  field        SFNode     textureProperties NULL  # TextureProperties
)"},
    {"ImageTexture3D",
     "Texturing3D",
     2,
     "texture",
     "X3DTexture3DNode X3DUrlObject",
     Role::texture,
     NodeKind::image_texture_3d,
     R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFBool     repeatR FALSE
  field        SFBool     repeatS FALSE
  field        SFBool     repeatT FALSE
  field        SFNode     textureProperties NULL  # TextureProperties
)",
     {},
     nullptr,
     UrlContent::image},
    {"MovieTexture", "Texturing", 3, "texture", "X3DSoundSourceNode X3DTexture2DNode X3DUrlObject",
     Role::child | Role::texture | Role::time_dependent | Role::sound_source, NodeKind::other, R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFBool     load TRUE
  exposedField SFBool     loop FALSE
  exposedField SFTime     pauseTime 0
  exposedField SFFloat    pitch 1.0  # (0,inf)
  exposedField SFTime     resumeTime 0
  exposedField SFFloat    speed 1.0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField MFString   url []
  field        SFBool     repeatS TRUE
  field        SFBool     repeatT TRUE
  field        SFNode     textureProperties NULL  # TextureProperties
  eventOut     SFTime     duration_changed  # [-1,inf)
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)"},
    {"MultiTexture", "Texturing", 2, "texture", "X3DTextureNode", Role::texture, NodeKind::multi_texture, R"(
  exposedField SFFloat    alpha 1  # [0,1]
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFString   description ""
  exposedField MFString   function []
  exposedField MFString   mode []
  exposedField MFString   source []
  exposedField MFNode     texture []  # X3DSingleTextureNode
)"},
    {"MultiTextureCoordinate", "Texturing", 2, "texCoord", "X3DTextureCoordinateNode", Role::geometric_property,
     NodeKind::multi_texture_coordinate, R"(
  exposedField MFNode     texCoord []  # X3DSingleTextureCoordinateNode
)"},
    {"MultiTextureTransform", "Texturing", 2, "textureTransform", "X3DTextureTransformNode", Role::texture_transform,
     NodeKind::multi_texture_transform, R"(
  exposedField MFNode     textureTransform []  # X3DSingleTextureTransformNode
)"},
    {"PixelTexture", "Texturing", 1, "texture", "X3DTexture2DNode", Role::texture, NodeKind::other, R"(
  exposedField SFString   description ""
  exposedField SFImage    image 0 0 0
  field        SFBool     repeatS TRUE
  field        SFBool     repeatT TRUE
  field        SFNode     textureProperties NULL  # TextureProperties
)"},
    {"PixelTexture3D", "Texturing3D", 1, "texture", "X3DTexture3DNode", Role::texture, NodeKind::pixel_texture_3d, R"(
  exposedField SFString   description ""
  exposedField MFInt32    image [0 0 0 0]
  field        SFBool     repeatR FALSE
  field        SFBool     repeatS FALSE
  field        SFBool     repeatT FALSE
  field        SFNode     textureProperties NULL  # TextureProperties
)"},
    {"TextureCoordinate", "Texturing", 1, "texCoord", "X3DSingleTextureCoordinateNode", Role::geometric_property,
     NodeKind::other, R"(
  exposedField SFString   mapping ""
  exposedField MFVec2f    point []
)"},
    {"TextureCoordinate3D", "Texturing3D", 1, "texCoord", "X3DSingleTextureCoordinateNode", Role::geometric_property,
     NodeKind::texture_coordinate_3d, R"(
  exposedField SFString   mapping ""
  exposedField MFVec3f    point []
)"},
    {"TextureCoordinate4D", "Texturing3D", 1, "texCoord", "X3DSingleTextureCoordinateNode", Role::geometric_property,
     NodeKind::texture_coordinate_4d, R"(
  exposedField SFString   mapping ""
  exposedField MFVec4f    point []
)"},
    {"TextureCoordinateGenerator", "Texturing", 2, "texCoord", "X3DSingleTextureCoordinateNode",
     Role::geometric_property, NodeKind::texture_coordinate_generator, R"(
  exposedField SFString   mapping ""
  exposedField SFString   mode "SPHERE"
  exposedField MFFloat    parameter []
)"},
    {"TextureProjector",
     "TextureProjection",
     2,
     "children",
     "X3DTextureProjectorNode",
     Role::child | Role::light,
     NodeKind::other,
     R"(
  exposedField SFFloat    ambientIntensity 0  # [0,1]
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFString   description ""
  exposedField SFVec3f    direction 0 0 1
  exposedField SFFloat    farDistance -1  # [-1,inf)
  exposedField SFFloat    fieldOfView 0.7854  # [0,3.1416]
  exposedField SFBool     global TRUE
  exposedField SFFloat    intensity 1  # [0,inf)
  exposedField SFVec3f    location 0 0 0
  exposedField SFFloat    nearDistance -1  # [-1,inf)
  exposedField SFBool     on TRUE
  exposedField SFFloat    shadowIntensity 1  # [0,1]
  exposedField SFBool     shadows FALSE
  exposedField SFNode     texture NULL  # X3DTexture2DNode
  exposedField SFVec3f    upVector 0 0 1
  eventOut     SFFloat    aspectRatio  # (0,inf)
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"TextureProjectorParallel",
     "TextureProjection",
     2,
     "children",
     "X3DTextureProjectorNode",
     Role::child | Role::light,
     NodeKind::other,
     R"(
  exposedField SFFloat    ambientIntensity 0  # [0,1]
  exposedField SFColor    color 1 1 1  # [0,1]
  exposedField SFString   description ""
  exposedField SFVec3f    direction 0 0 1
  exposedField SFFloat    farDistance -1  # [-1,inf)
  exposedField SFVec4f    fieldOfView -1 -1 1 1
  exposedField SFBool     global TRUE
  exposedField SFFloat    intensity 1  # [0,inf)
  exposedField SFVec3f    location 0 0 0
  exposedField SFFloat    nearDistance -1  # [-1,inf)
  exposedField SFBool     on TRUE
  exposedField SFFloat    shadowIntensity 1  # [0,1]
  exposedField SFBool     shadows FALSE
  exposedField SFNode     texture NULL  # X3DTexture2DNode
  eventOut     SFFloat    aspectRatio  # (0,inf)
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"TextureProperties", "Texturing", 2, "textureProperties", "X3DNode", Role::none, NodeKind::texture_properties, R"(
  exposedField SFFloat    anisotropicDegree 1  # [1,inf)
  exposedField SFColorRGBA borderColor 0 0 0 0  # [0,1]
  exposedField SFInt32    borderWidth 0  # [0,inf)
  exposedField SFString   boundaryModeR "REPEAT"
  exposedField SFString   boundaryModeS "REPEAT"
  exposedField SFString   boundaryModeT "REPEAT"
  exposedField SFString   magnificationFilter "FASTEST"
  exposedField SFString   minificationFilter "FASTEST"
  exposedField SFString   textureCompression "FASTEST"
  exposedField SFFloat    texturePriority 0  # [0,1]
  field        SFBool     generateMipMaps FALSE
)"},
    {"TextureTransform", "Texturing", 1, "textureTransform", "X3DTextureTransformNode", Role::texture_transform,
     NodeKind::other, R"(
  exposedField SFVec2f    center 0 0
  exposedField SFString   mapping ""
  exposedField SFFloat    rotation 0
  exposedField SFVec2f    scale 1 1
  exposedField SFVec2f    translation 0 0
)"},
    {"TextureTransform3D", "Texturing3D", 1, "textureTransform", "X3DTextureTransformNode", Role::texture_transform,
     NodeKind::texture_transform_3d, R"(
  exposedField SFVec3f    center 0 0 0
  exposedField SFString   mapping ""
  exposedField SFRotation rotation 0 0 1 0
  exposedField SFVec3f    scale 1 1 1
  exposedField SFVec3f    translation 0 0 0
)"},
    {"TextureTransformMatrix3D", "Texturing3D", 1, "textureTransform", "X3DTextureTransformNode",
     Role::texture_transform, NodeKind::texture_transform_matrix_3d, R"(
  exposedField SFString   mapping ""
  exposedField SFMatrix4f matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
)"},
};

}  // namespace

std::span<const X3DRow> x3d_texturing_rows() { return kTexturingX3DRows; }

}  // namespace gs::vrml
