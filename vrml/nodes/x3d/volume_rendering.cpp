#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component VolumeRendering (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kVolumeRenderingX3DRows[] = {
    {"BlendedVolumeStyle",
     "VolumeRendering",
     3,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::blended_style,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField SFNode     renderStyle NULL  # X3DComposableVolumeRenderStyleNode
  exposedField SFNode     voxels NULL  # X3DTexture3DNode
  exposedField SFFloat    weightConstant1 0.5  # [0,1]
  exposedField SFFloat    weightConstant2 0.5  # [0,1]
  exposedField SFString   weightFunction1 "CONSTANT"
  exposedField SFString   weightFunction2 "CONSTANT"
  exposedField SFNode     weightTransferFunction1 NULL  # X3DTexture2DNode
  exposedField SFNode     weightTransferFunction2 NULL  # X3DTexture2DNode
)"},
    {"BoundaryEnhancementVolumeStyle",
     "VolumeRendering",
     2,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::boundary_style,
     R"(
  exposedField SFFloat    boundaryOpacity 0.9  # [0,1]
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    opacityFactor 2  # [0,inf)
  exposedField SFFloat    retainedOpacity 0.2  # [0,1]
)"},
    {"CartoonVolumeStyle",
     "VolumeRendering",
     3,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::cartoon_style,
     R"(
  exposedField SFInt32    colorSteps 4  # [1,64]
  exposedField SFBool     enabled TRUE
  exposedField SFColorRGBA orthogonalColor 1 1 1 1  # [0,1]
  exposedField SFColorRGBA parallelColor 0 0 0 1  # [0,1]
  exposedField SFNode     surfaceNormals NULL  # X3DTexture3DNode
)"},
    {"ComposedVolumeStyle",
     "VolumeRendering",
     3,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::composed_style,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField MFNode     renderStyle []  # X3DComposableVolumeRenderStyleNode
)"},
    {"EdgeEnhancementVolumeStyle",
     "VolumeRendering",
     2,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::edge_style,
     R"(
  exposedField SFColorRGBA edgeColor 0 0 0 1  # [0,1]
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gradientThreshold 0.4  # [0,3.1416]
  exposedField SFNode     surfaceNormals NULL  # X3DTexture3DNode
)"},
    {"IsoSurfaceVolumeData",
     "VolumeRendering",
     2,
     "children",
     "X3DVolumeDataNode",
     Role::child,
     NodeKind::iso_surface_volume,
     R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFFloat    contourStepSize 0
  exposedField SFVec3f    dimensions 1 1 1  # (0,inf)
  exposedField SFNode     gradients NULL  # X3DTexture3DNode
  exposedField MFNode     renderStyle []  # X3DVolumeRenderStyleNode
  exposedField SFFloat    surfaceTolerance 0  # [0,inf)
  exposedField MFFloat    surfaceValues []
  exposedField SFBool     visible TRUE
  exposedField SFNode     voxels NULL  # X3DTexture3DNode
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"OpacityMapVolumeStyle",
     "VolumeRendering",
     1,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::opacity_map_style,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField SFNode     transferFunction NULL  # X3DTexture2DNode,X3DTexture3DNode
)"},
    {"ProjectionVolumeStyle",
     "VolumeRendering",
     2,
     "renderStyle",
     "X3DVolumeRenderStyleNode",
     Role::none,
     NodeKind::projection_style,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    intensityThreshold 0  # [0,1]
  exposedField SFString   type "MAX"
)"},
    {"SegmentedVolumeData",
     "VolumeRendering",
     2,
     "children",
     "X3DVolumeDataNode",
     Role::child,
     NodeKind::segmented_volume,
     R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    dimensions 1 1 1  # (0,inf)
  exposedField MFNode     renderStyle []  # X3DVolumeRenderStyleNode
  exposedField MFBool     segmentEnabled []
  exposedField SFNode     segmentIdentifiers NULL  # X3DTexture3DNode
  exposedField SFBool     visible TRUE
  exposedField SFNode     voxels NULL  # X3DTexture3DNode
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
    {"ShadedVolumeStyle",
     "VolumeRendering",
     3,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::shaded_style,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField SFBool     lighting FALSE
  exposedField SFNode     material NULL  # X3DMaterialNode
  exposedField SFBool     shadows FALSE
  exposedField SFNode     surfaceNormals NULL  # X3DTexture3DNode
  field        SFString   phaseFunction "Henyey-Greenstein"
)"},
    {"SilhouetteEnhancementVolumeStyle",
     "VolumeRendering",
     2,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::silhouette_style,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    silhouetteBoundaryOpacity 0  # [0,1]
  exposedField SFFloat    silhouetteRetainedOpacity 1  # [0,1]
  exposedField SFFloat    silhouetteSharpness 0.5  # [0,inf)
  exposedField SFNode     surfaceNormals NULL  # X3DTexture3DNode
)"},
    {"ToneMappedVolumeStyle",
     "VolumeRendering",
     2,
     "renderStyle",
     "X3DComposableVolumeRenderStyleNode",
     Role::none,
     NodeKind::tone_mapped_style,
     R"(
  exposedField SFColorRGBA coolColor 0 0 1 0  # [0,1]
  exposedField SFBool     enabled TRUE
  exposedField SFNode     surfaceNormals NULL  # X3DTexture3DNode
  exposedField SFColorRGBA warmColor 1 1 0 0  # [0,1]
)"},
    {"VolumeData",
     "VolumeRendering",
     1,
     "children",
     "X3DVolumeDataNode",
     Role::child,
     NodeKind::volume_data,
     R"(
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFVec3f    dimensions 1 1 1  # (0,inf)
  exposedField SFNode     renderStyle NULL  # X3DVolumeRenderStyleNode
  exposedField SFBool     visible TRUE
  exposedField SFNode     voxels NULL  # X3DTexture3DNode
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
)"},
};

}  // namespace

std::span<const X3DRow> x3d_volume_rendering_rows() { return kVolumeRenderingX3DRows; }

}  // namespace gs::vrml
