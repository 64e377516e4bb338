#include "qnv/codecs/gaussians/ellipsoid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace gs::qnv::gaussians {

Ellipsoid sorted(const glm::vec3& scales, const glm::mat3& axes) {
  std::array<int, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](int i) { return scales[i]; });
  Ellipsoid all;
  for (int k = 0; k < 3; ++k) {
    all.scales[k] = scales[order[static_cast<std::size_t>(k)]];
    all.axes[k] = axes[order[static_cast<std::size_t>(k)]];
  }
  if (glm::dot(glm::cross(all.axes[0], all.axes[1]), all.axes[2]) < 0) all.axes[2] = -all.axes[2];
  return all;
}

// Uses Jacobi's method.
Ellipsoid ellipsoid_of(const std::array<float, 6>& c) {
  double a[3][3] = {{c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4], c[5]}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 12; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (std::abs(a[p][q]) < 1e-12 * (std::abs(a[p][p]) + std::abs(a[q][q])) || a[p][q] == 0) continue;
        const double t = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double u = (t >= 0 ? 1 : -1) / (std::abs(t) + std::sqrt(t * t + 1));
        const double cosine = 1 / std::sqrt(u * u + 1), sine = u * cosine;
        for (auto& row : a) {
          const double x = row[p], y = row[q];
          row[p] = cosine * x - sine * y;
          row[q] = sine * x + cosine * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = cosine * x - sine * y;
          a[q][k] = sine * x + cosine * y;
        }
        for (auto& row : v) {
          const double x = row[p], y = row[q];
          row[p] = cosine * x - sine * y;
          row[q] = sine * x + cosine * y;
        }
      }
  glm::vec3 scales;
  glm::mat3 axes;
  for (int k = 0; k < 3; ++k) {
    scales[k] = static_cast<float>(std::sqrt(std::max(a[k][k], 0.0)));
    axes[k] = {static_cast<float>(v[0][k]), static_cast<float>(v[1][k]), static_cast<float>(v[2][k])};
  }
  return sorted(scales, axes);
}

}  // namespace gs::qnv::gaussians
