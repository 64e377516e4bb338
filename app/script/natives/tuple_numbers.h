#pragma once

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

// Numbers of SFColor and SFRotation, in double precision.
namespace gs::app::script {

/// Sets red, green and blue from hue, saturation and value, each 0 to 1. Hues beyond that are periodic.
inline void rgb_of(double h, double s, double v, double* c) {
  h = std::isfinite(h) ? h - std::floor(h) : 0;
  const double part = h * 6;
  const int sector = static_cast<int>(part) % 6;
  const double f = part - std::floor(part), p = v * (1 - s), q = v * (1 - s * f), t = v * (1 - s * (1 - f));
  const double all[6][3] = {{v, t, p}, {q, v, p}, {p, v, t}, {p, q, v}, {t, p, v}, {v, p, q}};
  std::copy(all[sector], all[sector] + 3, c);
}

/// Sets hue, saturation and value from red, green and blue. Greys have the hue 0.
inline void hsv_of(const double* c, double* hsv) {
  const double most = std::max({c[0], c[1], c[2]}), least = std::min({c[0], c[1], c[2]}), range = most - least;
  hsv[0] = 0;
  if (range > 0) {
    hsv[0] = most == c[0]   ? (c[1] - c[2]) / range
             : most == c[1] ? 2 + (c[2] - c[0]) / range
                            : 4 + (c[0] - c[1]) / range;
    hsv[0] /= 6;
    hsv[0] -= std::floor(hsv[0]);
  }
  hsv[1] = most > 0 ? range / most : 0;
  hsv[2] = most;
}

/// Returns the rotation of an axis and an angle in radians. An axis of length 0 gives none.
inline glm::dquat quaternion(const double* c) {
  const glm::dvec3 axis(c[0], c[1], c[2]);
  const double size = glm::length(axis);
  return size > 0 ? glm::angleAxis(c[3], axis / size) : glm::dquat(1, 0, 0, 0);
}

/// Sets the axis and the angle of a rotation. No rotation has the axis z.
inline void rotation_of(glm::dquat q, double* c) {
  q = glm::normalize(q);
  const glm::dvec3 v(q.x, q.y, q.z);
  const double size = glm::length(v);
  c[3] = 2 * std::atan2(size, q.w);
  const glm::dvec3 axis = size > 0 ? v / size : glm::dvec3(0, 0, 1);
  c[0] = axis.x;
  c[1] = axis.y;
  c[2] = axis.z;
}

}  // namespace gs::app::script
