#include "render/gl/gpu.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace gs::render {
namespace {

using Shader = GpuHandle<GpuObject::shader>;
constexpr std::string_view kVersion = "#version 330 core\n";

/// Returns the information log of a shader or program.
template <class GetNumber, class GetLog>
std::string log_of(GLuint name, GetNumber get_number, GetLog get_log) {
  GLint length = 0;
  get_number(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  get_log(name, length, nullptr, log.data());
  return log;
}

std::variant<Shader, ContextError> compile(const Gl& gl, GLenum stage, std::string_view defines,
                                           std::string_view source) {
  Shader shader(gl, gl.CreateShader(stage));
  const std::array<const GLchar*, 3> texts{kVersion.data(), defines.data(), source.data()};
  const std::array<GLint, 3> lengths{static_cast<GLint>(kVersion.size()), static_cast<GLint>(defines.size()),
                                     static_cast<GLint>(source.size())};
  gl.ShaderSource(shader.name(), 3, texts.data(), lengths.data());
  gl.CompileShader(shader.name());
  GLint compiled = GL_FALSE;
  gl.GetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  return ContextError{"shader: " + log_of(shader.name(), gl.GetShaderiv, gl.GetShaderInfoLog)};
}

/// Makes an object with a function such as glGenBuffers.
template <class Handle, class Generate>
Handle generated(const Gl& gl, Generate generate) {
  GLuint name = 0;
  generate(1, &name);
  return {gl, name};
}

}  // namespace

Buffer make_buffer(const Gl& gl) { return generated<Buffer>(gl, gl.GenBuffers); }
Texture make_texture(const Gl& gl) { return generated<Texture>(gl, gl.GenTextures); }
Sampler make_sampler(const Gl& gl) { return generated<Sampler>(gl, gl.GenSamplers); }
VertexArray make_vertex_array(const Gl& gl) { return generated<VertexArray>(gl, gl.GenVertexArrays); }
Framebuffer make_framebuffer(const Gl& gl) { return generated<Framebuffer>(gl, gl.GenFramebuffers); }
Renderbuffer make_renderbuffer(const Gl& gl) { return generated<Renderbuffer>(gl, gl.GenRenderbuffers); }
Query make_query(const Gl& gl) { return generated<Query>(gl, gl.GenQueries); }

std::variant<Program, ContextError> make_program(const Gl& gl, std::string_view defines, std::string_view vertex_source,
                                                 std::string_view fragment_source) {
  const PhaseScope phase(gl.phases, Phase::compile);
  auto vertex = compile(gl, GL_VERTEX_SHADER, defines, vertex_source);
  if (auto* error = std::get_if<ContextError>(&vertex)) return std::move(*error);
  auto fragment = compile(gl, GL_FRAGMENT_SHADER, defines, fragment_source);
  if (auto* error = std::get_if<ContextError>(&fragment)) return std::move(*error);

  Program program(gl, gl.CreateProgram());
  gl.AttachShader(program.name(), std::get<Shader>(vertex).name());
  gl.AttachShader(program.name(), std::get<Shader>(fragment).name());
  gl.LinkProgram(program.name());
  GLint linked = GL_FALSE;
  gl.GetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (linked) return program;
  return ContextError{"linking shaders: " + log_of(program.name(), gl.GetProgramiv, gl.GetProgramInfoLog)};
}

void set_quad_elements(const Gl& gl, const Buffer& elements, unsigned quads) {
  std::vector<std::uint16_t> corners;
  for (unsigned i = 0; i < quads; ++i)
    for (const unsigned corner : {0u, 1u, 2u, 2u, 1u, 3u})
      corners.push_back(static_cast<std::uint16_t>(4 * i + corner));
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, elements.name());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof corners[0]), corners.data(),
                GL_STATIC_DRAW);
}

bool take_errors(const Gl& gl) {
  bool any = false;
  for (int i = 0; i < 100 && gl.GetError() != GL_NO_ERROR; ++i) any = true;
  return any;
}

}  // namespace gs::render
