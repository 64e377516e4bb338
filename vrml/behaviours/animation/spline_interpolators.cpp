#include "vrml/behaviours/animation/interpolation.h"
#include "vrml/behaviours/animation/rotations.h"
#include "vrml/events/execution.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

// Interpolators along smooth curves, and EaseInEaseOut (X3D clause 19).
namespace gs::vrml {
namespace {

struct Spline {
  enum : int { set_fraction, key_value, value_changed, key, key_velocity, closed, normalize_velocity };
};

double length_of(float value) { return std::abs(double{value}); }
template <class Vector>
double length_of(const Vector& value) {
  return glm::length(value);
}

// Velocities at the keys of a spline (X3D 19.2.4).
template <class T>
class Velocities {
 public:
  Velocities(Execution& execution, EventNode node, std::span<const float> keys, std::span<const T> values)
      : keys_(keys), values_(values), given_(execution.get<Array<T>>(node, Spline::key_velocity).span()) {
    const std::size_t count = values.size();
    all_given_ = given_.size() >= count;
    ends_given_ = !all_given_ && given_.size() == 2;
    if (!all_given_ && !ends_given_) given_ = {};
    // `closed` is ignored if the ends differ, or if their velocities are equal.
    closed_ = execution.get<SFBool>(node, Spline::closed) && values.front() == values.back() && given_.empty();
    if (execution.get<SFBool>(node, Spline::normalize_velocity) && !given_.empty() && execution.budget().spend(count))
      for (std::size_t i = 0; i + 1 < count; ++i) path_ += length_of(values[i + 1] - values[i]);
  }

  // Returns the velocity at the start of segment i.
  [[nodiscard]] T after(std::size_t i) const { return at(i) * static_cast<float>(factors(i).after); }
  // Returns the velocity at the end of segment i - 1.
  [[nodiscard]] T before(std::size_t i) const { return at(i) * static_cast<float>(factors(i).before); }

 private:
  struct Factors {
    double before = 1, after = 1;
  };

  [[nodiscard]] bool is_end(std::size_t i) const { return i == 0 || i + 1 == values_.size(); }

  [[nodiscard]] T at(std::size_t i) const {
    const std::size_t last = values_.size() - 1;
    if (all_given_ || (ends_given_ && is_end(i))) {
      const T velocity = given_[all_given_ ? i : i == 0 ? 0 : 1];
      const double length = length_of(velocity);
      return path_ > 0 && length > 0 ? velocity * static_cast<float>(path_ / length) : velocity;
    }
    if (!is_end(i)) return (values_[i + 1] - values_[i - 1]) / 2.0F;
    return closed_ ? (values_[1] - values_[last - 1]) / 2.0F : T(0);
  }

  // Returns the factors for intervals of different lengths (19.2.4): F+ for the next segment, F- for the previous one.
  [[nodiscard]] Factors factors(std::size_t i) const {
    const std::size_t last = values_.size() - 1;
    if (is_end(i) && !closed_) return {};
    const double before = is_end(i) ? double{keys_[last]} - keys_[last - 1] : double{keys_[i]} - keys_[i - 1];
    const double after = is_end(i) ? double{keys_[1]} - keys_[0] : double{keys_[i + 1]} - keys_[i];
    // F- has the later interval, and F+ has the earlier one.
    return before + after > 0 ? Factors{2 * after / (before + after), 2 * before / (before + after)} : Factors{};
  }

  std::span<const float> keys_;
  std::span<const T> values_, given_;
  bool all_given_ = false, ends_given_ = false, closed_ = false;
  double path_ = 0;  // length of the path; 0 if velocities keep their lengths
};

template <class T>
bool spline_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != Spline::set_fraction) return true;
  const MFFloat& keys = execution.get<MFFloat>(node, Spline::key);
  const Array<T>& values = execution.get<Array<T>>(node, Spline::key_value);
  const std::size_t count = std::min(keys.size(), values.size());
  if (count == 0) return false;
  const KeyPlace place = find_key(keys.span().first(count), std::get<SFFloat>(value));
  if (place.part == 0) {
    execution.send(node, Spline::value_changed, T(values[place.first]));
    return false;
  }
  const Velocities<T> velocities(execution, node, keys.span().first(count), values.span().first(count));
  const float s = place.part, s2 = s * s, s3 = s2 * s;
  execution.send(node, Spline::value_changed,
                 T(values[place.first] * (2 * s3 - 3 * s2 + 1) + values[place.second] * (3 * s2 - 2 * s3) +
                   velocities.after(place.first) * (s3 - 2 * s2 + s) + velocities.before(place.second) * (s3 - s2)));
  return false;
}

template <class T>
bool spline_first_value(Execution& execution, EventNode node, FieldValue& value) {
  const Array<T>& values = execution.get<Array<T>>(node, Spline::key_value);
  if (values.empty()) return false;
  value = values[0];
  return true;
}

constexpr std::array<std::string_view, Behaviour::kMaxEvents> kSplineEvents = {
    "set_fraction", "keyValue", "value_changed", "key", "keyVelocity", "closed", "normalizeVelocity"};

// ---- SquadOrientationInterpolator

