#include "app/formats/splats/splat_transform.h"

#include "qnv/codecs/gaussians/ellipsoid.h"
#include "render/gaussians/gaussian_harmonics.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace gs::app {
namespace {

constexpr std::array<std::size_t, 3> kFirstOfDegree = {0, 3, 8};
constexpr std::size_t kDirections = 24;

/// Returns directions that are spread evenly over a sphere (Fibonacci).
std::array<glm::vec3, kDirections> even_directions() {
  std::array<glm::vec3, kDirections> all;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / kDirections, turn = 2.3999632f * static_cast<float>(i);
    const float radius = std::sqrt(1 - z * z);
    all[i] = {radius * std::cos(turn), radius * std::sin(turn), z};
  }
  return all;
}

/// Solves a x = b for symmetric, positive `a`, by elimination. `b` has one column per right side.
template <std::size_t N>
void solve(std::array<std::array<double, N>, N>& a, std::array<std::array<double, N>, N>& b) {
  for (std::size_t k = 0; k < N; ++k)
    for (std::size_t i = 0; i < N; ++i) {
      if (i == k) continue;
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = 0; j < N; ++j) {
        a[i][j] -= factor * a[k][j];
        b[i][j] -= factor * b[k][j];
      }
    }
  for (std::size_t i = 0; i < N; ++i)
    for (double& value : b[i]) value /= a[i][i];
}

/// Finds the matrix of degree L that turns coefficients by Q: sum c'_i Y_i(d) = sum c_i Y_i(Q^T d) for all d.
template <std::size_t N, class Rows>
void find_matrix(std::size_t first, const glm::mat3& back, Rows& rows) {
  std::array<std::array<double, N>, N> squares{}, products{};
  for (const glm::vec3& direction : even_directions()) {
    std::array<double, 15> here{}, there{};
    render::for_harmonics(3, direction, [&](std::size_t i, float value) { here[i] = value; });
    render::for_harmonics(3, back * direction, [&](std::size_t i, float value) { there[i] = value; });
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) {
        squares[i][j] += here[first + i] * here[first + j];
        products[i][j] += here[first + i] * there[first + j];
      }
  }
  solve(squares, products);
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) rows[first + i][j] = static_cast<float>(products[i][j]);
}

/// Returns the orthogonal matrix that is nearest to `m` (Higham's iteration), or the identity if `m` is singular.
glm::mat3 orthogonal_part(const glm::mat3& m) {
  glm::dmat3 q(m);
  for (int turn = 0; turn < 60; ++turn) {
    const double determinant = glm::determinant(q);
    if (!std::isfinite(determinant) || std::abs(determinant) < 1e-30) return glm::mat3(1);
    const glm::dmat3 next = 0.5 * (q + glm::transpose(glm::inverse(q)));
    double change = 0;
    for (int i = 0; i < 3; ++i) change += glm::dot(next[i] - q[i], next[i] - q[i]);
    q = next;
    if (change < 1e-24) break;
  }
  return glm::mat3(q);
}

}  // namespace

SplatTransform::SplatTransform(const glm::mat3& linear) : linear_(linear) {
  const glm::mat3 orthogonal = orthogonal_part(linear);
  scale_ = std::cbrt(std::abs(glm::determinant(linear)));
  float difference = 0;
  for (int i = 0; i < 3; ++i) difference += glm::length(linear[i] - scale_ * orthogonal[i]);
  similar_ = scale_ > 0 && difference <= 1e-4f * scale_ && glm::determinant(orthogonal) > 0;
  if (similar_) {
    const glm::quat turn = glm::quat_cast(orthogonal);
    turn_ = {turn.x, turn.y, turn.z, turn.w};
  }
  find_turn(orthogonal);
}

void SplatTransform::find_turn(const glm::mat3& orthogonal) {
  const glm::mat3 back = glm::transpose(orthogonal);
  find_matrix<3>(kFirstOfDegree[0], back, harmonics_);
  find_matrix<5>(kFirstOfDegree[1], back, harmonics_);
  find_matrix<7>(kFirstOfDegree[2], back, harmonics_);
}

void SplatTransform::apply(glm::vec3& scales, glm::vec4& rotation) const {
  const float length = std::sqrt(glm::dot(rotation, rotation));
  if (!(length > 0) || !std::isfinite(length)) return;  // readers of splats leave it out
  const glm::quat unit(rotation.w / length, rotation.x / length, rotation.y / length, rotation.z / length);
  if (similar_) {
    const glm::quat turned = glm::quat(turn_.w, turn_.x, turn_.y, turn_.z) * unit;
    scales *= scale_;
    rotation = {turned.x, turned.y, turned.z, turned.w};
    return;
  }
  // The columns of M R S are conjugate radii of the new ellipsoid.
  glm::mat3 radii = linear_ * glm::mat3_cast(unit);
  for (int i = 0; i < 3; ++i) radii[i] *= scales[i];
  const glm::mat3 covariance = radii * glm::transpose(radii);
  const qnv::gaussians::Ellipsoid axes = qnv::gaussians::ellipsoid_of(
      {covariance[0][0], covariance[0][1], covariance[0][2], covariance[1][1], covariance[1][2], covariance[2][2]});
  const glm::quat turned = glm::quat_cast(axes.axes);
  scales = axes.scales;
  rotation = {turned.x, turned.y, turned.z, turned.w};
}

void SplatTransform::apply(std::span<glm::vec3> coefficients) const {
  for (std::size_t degree = 0; degree < kFirstOfDegree.size(); ++degree) {
    const std::size_t first = kFirstOfDegree[degree], count = 2 * degree + 3;
    if (coefficients.size() < first + count) return;
    std::array<glm::vec3, 7> turned{};
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) turned[i] += harmonics_[first + i][j] * coefficients[first + j];
    std::copy_n(turned.begin(), count, coefficients.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace gs::app
