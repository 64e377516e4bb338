#pragma once

#include <glm/vec3.hpp>

#include <cmath>

namespace gs::qnv::displaced {

/// Weighted sum of squared distances to planes: x^T A x + 2 b x + c.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, c = 0;

  void add_plane(const glm::dvec3& n, double d, double weight) {
    xx += weight * n.x * n.x;
    xy += weight * n.x * n.y;
    xz += weight * n.x * n.z;
    yy += weight * n.y * n.y;
    yz += weight * n.y * n.z;
    zz += weight * n.z * n.z;
    x += weight * n.x * d;
    y += weight * n.y * d;
    z += weight * n.z * d;
    c += weight * d * d;
  }
  void add(const Quadric& q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz, x += q.x, y += q.y, z += q.z, c += q.c;
  }
  [[nodiscard]] double at(const glm::dvec3& p) const {
    return p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + x)) + p.y * (yy * p.y + 2 * (yz * p.z + y)) +
           p.z * (zz * p.z + 2 * z) + c;
  }
  /// Returns the position of the minimum that is nearest to `middle`. Returns `middle` if the minimum is not unique.
  [[nodiscard]] glm::dvec3 least(const glm::dvec3& middle) const {
    // A small weight of `middle` makes the matrix invertible.
    const double little = 1e-3 * (xx + yy + zz) + 1e-30;
    const double a = xx + little, d = yy + little, f = zz + little;
    const glm::dvec3 right(little * middle.x - x, little * middle.y - y, little * middle.z - z);
    const double c00 = d * f - yz * yz, c01 = xz * yz - xy * f, c02 = xy * yz - xz * d;
    const double determinant = a * c00 + xy * c01 + xz * c02;
    if (!(std::abs(determinant) > 0)) return middle;
    const double c11 = a * f - xz * xz, c12 = xz * xy - a * yz, c22 = a * d - xy * xy;
    return glm::dvec3(c00 * right.x + c01 * right.y + c02 * right.z, c01 * right.x + c11 * right.y + c12 * right.z,
                      c02 * right.x + c12 * right.y + c22 * right.z) /
           determinant;
  }
};

}  // namespace gs::qnv::displaced
