#pragma once

#include <glm/vec3.hpp>

#include <cstddef>

namespace gs::render {

/// Calls add(i, value) with the value of each spherical harmonic of degrees 1 to `degree` (0 to 3) in a direction. They
/// are real, in the order of KHR_gaussian_splatting, with Condon-Shortley signs. `direction` is a unit vector.
template <class Add>
inline void for_harmonics(int degree, const glm::vec3& direction, const Add& add) {
  const float x = direction.x, y = direction.y, z = direction.z;
  if (degree > 0) {
    add(0, -0.48860251f * y);
    add(1, 0.48860251f * z);
    add(2, -0.48860251f * x);
  }
  const float xx = x * x, yy = y * y, zz = z * z;
  if (degree > 1) {
    add(3, 1.09254843f * x * y);
    add(4, -1.09254843f * y * z);
    add(5, 0.31539157f * (2 * zz - xx - yy));
    add(6, -1.09254843f * x * z);
    add(7, 0.54627422f * (xx - yy));
  }
  if (degree > 2) {
    add(8, -0.59004359f * y * (3 * xx - yy));
    add(9, 2.89061144f * x * y * z);
    add(10, -0.45704580f * y * (4 * zz - xx - yy));
    add(11, 0.37317633f * z * (2 * zz - 3 * xx - 3 * yy));
    add(12, -0.45704580f * x * (4 * zz - xx - yy));
    add(13, 1.44530572f * z * (xx - yy));
    add(14, -0.59004359f * x * (xx - 3 * yy));
  }
}

/// Returns the colour of a splat in a direction: max(0, base + sum of the harmonics). `direction` is the unit vector
/// from the eye to the splat, in the axes of the coefficients. These are those of degrees 1 to `degree`.
[[nodiscard]] inline glm::vec3 gaussian_color(const glm::vec3& base, const glm::vec3* coefficients, int degree,
                                              const glm::vec3& direction) {
  glm::vec3 sum = base;
  for_harmonics(degree, direction, [&](std::size_t i, float weight) { sum += coefficients[i] * weight; });
  return {sum.x > 0 ? sum.x : 0.0f, sum.y > 0 ? sum.y : 0.0f, sum.z > 0 ? sum.z : 0.0f};
}

}  // namespace gs::render
