#pragma once

#include "vrml/behaviours/animation/interpolation.h"
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
  static constexpr bool is_rotation = false, is_color = false;
};

struct ScalarSpace : StraightSpace {
  static FollowerValues values_of(const FieldValue& value) { return {glm::dvec4(std::get<SFFloat>(value), 0, 0, 0)}; }
  static SFFloat value_of(const FollowerValues& values) { return static_cast<SFFloat>(values[0].x); }
};

/// Colours as hue, saturation and value, like those of a ColorInterpolator. The hue takes the shorter way.
struct ColorSpace : StraightSpace {
  static constexpr bool is_color = true;
  static constexpr double kTurn = 6;  // hues of the colour circle

  static FollowerValues values_of(const FieldValue& value) {
    const Hsv color = hsv_of(std::get<SFColor>(value));
    return {glm::dvec4(color.hue, color.saturation, color.value, 0)};
  }
  static SFColor value_of(const FollowerValues& values) {
    const glm::dvec4& v = values[0];
    const double hue = v.x - kTurn * std::floor(v.x / kTurn);
    return color_of({hue < kTurn ? hue : 0, std::clamp(v.y, 0.0, 1.0), std::clamp(v.z, 0.0, 1.0)});
  }
  static bool has_hue(const glm::dvec4& color) { return color.y > 0 && color.z > 0; }
  /// Adds `part` of the change from one colour to another. A colour without hue gets the hue of the other colour.
  static void add_change(glm::dvec4& color, const glm::dvec4& from, const glm::dvec4& to, double part) {
    double turn = has_hue(from) && has_hue(to) ? to.x - from.x : 0;
    turn -= kTurn * std::round(turn / kTurn);
    if (has_hue(to) && !has_hue(from) && !has_hue(color)) color.x = to.x;
    color += glm::dvec4(turn, to.y - from.y, to.z - from.z, 0) * part;
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
  static constexpr bool is_rotation = true, is_color = false;
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
    } else if constexpr (Space::is_color) {
      Space::add_change(values[i], from[i], to[i], part);
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
    if constexpr (Space::is_color) {
      const SFColor first = Space::value_of({a[i]}), second = Space::value_of({b[i]});
      one = glm::length(glm::dvec3(first.r, first.g, first.b) - glm::dvec3(second.r, second.g, second.b));
    }
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
