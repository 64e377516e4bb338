#pragma once

#include "vrml/behaviours/animation/rotations.h"
#include "vrml/event_model/states.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

// Values of followers as lists of four numbers. A space is a type of values, with conversions and the path between two
// values.
namespace gs::vrml {

/// Straight paths, for numbers and vectors.
struct StraightSpace {
  static constexpr bool is_rotation = false;
};

struct ScalarSpace : StraightSpace {
  static FollowerValues values_of(const FieldValue& value) { return {glm::dvec4(std::get<SFFloat>(value), 0, 0, 0)}; }
  static SFFloat value_of(const FollowerValues& values) { return static_cast<SFFloat>(values[0].x); }
};

/// Colours as red, green and blue.
struct ColorSpace : StraightSpace {
  static FollowerValues values_of(const FieldValue& value) {
    const SFColor& color = std::get<SFColor>(value);
    return {glm::dvec4(color.r, color.g, color.b, 0)};
  }
  static SFColor value_of(const FollowerValues& values) {
    const glm::vec4 color(glm::clamp(values[0], 0.0, 1.0));
    return {color.r, color.g, color.b};
  }
};

[[nodiscard]] inline glm::dvec4 four_of(const SFVec2f& point) { return {point, 0, 0}; }
[[nodiscard]] inline glm::dvec4 four_of(const SFVec3f& point) { return {point, 0}; }

template <class Vector>
struct PointSpace : StraightSpace {
  static FollowerValues values_of(const FieldValue& value) { return {four_of(std::get<Vector>(value))}; }
  static Vector value_of(const FollowerValues& values) { return Vector(values[0]); }
};

template <class Vector>
struct ListSpace : StraightSpace {
  static FollowerValues values_of(const FieldValue& value) {
    FollowerValues values;
    for (const Vector& point : std::get<Array<Vector>>(value)) values.push_back(four_of(point));
    return values;
  }
  static Array<Vector> value_of(const FollowerValues& values) {
    Array<Vector> list;
    list.resize(values.size());
    Vector* to = list.mutable_data();
    for (const glm::dvec4& value : values) *to++ = Vector(value);
    return list;
  }
};

/// Orientations as unit quaternions.
struct OrientationSpace {
  static constexpr bool is_rotation = true;
  static glm::dquat quaternion(const glm::dvec4& v) { return {v.w, v.x, v.y, v.z}; }
  static glm::dvec4 four(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

  static FollowerValues values_of(const FieldValue& value) {
    return {four(quaternion_of(std::get<SFRotation>(value)))};
  }
  static SFRotation value_of(const FollowerValues& values) { return rotation_of(quaternion(values[0])); }
  /// Returns `part` of the rotation by `q`, along the shorter way.
  static glm::dquat part_of(glm::dquat q, double part) {
    if (q.w < 0) q = -q;
    const glm::dvec3 axis(q.x, q.y, q.z);
    const double sine = glm::length(axis);
    if (!(sine > 0)) return {1, 0, 0, 0};
    const double half = std::atan2(sine, q.w) * part;
    return {std::cos(half), axis * (std::sin(half) / sine)};
  }
};

/// Adds `part` of the change between two destinations to the values.
template <class Space>
void add_change(FollowerValues& values, const FollowerValues& from, const FollowerValues& to, double part) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if constexpr (Space::is_rotation) {
      const glm::dquat change = glm::conjugate(Space::quaternion(from[i])) * Space::quaternion(to[i]);
      values[i] = Space::four(glm::normalize(Space::quaternion(values[i]) * Space::part_of(change, part)));
    } else {
      values[i] += (to[i] - from[i]) * part;
    }
}

/// Moves the values towards `to` by a part of the way.
template <class Space>
void approach(FollowerValues& values, const FollowerValues& to, double part) {
  const FollowerValues from = values;
  add_change<Space>(values, from, to, part);
}

/// Returns the largest distance between two values: of points, or the angle between orientations in radians.
template <class Space>
[[nodiscard]] double distance(const FollowerValues& a, const FollowerValues& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double one = glm::length(a[i] - b[i]);
    if constexpr (Space::is_rotation) one = 2 * std::acos(std::clamp(std::abs(glm::dot(a[i], b[i])), 0.0, 1.0));
    if (!(one <= largest)) largest = std::isfinite(one) ? one : 0;
  }
  return largest;
}

/// Gives a list the length of another one. New values are those of the other list, so that they do not move.
template <class Space>
void fit(FollowerValues& values, const FollowerValues& other) {
  if (values.size() >= other.size()) {
    values.resize(other.size());
  } else {
    values.insert(values.end(), other.begin() + static_cast<std::ptrdiff_t>(values.size()), other.end());
  }
}

}  // namespace gs::vrml
