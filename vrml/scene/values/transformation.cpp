#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include "base/finite.h"

#include <cmath>

namespace gs::vrml {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;

constexpr double kTiny = 1e-12;

SFVec3f usable(const SFVec3f& v, const SFVec3f& otherwise) { return finite(v) ? v : otherwise; }

/// Reports whether the rotation is valid and different from the identity.
bool turns(const SFRotation& r) {
  return r.angle != 0 && std::isfinite(r.angle) && finite(SFVec3f{r.x, r.y, r.z}) && (r.x != 0 || r.y != 0 || r.z != 0);
}

}  // namespace

dmat3 rotation_matrix(const SFRotation& r) {
  if (!turns(r)) return dmat3(1);
  const dvec3 axis = glm::normalize(dvec3(r.x, r.y, r.z));
  return dmat3(glm::rotate(dmat4(1), double{r.angle}, axis));
}

dmat4 transform_matrix(const SFVec3f& translation, const SFVec3f& center, const SFRotation& rotation,
                       const SFVec3f& scale, const SFRotation& scale_orientation) {
  const dvec3 moved(usable(translation, SFVec3f(0))), middle(usable(center, SFVec3f(0)));
  const SFVec3f scaled = usable(scale, SFVec3f(1));
  dmat3 linear(1);
  if (turns(rotation)) linear = rotation_matrix(rotation);
  if (scaled != SFVec3f(1)) {
    dmat3 scaling(1);
    for (int i = 0; i < 3; ++i) scaling[i][i] = scaled[i];
    if (turns(scale_orientation)) {
      const dmat3 oriented = rotation_matrix(scale_orientation);
      scaling = oriented * scaling * glm::transpose(oriented);
    }
    linear = linear * scaling;
  }
  dmat4 result(linear);
  result[3] = glm::dvec4(moved + middle - linear * middle, 1);
  return result;
}

dmat4 billboard_matrix(const SFVec3f& axis_of_rotation, const dvec3& viewer, const dvec3& up) {
  const double distance = glm::length(viewer);
  if (!(distance > kTiny) || !std::isfinite(distance)) return dmat4(1);
  const dvec3 to_viewer = viewer / distance;
  dvec3 axis(usable(axis_of_rotation, SFVec3f(0, 1, 0)));
  if (axis == dvec3(0)) {
    const auto beside = [&](const dvec3& above) { return glm::cross(above, to_viewer); };
    dvec3 side = beside(up);
    // Uses another axis if the viewer looks along its up direction or a value is not finite.
    if (!(glm::length(side) > 1e-6 * glm::length(up))) side = beside(dvec3(0, 1, 0));
    if (!(glm::length(side) > 1e-6)) side = beside(dvec3(0, 0, -1));
    side = glm::normalize(side);
    return dmat4(dmat3(side, glm::cross(to_viewer, side), to_viewer));
  }
  axis = glm::normalize(axis);
  const dvec3 z(0, 0, 1);
  const dvec3 from = z - axis * glm::dot(axis, z), to = to_viewer - axis * glm::dot(axis, to_viewer);
  if (glm::length(from) < 1e-6 || glm::length(to) < 1e-6) return dmat4(1);  // undefined by the standard
  return glm::rotate(dmat4(1), std::atan2(glm::dot(axis, glm::cross(from, to)), glm::dot(from, to)), axis);
}

dvec3 viewer_in_local(const dvec3& viewer, const dmat4& world_from_local) {
  const dvec3 local(glm::inverse(world_from_local) * glm::dvec4(viewer, 1));
  return std::isfinite(local.x + local.y + local.z) ? local : dvec3(0);
}

dvec3 direction_in_local(const dvec3& direction, const dmat4& world_from_local) {
  const dvec3 local = glm::inverse(dmat3(world_from_local)) * direction;
  return std::isfinite(local.x + local.y + local.z) ? local : direction;
}

dmat4 viewer_matrix(const SFVec3f& position, const SFRotation& orientation) {
  dmat4 matrix(rotation_matrix(orientation));
  matrix[3] = glm::dvec4(usable(position, SFVec3f(0)), 1);
  return matrix;
}

}  // namespace gs::vrml
