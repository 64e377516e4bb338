#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <span>

namespace gs::app {

/// Linear transformation of Gaussian splats about the origin: rotation, scale, reflection and shear.
class SplatTransform {
 public:
  explicit SplatTransform(const glm::mat3& linear);

  [[nodiscard]] const glm::mat3& linear() const { return linear_; }
  /// Changes the standard deviations and the rotation (a quaternion x, y, z, w, of any length) of a splat: its
  /// covariance C becomes M C M^T.
  void apply(glm::vec3& scales, glm::vec4& rotation) const;
  /// Turns the spherical harmonics of degrees 1 to 3 of one splat. `coefficients` has 0, 3, 8 or 15 of them.
  void apply(std::span<glm::vec3> coefficients) const;

 private:
  void find_turn(const glm::mat3& orthogonal);

  glm::mat3 linear_;
  bool similar_ = false;                                     // rotation and uniform scale only
  float scale_ = 1;                                          // of a similar transformation
  glm::vec4 turn_{0, 0, 0, 1};                               // rotation of a similar transformation, x, y, z, w
  std::array<std::array<float, 7>, 3 + 5 + 7> harmonics_{};  // rows of the matrices of degrees 1, 2 and 3
};

}  // namespace gs::app
