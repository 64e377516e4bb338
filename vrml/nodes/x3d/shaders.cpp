#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component Shaders (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kShadersX3DRows[] = {
    {"ComposedShader",
     "Shaders",
     1,
     "shaders",
     "X3DShaderNode X3DProgrammableShaderObject",
     Role::none,
     NodeKind::other,
     R"(
  eventIn      SFBool     activate
  exposedField MFNode     parts []  # ShaderPart
  field        SFString   language ""
  eventOut     SFBool     isSelected
  eventOut     SFBool     isValid
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"FloatVertexAttribute",
     "Shaders",
     1,
     "attrib",
     "X3DVertexAttributeNode",
     Role::geometric_property,
     NodeKind::other,
     R"(
  exposedField MFFloat    value []
  field        SFString   name ""
  field        SFInt32    numComponents 4  # [1,4]
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Matrix3VertexAttribute",
     "Shaders",
     1,
     "attrib",
     "X3DVertexAttributeNode",
     Role::geometric_property,
     NodeKind::other,
     R"(
  exposedField MFMatrix3f value []
  field        SFString   name ""
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Matrix4VertexAttribute",
     "Shaders",
     1,
     "attrib",
     "X3DVertexAttributeNode",
     Role::geometric_property,
     NodeKind::other,
     R"(
  exposedField MFMatrix4f value []
  field        SFString   name ""
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"PackagedShader",
     "Shaders",
     1,
     "shaders",
     "X3DShaderNode X3DUrlObject X3DProgrammableShaderObject",
     Role::none,
     NodeKind::other,
     R"(
  eventIn      SFBool     activate
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFString   language ""
  eventOut     SFBool     isSelected
  eventOut     SFBool     isValid
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"ProgramShader",
     "Shaders",
     1,
     "shaders",
     "X3DShaderNode",
     Role::none,
     NodeKind::other,
     R"(
  eventIn      SFBool     activate
  exposedField MFNode     programs []  # ShaderProgram
  field        SFString   language ""
  eventOut     SFBool     isSelected
  eventOut     SFBool     isValid
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"ShaderPart",
     "Shaders",
     1,
     "parts",
     "X3DNode X3DUrlObject",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFString   type "VERTEX"
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"ShaderProgram",
     "Shaders",
     1,
     "programs",
     "X3DNode X3DUrlObject X3DProgrammableShaderObject",
     Role::none,
     NodeKind::other,
     R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     load TRUE
  exposedField MFString   url []
  field        SFString   type "VERTEX"
)",
     {},
     nullptr,
     UrlContent::none,
     true},
};

}  // namespace

std::span<const X3DRow> x3d_shaders_rows() { return kShadersX3DRows; }

}  // namespace gs::vrml
