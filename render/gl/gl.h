#pragma once

#include "base/phases.h"
#include "render/gl/context.h"

#include <GL/glcorearb.h>

#include <string>
#include <variant>

/// List of the OpenGL 3.3 core functions that GhostSpace calls: X(name in PFNGL...PROC, name without "gl").
#define GHOSTSPACE_GL_FUNCTIONS(X)                                            \
  X(ACTIVETEXTURE, ActiveTexture)                                             \
  X(ATTACHSHADER, AttachShader)                                               \
  X(BEGINCONDITIONALRENDER, BeginConditionalRender)                           \
  X(BEGINQUERY, BeginQuery)                                                   \
  X(BINDBUFFER, BindBuffer)                                                   \
  X(BINDBUFFERBASE, BindBufferBase)                                           \
  X(BINDBUFFERRANGE, BindBufferRange)                                         \
  X(BINDFRAMEBUFFER, BindFramebuffer)                                         \
  X(BINDRENDERBUFFER, BindRenderbuffer)                                       \
  X(BINDSAMPLER, BindSampler)                                                 \
  X(BINDTEXTURE, BindTexture)                                                 \
  X(BINDVERTEXARRAY, BindVertexArray)                                         \
  X(BLENDCOLOR, BlendColor)                                                   \
  X(BLENDFUNCSEPARATE, BlendFuncSeparate)                                     \
  X(BLITFRAMEBUFFER, BlitFramebuffer)                                         \
  X(BUFFERDATA, BufferData)                                                   \
  X(BUFFERSUBDATA, BufferSubData)                                             \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)                           \
  X(CLEAR, Clear)                                                             \
  X(CLEARBUFFERFV, ClearBufferfv)                                             \
  X(CLEARCOLOR, ClearColor)                                                   \
  X(CLIENTWAITSYNC, ClientWaitSync)                                           \
  X(COLORMASK, ColorMask)                                                     \
  X(COMPILESHADER, CompileShader)                                             \
  X(CREATEPROGRAM, CreateProgram)                                             \
  X(CREATESHADER, CreateShader)                                               \
  X(CULLFACE, CullFace)                                                       \
  X(DELETEBUFFERS, DeleteBuffers)                                             \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)                                   \
  X(DELETEPROGRAM, DeleteProgram)                                             \
  X(DELETEQUERIES, DeleteQueries)                                             \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers)                                 \
  X(DELETESAMPLERS, DeleteSamplers)                                           \
  X(DELETESHADER, DeleteShader)                                               \
  X(DELETESYNC, DeleteSync)                                                   \
  X(DELETETEXTURES, DeleteTextures)                                           \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays)                                   \
  X(DEPTHFUNC, DepthFunc)                                                     \
  X(DEPTHMASK, DepthMask)                                                     \
  X(DISABLE, Disable)                                                         \
  X(DRAWARRAYS, DrawArrays)                                                   \
  X(DRAWARRAYSINSTANCED, DrawArraysInstanced)                                 \
  X(DRAWBUFFERS, DrawBuffers)                                                 \
  X(DRAWELEMENTSINSTANCEDBASEVERTEX, DrawElementsInstancedBaseVertex)         \
  X(ENABLE, Enable)                                                           \
  X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)                         \
  X(ENDCONDITIONALRENDER, EndConditionalRender)                               \
  X(ENDQUERY, EndQuery)                                                       \
  X(FENCESYNC, FenceSync)                                                     \
  X(FINISH, Finish)                                                           \
  X(FLUSH, Flush)                                                             \
  X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer)                         \
  X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)                               \
  X(FRONTFACE, FrontFace)                                                     \
  X(GENBUFFERS, GenBuffers)                                                   \
  X(GENFRAMEBUFFERS, GenFramebuffers)                                         \
  X(GENQUERIES, GenQueries)                                                   \
  X(GENRENDERBUFFERS, GenRenderbuffers)                                       \
  X(GENSAMPLERS, GenSamplers)                                                 \
  X(GENTEXTURES, GenTextures)                                                 \
  X(GENVERTEXARRAYS, GenVertexArrays)                                         \
  X(GENERATEMIPMAP, GenerateMipmap)                                           \
  X(GETERROR, GetError)                                                       \
  X(GETFLOATV, GetFloatv)                                                     \
  X(GETFRAMEBUFFERATTACHMENTPARAMETERIV, GetFramebufferAttachmentParameteriv) \
  X(GETINTEGERV, GetIntegerv)                                                 \
  X(GETMULTISAMPLEFV, GetMultisamplefv)                                       \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)                                     \
  X(GETPROGRAMIV, GetProgramiv)                                               \
  X(GETSHADERINFOLOG, GetShaderInfoLog)                                       \
  X(GETSHADERIV, GetShaderiv)                                                 \
  X(GETSTRING, GetString)                                                     \
  X(GETSTRINGI, GetStringi)                                                   \
  X(GETUNIFORMBLOCKINDEX, GetUniformBlockIndex)                               \
  X(GETUNIFORMLOCATION, GetUniformLocation)                                   \
  X(LINEWIDTH, LineWidth)                                                     \
  X(LINKPROGRAM, LinkProgram)                                                 \
  X(PIXELSTOREI, PixelStorei)                                                 \
  X(POINTSIZE, PointSize)                                                     \
  X(POLYGONMODE, PolygonMode)                                                 \
  X(POLYGONOFFSET, PolygonOffset)                                             \
  X(READBUFFER, ReadBuffer)                                                   \
  X(READPIXELS, ReadPixels)                                                   \
  X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample)           \
  X(SAMPLEMASKI, SampleMaski)                                                 \
  X(SAMPLERPARAMETERF, SamplerParameterf)                                     \
  X(SAMPLERPARAMETERFV, SamplerParameterfv)                                   \
  X(SAMPLERPARAMETERI, SamplerParameteri)                                     \
  X(SCISSOR, Scissor)                                                         \
  X(SHADERSOURCE, ShaderSource)                                               \
  X(TEXBUFFER, TexBuffer)                                                     \
  X(TEXIMAGE2D, TexImage2D)                                                   \
  X(TEXIMAGE2DMULTISAMPLE, TexImage2DMultisample)                             \
  X(TEXIMAGE3D, TexImage3D)                                                   \
  X(TEXPARAMETERI, TexParameteri)                                             \
  X(TEXPARAMETERIV, TexParameteriv)                                           \
  X(TEXSUBIMAGE2D, TexSubImage2D)                                             \
  X(UNIFORM1I, Uniform1i)                                                     \
  X(UNIFORM1IV, Uniform1iv)                                                   \
  X(UNIFORM1F, Uniform1f)                                                     \
  X(UNIFORM2F, Uniform2f)                                                     \
  X(UNIFORM2FV, Uniform2fv)                                                   \
  X(UNIFORM2I, Uniform2i)                                                     \
  X(UNIFORM3FV, Uniform3fv)                                                   \
  X(UNIFORM4FV, Uniform4fv)                                                   \
  X(UNIFORMBLOCKBINDING, UniformBlockBinding)                                 \
  X(UNIFORMMATRIX3FV, UniformMatrix3fv)                                       \
  X(UNIFORMMATRIX4FV, UniformMatrix4fv)                                       \
  X(USEPROGRAM, UseProgram)                                                   \
  X(VERTEXATTRIB4F, VertexAttrib4f)                                           \
  X(VERTEXATTRIBDIVISOR, VertexAttribDivisor)                                 \
  X(VERTEXATTRIBIPOINTER, VertexAttribIPointer)                               \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer)                                 \
  X(VIEWPORT, Viewport)

