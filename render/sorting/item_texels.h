#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>

namespace gs::render {

/// Returns a row of a matrix, for the texels of items (kItemsShader).
[[nodiscard]] inline glm::vec4 matrix_row(const glm::mat4& matrix, int row) {
  return {matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]};
}

/// Returns an integer as two floats that hold it exactly: multiples of 65536, and the rest.
[[nodiscard]] inline glm::vec2 integer_halves(std::size_t whole) {
  return {static_cast<float>(whole >> 16), static_cast<float>(whole & 0xFFFF)};
}

}  // namespace gs::render
