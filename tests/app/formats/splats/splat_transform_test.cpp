#include "app/formats/splats/splat_transform.h"

#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "render/gaussians/gaussian_harmonics.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <vector>

namespace gs::app {
namespace splat_transform_test {

glm::mat3 covariance(const glm::vec3& scales, const glm::vec4& rotation) {
  const auto c = qnv::gaussians::covariance_of(scales, rotation);
  return glm::mat3(c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]);
}

void check_near(const glm::mat3& a, const glm::mat3& b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) CHECK(a[i][j] == Approx(b[i][j]).margin(1e-4));
}

const glm::mat3 kTurn = glm::mat3_cast(glm::angleAxis(1.1f, glm::normalize(glm::vec3(1, 2, -0.5f))));

std::vector<glm::mat3> transformations() {
  const glm::mat3 stretch(2, 0, 0, 0, 0.5f, 0, 0, 0, 1), shear(1, 0.4f, 0, 0, 1, 0, 0.2f, 0, 1);
  const glm::mat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  return {glm::mat3(1), 3.0f * kTurn, kTurn * mirror, kTurn * stretch, shear};
}

TEST_CASE("transforms the covariance of a splat: M C M^T") {
  const glm::vec4 turn = glm::vec4(0.1f, -0.7f, 0.2f, 0.6f);
  for (const glm::mat3& m : transformations())
    for (const glm::vec3 start : {glm::vec3(0.3f, 0.2f, 0.05f), glm::vec3(1, 0, 0.5f)}) {
      glm::vec3 scales = start;
      glm::vec4 rotation = 2.0f * turn;  // of any length
      const glm::mat3 before = covariance(scales, glm::normalize(turn));
      SplatTransform(m).apply(scales, rotation);
      check_near(covariance(scales, glm::normalize(rotation)), m * before * glm::transpose(m));
    }
}

TEST_CASE("turns spherical harmonics with the splat") {
  std::vector<glm::vec3> coefficients;
  for (int i = 0; i < 15; ++i) coefficients.emplace_back(0.1f * static_cast<float>(i % 4), 0.02f * i, -0.03f * i);
  for (const glm::mat3& turn : {glm::mat3(1), kTurn, glm::mat3(0, 0, 1, -1, 0, 0, 0, -1, 0)})
    for (int degree = 1; degree <= 3; ++degree) {
      const auto count = static_cast<std::size_t>((degree + 1) * (degree + 1) - 1);
      std::vector<glm::vec3> turned(coefficients.begin(), coefficients.begin() + static_cast<std::ptrdiff_t>(count));
      SplatTransform(2.0f * turn).apply(turned);
      for (const glm::vec3 d : {glm::vec3(1, 0, 0), glm::vec3(0, 0.6f, -0.8f), glm::normalize(glm::vec3(-1, 2, 3))}) {
        const glm::vec3 expected = render::gaussian_color(glm::vec3(5), coefficients.data(), degree, d);
        const glm::vec3 found = render::gaussian_color(glm::vec3(5), turned.data(), degree, turn * d);
        for (int k = 0; k < 3; ++k) CHECK(found[k] == Approx(expected[k]).margin(1e-4));
      }
    }
}

TEST_CASE("survives transformations that flatten, and splats without a rotation") {
  glm::vec3 scales(1, 2, 3);
  glm::vec4 rotation(0, 0, 0, 1);
  SplatTransform(glm::mat3(0)).apply(scales, rotation);
  CHECK(glm::length(scales) < 1e-3f);
  scales = {1, 2, 3};
  SplatTransform(glm::mat3(1, 0, 0, 0, 1, 0, 0, 0, 0)).apply(scales, rotation);
  CHECK(std::isfinite(glm::dot(scales, scales)));
  glm::vec4 none(0);
  SplatTransform(kTurn).apply(scales, none);
  CHECK(none == glm::vec4(0));
}

}  // namespace splat_transform_test
}  // namespace gs::app
