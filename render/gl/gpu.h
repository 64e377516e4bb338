#pragma once

#include "render/gl/gl.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace gs::render {

enum class GpuObject { buffer, texture, sampler, vertex_array, framebuffer, renderbuffer, shader, program, query };

/// Owner of one OpenGL object. Move-only; empty by default. `gl` must outlive it. Its context must be current when it
/// is destroyed.
template <GpuObject kind>
class GpuHandle {
 public:
  GpuHandle() = default;
  GpuHandle(const Gl& gl, GLuint name) : gl_(&gl), name_(name) {}
  GpuHandle(GpuHandle&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
  GpuHandle& operator=(GpuHandle&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(name_, other.name_);
    return *this;
  }
  ~GpuHandle() {
    if (name_) destroy();
  }
  [[nodiscard]] GLuint name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  void destroy() {
    if constexpr (kind == GpuObject::buffer) gl_->DeleteBuffers(1, &name_);
    if constexpr (kind == GpuObject::texture) gl_->DeleteTextures(1, &name_);
    if constexpr (kind == GpuObject::sampler) gl_->DeleteSamplers(1, &name_);
    if constexpr (kind == GpuObject::vertex_array) gl_->DeleteVertexArrays(1, &name_);
    if constexpr (kind == GpuObject::framebuffer) gl_->DeleteFramebuffers(1, &name_);
    if constexpr (kind == GpuObject::renderbuffer) gl_->DeleteRenderbuffers(1, &name_);
    if constexpr (kind == GpuObject::shader) gl_->DeleteShader(name_);
    if constexpr (kind == GpuObject::program) gl_->DeleteProgram(name_);
    if constexpr (kind == GpuObject::query) gl_->DeleteQueries(1, &name_);
  }
  const Gl* gl_ = nullptr;
  GLuint name_ = 0;
};

using Buffer = GpuHandle<GpuObject::buffer>;
using Texture = GpuHandle<GpuObject::texture>;
using Sampler = GpuHandle<GpuObject::sampler>;
using VertexArray = GpuHandle<GpuObject::vertex_array>;
using Framebuffer = GpuHandle<GpuObject::framebuffer>;
using Renderbuffer = GpuHandle<GpuObject::renderbuffer>;
using Program = GpuHandle<GpuObject::program>;
using Query = GpuHandle<GpuObject::query>;

[[nodiscard]] Buffer make_buffer(const Gl& gl);
[[nodiscard]] Texture make_texture(const Gl& gl);
[[nodiscard]] Sampler make_sampler(const Gl& gl);
[[nodiscard]] VertexArray make_vertex_array(const Gl& gl);
[[nodiscard]] Framebuffer make_framebuffer(const Gl& gl);
[[nodiscard]] Renderbuffer make_renderbuffer(const Gl& gl);
[[nodiscard]] Query make_query(const Gl& gl);

/// Compiles and links a program. Inserts a #version line and `defines` ("#define LIT", one per line) before both
/// sources, which must have no #version line. The error contains the driver's message.
[[nodiscard]] std::variant<Program, ContextError> make_program(const Gl& gl, std::string_view defines,
                                                               std::string_view vertex_source,
                                                               std::string_view fragment_source);

/// Clears the error state of OpenGL. Returns true if it contained an error.
bool take_errors(const Gl& gl);

/// Converts a byte offset in the bound buffer to the pointer type that OpenGL expects.
[[nodiscard]] inline const void* offset_pointer(std::size_t offset) { return reinterpret_cast<const void*>(offset); }

/// Binds a buffer with the elements of `quads` rectangles, two triangles each, to the bound vertex array. Vertex 4 i +
/// k is corner k of rectangle i; at most 16384 rectangles.
void set_quad_elements(const Gl& gl, const Buffer& elements, unsigned quads);

}  // namespace gs::render
