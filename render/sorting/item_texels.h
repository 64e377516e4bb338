#pragma once

#include "render/gl/gpu.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <span>

namespace gs::render {

/// Returns a row of a matrix, for the texels of items (kItemsShader).
[[nodiscard]] inline glm::vec4 matrix_row(const glm::mat4& matrix, int row) {
  return {matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]};
}

/// Returns an integer as two floats that hold it exactly: multiples of 65536, and the rest.
[[nodiscard]] inline glm::vec2 integer_halves(std::size_t whole) {
  return {static_cast<float>(whole >> 16), static_cast<float>(whole & 0xFFFF)};
}

/// Writes the texels of items to a buffer, made on first use, and binds the texture to it. Returns false if OpenGL
/// reports an error, such as missing memory.
[[nodiscard]] inline bool upload_item_texels(const Gl& gl, std::span<const glm::vec4> texels, Buffer& buffer,
                                             const Texture& texture) {
  if (!buffer) buffer = make_buffer(gl);
  gl.BindBuffer(GL_TEXTURE_BUFFER, buffer.name());
  gl.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(texels.size_bytes()), texels.data(), GL_STREAM_DRAW);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_BUFFER, texture.name());
  gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, buffer.name());
  return gl.GetError() == GL_NO_ERROR;
}

}  // namespace gs::render