// Returns the logarithm of a unit quaternion: half the angle times the axis.
glm::dvec3 quaternion_log(const glm::dquat& q) {
  const glm::dvec3 axis(q.x, q.y, q.z);
  const double sine = glm::length(axis);
  return sine > 0 ? axis * (std::atan2(sine, q.w) / sine) : glm::dvec3(0);
}

glm::dquat quaternion_exp(const glm::dvec3& v) {
  const double angle = glm::length(v);
  return angle > 0 ? glm::dquat(std::cos(angle), v * (std::sin(angle) / angle)) : glm::dquat(1, 0, 0, 0);
}

// Returns the quaternion of the same orientation that is nearer to `to`.
glm::dquat on_side_of(const glm::dquat& q, const glm::dquat& to) { return glm::dot(q, to) < 0 ? -q : q; }

// Returns the control point at key i for segments on both sides. At the ends, it is the key value itself.
glm::dquat squad_control(const MFRotation& values, std::size_t count, std::size_t i) {
  const glm::dquat at = quaternion_of(values[i]);
  if (i == 0 || i + 1 >= count) return at;
  const glm::dquat inverse = glm::conjugate(at), next = on_side_of(quaternion_of(values[i + 1]), at),
                   previous = on_side_of(quaternion_of(values[i - 1]), at);
  return at * quaternion_exp((quaternion_log(inverse * next) + quaternion_log(inverse * previous)) * -0.25);
}

glm::dquat squad_arc(const glm::dquat& from, const glm::dquat& to, double part) {
  return from * quaternion_exp(quaternion_log(glm::conjugate(from) * on_side_of(to, from)) * part);
}

bool squad_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != Spline::set_fraction) return true;
  const MFFloat& keys = execution.get<MFFloat>(node, Spline::key);
  const MFRotation& values = execution.get<MFRotation>(node, Spline::key_value);
  const std::size_t count = std::min(keys.size(), values.size());
  if (count == 0) return false;
  const KeyPlace place = find_key(keys.span().first(count), std::get<SFFloat>(value));
  if (place.part == 0) {
    execution.send(node, Spline::value_changed, SFRotation(values[place.first]));
    return false;
  }
  const glm::dquat from = quaternion_of(values[place.first]),
                   to = on_side_of(quaternion_of(values[place.second]), from),
                   control_from = squad_control(values, count, place.first),
                   control_to = on_side_of(squad_control(values, count, place.second), control_from);
  const double h = place.part;
  const glm::dquat made = squad_arc(squad_arc(from, to, h), squad_arc(control_from, control_to, h), 2 * h * (1 - h));
  execution.send(node, Spline::value_changed, rotation_of(made));
  return false;
}

// ---- EaseInEaseOut

struct Ease {
  enum : int { set_fraction, ease, modified_fraction, key };
};

// Returns the fraction between two keys, which starts and ends slowly. `out` and `in` are the parts of the interval
// with increasing and with decreasing speed.
double eased(double u, double out, double in) {
  const double sum = out + in;
  if (!(sum >= 0) || !std::isfinite(sum)) return u;
  if (sum > 1) {
    out /= sum;
    in /= sum;
  }
  const double t = 1 / (2 - out - in);
  if (u < out) return t / out * u * u;
  if (u <= 1 - in) return t * (2 * u - out);
  return 1 - t * (1 - u) * (1 - u) / in;
}

bool ease_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event != Ease::set_fraction) return true;
  const MFFloat& keys = execution.get<MFFloat>(node, Ease::key);
  const MFVec2f& eases = execution.get<MFVec2f>(node, Ease::ease);
  const std::size_t count = std::min(keys.size(), eases.size());
  if (count == 0) return false;
  const float fraction = std::get<SFFloat>(value);
  const KeyPlace place = find_key(keys.span().first(count), fraction);
  const float made = place.part > 0 ? static_cast<float>(eased(place.part, eases[place.first].y, eases[place.second].x))
                     : fraction >= keys[count - 1] ? 1.0F
                                                   : 0.0F;
  execution.send(node, Ease::modified_fraction, SFFloat{made});
  return false;
}

}  // namespace

const Behaviour kSplinePositionInterpolatorBehaviour = {
    .events = kSplineEvents, .on_event = spline_event<SFVec3f>, .unsent_value = spline_first_value<SFVec3f>};
const Behaviour kSplinePositionInterpolator2DBehaviour = {
    .events = kSplineEvents, .on_event = spline_event<SFVec2f>, .unsent_value = spline_first_value<SFVec2f>};
const Behaviour kSplineScalarInterpolatorBehaviour = {
    .events = kSplineEvents, .on_event = spline_event<SFFloat>, .unsent_value = spline_first_value<SFFloat>};
const Behaviour kSquadOrientationInterpolatorBehaviour = {
    .events = {"set_fraction", "keyValue", "value_changed", "key"},
    .on_event = squad_event,
    .unsent_value = spline_first_value<SFRotation>};
const Behaviour kEaseInEaseOutBehaviour = {
    .events = {"set_fraction", "easeInEaseOut", "modifiedFraction_changed", "key"}, .on_event = ease_event};

}  // namespace gs::vrml
