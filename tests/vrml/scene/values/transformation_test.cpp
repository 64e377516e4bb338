#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

namespace gs::vrml {
namespace {

using glm::dvec3;

TEST_CASE("turns a Billboard without an axis to the viewer, with its Y axis upwards (VRML97 6.6)") {
  for (const dvec3& viewer : {dvec3(0, 0, 5), dvec3(3, -2, 1), dvec3(-4, 7, -2), dvec3(0, 6, 0)})
    for (const dvec3& up : {dvec3(0, 1, 0), dvec3(1, 0, 0), dvec3(0.3, -2, 0.4), dvec3(-5, 0.1, 3)}) {
      if (glm::length(glm::cross(viewer, up)) < 1e-9) continue;
      const glm::dmat3 turned(billboard_matrix(SFVec3f(0), viewer, up));
      const dvec3 z = glm::normalize(viewer);
      // Component of the up direction in the plane that faces the viewer.
      const dvec3 y = glm::normalize(up - z * glm::dot(up, z));
      CHECK(glm::length(turned[2] - z) < 1e-12);
      CHECK(glm::length(turned[1] - y) < 1e-12);
      CHECK(glm::determinant(turned) == Approx(1));
    }
}

TEST_CASE("returns a rotation for a Billboard, whatever the up direction of the viewer is") {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const dvec3& viewer : {dvec3(0, 5, 0), dvec3(0, 0, 5), dvec3(1, 1, 0)})
    for (const dvec3& up : {dvec3(0), viewer, -viewer, dvec3(kNone), dvec3(kNone, 1, 0)}) {
      const glm::dmat3 turned(billboard_matrix(SFVec3f(0), viewer, up));
      CHECK(glm::determinant(turned) == Approx(1));
      CHECK(glm::length(turned[2] - glm::normalize(viewer)) < 1e-12);
    }
}

TEST_CASE("transforms directions without translation, and keeps them if there is no inverse") {
  const glm::dmat4 moved = glm::rotate(glm::translate(glm::dmat4(1), {5, 6, 7}), 1.2, dvec3(0, 0, 1));
  CHECK(glm::length(direction_in_local({-std::sin(1.2), std::cos(1.2), 0}, moved) - dvec3(0, 1, 0)) < 1e-12);
  CHECK(direction_in_local({1, 2, 3}, glm::dmat4(0)) == dvec3(1, 2, 3));
}

}  // namespace
}  // namespace gs::vrml