namespace gs::render {

/// Functions and limits of one context. Functions have their OpenGL names without "gl".
struct Gl {
#define GHOSTSPACE_GL_MEMBER(type, name) PFNGL##type##PROC name = nullptr;
  GHOSTSPACE_GL_FUNCTIONS(GHOSTSPACE_GL_MEMBER)
#undef GHOSTSPACE_GL_MEMBER
  /// OpenGL 4.2 or ARB_base_instance; null if missing.
  PFNGLDRAWELEMENTSINSTANCEDBASEVERTEXBASEINSTANCEPROC DrawElementsInstancedBaseVertexBaseInstance = nullptr;
  /// OpenGL 4.3 or ARB_multi_draw_indirect; null if missing.
  PFNGLMULTIDRAWELEMENTSINDIRECTPROC MultiDrawElementsIndirect = nullptr;
  /// OpenGL 4.5 or ARB_clip_control; null if missing.
  PFNGLCLIPCONTROLPROC ClipControl = nullptr;
  /// OpenGL 4.3. Either both of these functions are present or neither is.
  PFNGLDISPATCHCOMPUTEPROC DispatchCompute = nullptr;
  PFNGLMEMORYBARRIERPROC MemoryBarrier = nullptr;

  PhaseClock* phases = nullptr;  // clock for measuring phases; may be null
  std::string renderer;          // GL_RENDERER
  bool software = false;         // the CPU renders
  bool sample_shading = false;   // ARB_gpu_shader5: shaders can run for each sample
  int max_texture_size = 1024, max_renderbuffer_size = 1024, max_samples = 1, uniform_offset_alignment = 256;
  float max_anisotropy = 1;  // 1 means that anisotropic filtering is unavailable or disabled

  /// Loads all functions from the current context. Returns an error if the context is older than OpenGL 3.3 core.
  static std::variant<Gl, ContextError> load(GlContext& context);
};

}  // namespace gs::render
