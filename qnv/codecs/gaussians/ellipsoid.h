#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>

namespace gs::qnv::gaussians {

/// Standard deviations along orthogonal axes, largest first.
struct Ellipsoid {
  glm::vec3 scales{0};
  glm::mat3 axes{1.0f};  // a rotation
};

/// Returns the ellipsoid with these deviations along the columns of a rotation.
[[nodiscard]] Ellipsoid sorted(const glm::vec3& scales, const glm::mat3& axes);
/// Returns the principal axes of a covariance: xx, xy, xz, yy, yz, zz.
[[nodiscard]] Ellipsoid ellipsoid_of(const std::array<float, 6>& covariance);

}  // namespace gs::qnv::gaussians
