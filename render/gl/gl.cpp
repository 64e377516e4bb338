#include "render/gl/gl.h"

#include "render/gl/context_backend.h"

#include <algorithm>
#include <cstring>

namespace gs::render {
namespace {

// EXT_texture_filter_anisotropic; in OpenGL itself since 4.6.
constexpr GLenum kMaxTextureMaxAnisotropy = 0x84FF;

bool has_extension(const Gl& gl, const char* name) {
  GLint count = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* extension = reinterpret_cast<const char*>(gl.GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
    if (extension && std::strcmp(extension, name) == 0) return true;
  }
  return false;
}

}  // namespace

std::variant<Gl, ContextError> Gl::load(GlContext& context) {
  Gl gl;
  std::string missing;
#define GHOSTSPACE_GL_LOAD(type, name)                                             \
  gl.name = reinterpret_cast<PFNGL##type##PROC>(context.proc_address("gl" #name)); \
  if (!gl.name && missing.empty()) missing = "gl" #name;
  GHOSTSPACE_GL_FUNCTIONS(GHOSTSPACE_GL_LOAD)
#undef GHOSTSPACE_GL_LOAD
  if (!missing.empty()) return ContextError{"OpenGL 3.3 is required; this context has no " + missing};

  GLint major = 0, minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  const int version = major * 10 + minor;
  if (version < 33)
    return ContextError{"OpenGL 3.3 is required; this context has " + std::to_string(major) + "." +
                        std::to_string(minor)};
  if (const GLubyte* name = gl.GetString(GL_RENDERER)) gl.renderer = reinterpret_cast<const char*>(name);
  gl.software = is_software_renderer(gl.renderer);

  if (version >= 42 || has_extension(gl, "GL_ARB_base_instance"))
    gl.DrawElementsInstancedBaseVertexBaseInstance =
        reinterpret_cast<PFNGLDRAWELEMENTSINSTANCEDBASEVERTEXBASEINSTANCEPROC>(
            context.proc_address("glDrawElementsInstancedBaseVertexBaseInstance"));
  // The commands of this call contain base instances.
  if (version >= 43 ||
      (gl.DrawElementsInstancedBaseVertexBaseInstance && has_extension(gl, "GL_ARB_multi_draw_indirect")))
    gl.MultiDrawElementsIndirect = reinterpret_cast<PFNGLMULTIDRAWELEMENTSINDIRECTPROC>(
        context.proc_address("glMultiDrawElementsIndirect"));
  if (version >= 43) {
    gl.DispatchCompute = reinterpret_cast<PFNGLDISPATCHCOMPUTEPROC>(context.proc_address("glDispatchCompute"));
    gl.MemoryBarrier = reinterpret_cast<PFNGLMEMORYBARRIERPROC>(context.proc_address("glMemoryBarrier"));
    if (!gl.MemoryBarrier) gl.DispatchCompute = nullptr;
    if (!gl.DispatchCompute) gl.MemoryBarrier = nullptr;
  }
  gl.sample_shading = has_extension(gl, "GL_ARB_gpu_shader5");
  if (version >= 45 || has_extension(gl, "GL_ARB_clip_control"))
    gl.ClipControl = reinterpret_cast<PFNGLCLIPCONTROLPROC>(context.proc_address("glClipControl"));
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &gl.max_texture_size);
  gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &gl.max_renderbuffer_size);
  gl.GetIntegerv(GL_MAX_SAMPLES, &gl.max_samples);
  gl.GetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &gl.uniform_offset_alignment);
  gl.uniform_offset_alignment = std::max(gl.uniform_offset_alignment, 16);
  // Mesa's software driver reads all texels in the ellipse of a pixel. If a texture repeats very often in a pixel, or a
  // surface passes through the eye, a frame would take forever.
  if (!gl.software && (version >= 46 || has_extension(gl, "GL_EXT_texture_filter_anisotropic")))
    gl.GetFloatv(kMaxTextureMaxAnisotropy, &gl.max_anisotropy);
  return gl;
}

}  // namespace gs::render
