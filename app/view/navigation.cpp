#include "app/view/navigation.h"
#include "base/finite.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gs::app {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr glm::vec3 kUp(0, 1, 0);            // up direction of a world (VRML97 4.4.5)
constexpr float kLongestStep = 0.25f;        // seconds; longer steps are shortened to this
constexpr float kEaseTime = 0.08f;           // seconds; time constant of the speed after a key changes (63 %)
constexpr float kZoomTime = 0.06f;           // seconds; time constant of the wheel
constexpr float kZoomNotch = 0.85f;          // factor on the distance for one notch
constexpr float kTurnRate = kPi / 3;         // radians/s for a held key
constexpr float kSteepest = 85 * kPi / 180;  // radians; max pitch in WALK
constexpr float kLevelTime = 0.15f;          // seconds; time constant with which WALK removes roll
constexpr float kFast = 4;

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return finite(length) && length > 1e-6f ? v / length : otherwise;
}
template <class Vector>
Vector clean(const Vector& v, float limit) {
  return finite(v) ? glm::clamp(v, Vector(-limit), Vector(limit)) : Vector(0.0f);
}
glm::dvec3 clean_place(const glm::dvec3& v) {
  return finite(v) ? glm::clamp(v, glm::dvec3(-kFarthest), glm::dvec3(kFarthest)) : glm::dvec3(0);
}
float clean(float v, float limit) { return finite(v) ? std::clamp(v, -limit, limit) : 0.0f; }

/// Returns the size of a pixel in metres at `distance` metres along the view direction.
float pixel_size(const Pose& pose, float distance, const glm::vec2& viewport) {
  const float pixels = std::max(1.0f, std::min(viewport.x, viewport.y));
  if (pose.height > 0) return static_cast<float>(pose.height) / pixels;
  return 2 * distance * std::tan(pose.field_of_view / 2) / pixels;
}

// Scales the height of a parallel projection by `left`, the factor by which the viewer's distance changes.
void scale_height(Pose& pose, double left) {
  if (pose.height > 0) pose.height *= left;
}

/// Returns the distance of the object that the viewer examines, in metres. The result is limited, so that movement
/// remains possible.
float examined_distance(const Navigation& state, const std::optional<glm::dvec3>& target) {
  const glm::vec3 to_target(target.value_or(state.center) - state.pose.position);
  const float along = glm::dot(to_target, state.pose.forward());
  const float distance = along > 0 ? along : static_cast<float>(glm::length(state.center - state.pose.position));
  return std::clamp(distance, state.scene_size * 1e-3f, state.scene_size * 1e3f);
}

/// Returns the shortest rotation between two unit vectors.
glm::quat rotation_between(const glm::vec3& from, const glm::vec3& to) {
  const float cosine = glm::dot(from, to);
  if (cosine > 0.9999999f) return {1, 0, 0, 0};
  if (cosine < -0.9999999f)
    return glm::angleAxis(kPi, unit_or(glm::cross(from, glm::vec3(1, 0, 0)), glm::vec3(0, 0, 1)));
  const glm::vec3 axis = glm::cross(from, to);
  return glm::normalize(glm::quat(1 + cosine, axis.x, axis.y, axis.z));
}

/// Returns the horizontal part of a direction as a unit vector; a zero vector if there is none.
glm::vec3 level(const Navigation& state, const glm::vec3& direction) {
  return unit_or(direction - state.up * glm::dot(direction, state.up), glm::vec3(0));
}

/// Turns the view by `right` and `up` radians. Yaw is about the world's up direction, so that a level view stays level.
glm::quat turned(const Navigation& state, float right, float up) {
  const Pose& pose = state.pose;
  const float sense = glm::dot(pose.up(), state.up) < 0 ? -1.0f : 1.0f;  // keeps right and left for an upside-down view
  const glm::quat yaw = glm::angleAxis(-right * sense, state.up);
  const glm::quat pitch = glm::angleAxis(up, glm::vec3(1, 0, 0));
  return glm::normalize(yaw * pose.orientation * pitch);
}

/// Turns the view in WALK by `right` and `up` radians. Limits the pitch to 85 degrees, and multiplies the roll by
/// `roll_left`.
glm::quat turned_level(const Navigation& state, float right, float up, float roll_left) {
  // Compute in a space in which +Y is up.
  const glm::quat upright = rotation_between(state.up, kUp);
  Pose pose;
  pose.orientation = upright * state.pose.orientation;
  const glm::vec3 forward = pose.forward();
  const glm::vec3 ahead = glm::vec3(forward.x, 0, forward.z);
  // If the view direction is vertical, the top of the picture is the heading.
  const glm::vec3 heading = glm::length(ahead) > 1e-3f ? ahead : pose.up() * (forward.y > 0 ? -1.0f : 1.0f);
  const float yaw = std::atan2(-heading.x, -heading.z);
  const float pitch = std::asin(std::clamp(forward.y, -1.0f, 1.0f));
  const glm::quat level = glm::angleAxis(yaw, kUp) * glm::angleAxis(pitch, glm::vec3(1, 0, 0));
  const glm::quat tilt = glm::inverse(level) * pose.orientation;  // roll about the view direction
  float roll = 2 * std::atan2(tilt.z, tilt.w);
  if (roll > kPi) roll -= 2 * kPi;
  if (roll < -kPi) roll += 2 * kPi;
  roll = std::abs(roll) < 1e-4f ? 0.0f : roll * roll_left;
  const float steep = std::max(kSteepest, std::abs(pitch));  // an initial view that is steeper stays allowed
  return glm::inverse(upright) * glm::angleAxis(yaw - right, kUp) *
         glm::angleAxis(std::clamp(pitch + up, -steep, steep), glm::vec3(1, 0, 0)) *
         glm::angleAxis(roll, glm::vec3(0, 0, 1));
}

/// Moves `value` exponentially towards `target`. Returns the mean of `value` over the step. Using the mean makes paths
/// independent of the step length.
template <class Vector>
Vector ease(Vector& value, const Vector& target, float seconds) {
  const float left = std::exp(-seconds / kEaseTime);
  const Vector difference = value - target;
  value = target + difference * left;
  if (target == Vector(0.0f) && glm::length(value) < 1e-3f) value = Vector(0.0f);
  return seconds > 0 ? target + difference * (kEaseTime / seconds * (1 - left)) : target;
}

void rotate_about_center(Navigation& state, float right, float up) {
  const Pose before = state.pose;
  state.pose.orientation = turned(state, right, up);
  const glm::quat change = state.pose.orientation * glm::inverse(before.orientation);
  state.pose.position = state.center + glm::dquat(change) * (before.position - state.center);
}

/// Applies a drag: rotating and panning in EXAMINE and PAN, looking around and sliding in FLY and WALK.
void apply_drag(Navigation& state, const NavigationInput& input) {
  const float radians = kPi / std::max(1.0f, std::min(input.viewport.x, input.viewport.y));
  const glm::vec2 moved = input.moved;
  switch (input.drag) {
    case Drag::rotate:
      rotate_about_center(state, moved.x * radians, -moved.y * radians);
      break;
    case Drag::look:
      state.pose.orientation = state.mode == NavigationMode::walk
                                   ? turned_level(state, moved.x * radians / 2, -moved.y * radians / 2, 1)
                                   : turned(state, moved.x * radians / 2, -moved.y * radians / 2);
      break;
    case Drag::pan: {
      const float metres = pixel_size(state.pose, examined_distance(state, input.target), input.viewport);
      state.pose.position += glm::dvec3((-state.pose.right() * moved.x + state.pose.up() * moved.y) * metres);
      break;
    }
    case Drag::zoom:
    case Drag::travel:
    case Drag::none:
      break;
  }
}

/// Applies a part of the pending wheel notches. The total movement does not depend on the step length.
void apply_zoom(Navigation& state, float seconds) {
  if (state.zoom_left == 0) return;
  const float left = std::exp(-seconds / kZoomTime);
  float now = state.zoom_left * (1 - left);
  state.zoom_left *= left;
  if (std::abs(state.zoom_left) < 0.01f) {
    now += state.zoom_left;
    state.zoom_left = 0;
  }
  if (state.mode == NavigationMode::fly || state.mode == NavigationMode::walk) {
    glm::vec3 ahead = state.pose.forward();
    if (state.mode == NavigationMode::walk) ahead = level(state, ahead);
    state.pose.position += glm::dvec3(ahead * (state.speed * 0.5f * now));
    scale_height(state.pose, std::pow(double{kZoomNotch}, double{now}));
    return;
  }
  const glm::vec3 away(state.pose.position - state.zoom_target);
  const float nearest = state.scene_size * 1e-4f;
  const float farthest = state.scene_size * 1e3f;
  const float distance = glm::length(away);
  const float next = std::clamp(distance * std::pow(kZoomNotch, now), std::min(nearest, distance), farthest);
  state.pose.position = state.zoom_target + glm::dvec3(unit_or(away, -state.pose.forward()) * next);
  if (distance > 0) scale_height(state.pose, double{next} / double{distance});
}

/// Applies held keys, and the travel drag, which sets the speed like an analog key.
void apply_keys(Navigation& state, const NavigationInput& input, float seconds) {
  glm::vec3 want_move = glm::clamp(input.move, glm::vec3(-1), glm::vec3(1)) * (input.fast ? kFast : 1.0f);
  glm::vec2 want_turn = glm::clamp(input.turn, glm::vec2(-1), glm::vec2(1));
  if (input.drag == Drag::travel) {
    // A third of the window gives full speed. The first 2 % of that have no effect.
    const float unit = std::max(1.0f, std::min(input.viewport.x, input.viewport.y)) / 3;
    glm::vec2 pull = input.from_press / unit;
    pull *= std::max(0.0f, 1 - 0.02f / std::max(glm::length(pull), 1e-6f));
    pull = glm::clamp(pull, glm::vec2(-2), glm::vec2(2));
    want_move.z += -pull.y * (input.fast ? kFast : 1.0f);
    want_turn.x += pull.x;
  }
  const glm::vec3 move = ease(state.velocity, want_move, seconds) * seconds;
  const glm::vec2 turn = ease(state.turning, want_turn, seconds) * (seconds * kTurnRate);
  if (move == glm::vec3(0) && turn == glm::vec2(0)) return;
  Pose& pose = state.pose;
  switch (state.mode) {
    case NavigationMode::none:
      break;
    case NavigationMode::examine:
    case NavigationMode::look_at: {
      // In each mode, apply half of the turn before the move and half after it. The move then follows the chord of the
      // arc.
      rotate_about_center(state, turn.x / 2, turn.y / 2);
      const glm::vec3 away(pose.position - state.center);
      const float distance = std::max(glm::length(away), state.scene_size * 1e-3f);
      const float next = std::clamp(distance * std::exp(-move.z), state.scene_size * 1e-4f, state.scene_size * 1e3f);
      if (move.z != 0) {
        pose.position = state.center + glm::dvec3(unit_or(away, -pose.forward()) * next);
        scale_height(pose, double{next} / double{distance});
      }
      pose.position += glm::dvec3((pose.right() * move.x + pose.up() * move.y) * (std::sqrt(distance * next) * 0.5f));
      rotate_about_center(state, turn.x / 2, turn.y / 2);
      break;
    }
    case NavigationMode::pan: {
      const float distance = examined_distance(state, {});
      const float ahead = 1 - std::exp(-move.z * 0.5f);  // as a fraction of the distance
      pose.position += glm::dvec3(pose.forward() * (distance * ahead) +
                                  (pose.right() * (move.x + turn.x) + pose.up() * (move.y + turn.y)) *
                                      (distance * (1 - ahead / 2) * 0.5f));
      scale_height(pose, 1 - double{ahead});
      break;
    }
    case NavigationMode::fly:
      pose.orientation = turned(state, turn.x / 2, turn.y / 2);
      pose.position += glm::dvec3((pose.right() * move.x + pose.up() * move.y + pose.forward() * move.z) * state.speed);
      pose.orientation = turned(state, turn.x / 2, turn.y / 2);
      scale_height(pose, std::exp(-0.5 * double{move.z}));
      break;
    case NavigationMode::walk: {
      const float roll_left = std::exp(-seconds / kLevelTime);
      pose.orientation = turned_level(state, turn.x / 2, turn.y / 2, roll_left);
      const glm::vec3 ahead = level(state, pose.forward()), side = glm::cross(ahead, state.up);
      pose.position += glm::dvec3((side * move.x + state.up * move.y + ahead * move.z) * state.speed);
      pose.orientation = turned_level(state, turn.x / 2, turn.y / 2, 1);
      scale_height(pose, std::exp(-0.5 * double{move.z}));
      break;
    }
  }
}

void advance_transition(Navigation& state, float seconds) {
  Transition& way = *state.transition;
  way.elapsed += seconds;
  if (way.elapsed >= way.duration) {
    state.pose = way.to;
    state.transition.reset();
    return;
  }
  const float t = way.elapsed / way.duration;
  const float eased = t * t * (3 - 2 * t);
  state.pose.position = glm::mix(way.from.position, way.to.position, double{eased});
  state.pose.orientation = glm::slerp(way.from.orientation, way.to.orientation, eased);
  state.pose.field_of_view = glm::mix(way.from.field_of_view, way.to.field_of_view, eased);
  state.pose.height = glm::mix(way.from.height, way.to.height, double{eased});
}

NavigationInput clean(NavigationInput input) {
  input.viewport = glm::max(clean(input.viewport, 1e5f), glm::vec2(1));
  input.moved = clean(input.moved, 1e5f);
  input.from_press = clean(input.from_press, 1e5f);
  input.zoom = clean(input.zoom, 50);
  input.move = clean(input.move, 1);
  input.turn = clean(input.turn, 1);
  if (input.target && !finite(*input.target)) input.target.reset();
  return input;
}

}  // namespace

bool Navigation::moving() const {
  return transition || body.moving() || zoom_left != 0 || velocity != glm::vec3(0) || turning != glm::vec2(0);
}

Navigation start_navigation(const NavigationRules& rules, const WideBox& bounds, const Pose& pose) {
  Navigation state;
  state.mode = rules.start;
  state.pose = valid_pose(pose, Pose{});
  if (!bounds.empty()) {
    const glm::vec3 center = bounds.center();
    if (finite(center)) state.center = clean_place(center);
    const float size = glm::length(bounds.size());
    if (finite(size) && size > 0) state.scene_size = std::clamp(size, 1e-6f, static_cast<float>(kFarthest));
  } else {
    state.center = state.pose.position + glm::dvec3(state.pose.forward() * 10.0f);
  }
  state.speed = finite(rules.speed) ? std::clamp(rules.speed, 0.0f, static_cast<float>(kFarthest)) : 1.0f;
  return state;
}

Navigation step(const Navigation& state, const NavigationInput& raw, float seconds) {
  Navigation next = state;
  seconds = finite(seconds) ? std::clamp(seconds, 0.0f, kLongestStep) : 0.0f;
  if (state.mode == NavigationMode::none) {
    if (next.transition) advance_transition(next, seconds);
    next.pose = valid_pose(next.pose, state.pose);
    return next;
  }
  const NavigationInput input = clean(raw);
  if (input.any()) {
    if (next.transition && next.transition->jump) next.pose = next.transition->to;
    next.transition.reset();
  }
  if (next.transition) {
    advance_transition(next, seconds);
  } else {
    if (input.zoom != 0) {
      const float limit = 30;
      next.zoom_left = std::clamp(next.zoom_left + input.zoom, -limit, limit);
      next.zoom_target = input.target.value_or(next.pose.position +
                                               glm::dvec3(next.pose.forward() * examined_distance(next, std::nullopt)));
    }
    apply_drag(next, input);
    apply_zoom(next, seconds);
    apply_keys(next, input, seconds);
  }
  next.pose = valid_pose(next.pose, state.pose);
  return next;
}

Navigation with_body(const Navigation& before, Navigation after, const Avatar& avatar, const Obstacles& obstacles,
                     float seconds) {
  const bool has_body = (after.mode == NavigationMode::walk || after.mode == NavigationMode::fly) && !after.ghost;
  if (!has_body || before.transition || after.transition) {
    after.body = {};
    return after;
  }
  const glm::dvec3 way = after.pose.position - before.pose.position;
  if (way == glm::dvec3(0) && !before.body.moving()) return after;
  Avatar body = avatar;
  body.up = glm::dvec3(after.up);
  body.gravity = avatar.gravity && after.mode == NavigationMode::walk;
  Walk from = before.body;
  from.eye = before.pose.position + body.up * from.lag;
  after.body = walk(from, body, obstacles, way, static_cast<double>(seconds));
  after.pose.position = after.body.seen_from(body);
  after.pose = valid_pose(after.pose, before.pose);
  return after;
}

Navigation with_mode(Navigation state, NavigationMode mode) {
  state.mode = mode;
  state.body = {};
  state.velocity = glm::vec3(0);
  state.turning = glm::vec2(0);
  state.zoom_left = 0;
  return state;
}

Navigation travel_to(Navigation state, const Pose& pose, bool jump) {
  state = with_mode(std::move(state), state.mode);
  Pose to = valid_pose(pose, state.pose);
  // Keep the kind of projection that the viewer has now.
  if ((to.height > 0) != (state.pose.height > 0)) {
    const double ahead = glm::dot(state.center - to.position, glm::dvec3(to.forward()));
    const double distance = glm::length(state.center - to.position);
    to = with_parallel_rays(to, state.pose.height > 0, ahead > 0 ? ahead : distance);
  }
  state.transition = Transition{.from = state.pose, .to = to, .jump = jump};
  return state;
}

Navigation approach(Navigation state, const glm::dvec3& point, const WideBox& bounds, const glm::vec2& viewport) {
  if (!finite(point)) return state;
  constexpr double kNearer = 1.0 / 3;  // fraction of the distance that remains if the viewer is inside the bounds
  const glm::dvec3 position = state.pose.position;
  const bool outside = !bounds.empty() && finite(bounds.center()) && glm::length(bounds.size()) > 0 &&
                       (glm::any(glm::lessThan(position, glm::dvec3(bounds.lower))) ||
                        glm::any(glm::greaterThan(position, glm::dvec3(bounds.upper))));
  const glm::dvec3 target = clean_place(outside ? glm::dvec3(bounds.center()) : point);
  const glm::vec3 ahead = unit_or(glm::vec3(target - position), state.pose.forward());
  // Make the view level. If the direction is nearly vertical, keep the right direction, so that the picture does not
  // roll.
  const glm::vec3 side = glm::cross(ahead, state.up);
  const glm::vec3 right = unit_or(glm::length(side) > 1e-3f ? side : state.pose.right(), state.pose.right());
  Pose to = state.pose;
  to.orientation = glm::quat_cast(glm::mat3(right, glm::cross(right, ahead), -ahead));
  if (outside) {
    const Pose framing = pose_that_fits(to, bounds, viewport, state.up);
    const double distance = glm::length(framing.position - target);
    to.height = framing.height;
    to.position = target - glm::dvec3(ahead) * distance;
  } else {
    to.position = target + (position - target) * kNearer;
    scale_height(to, kNearer);
  }
  state.center = target;
  return travel_to(std::move(state), valid_pose(to, state.pose));
}

Navigation seek(Navigation state, const glm::dvec3& point) {
  if (!finite(point)) return state;
  state.center = clean_place(point);
  const glm::dvec3 way = state.center - state.pose.position;
  Pose to = state.pose;
  to.orientation =
      glm::normalize(rotation_between(to.forward(), unit_or(glm::vec3(way), to.forward())) * to.orientation);
  to.position += way / 2.0;
  scale_height(to, 0.5);
  return travel_to(std::move(state), to);
}

double looked_at_distance(const Navigation& state) { return double{examined_distance(state, std::nullopt)}; }

Navigation look_at_point(Navigation state, const glm::dvec3& point) {
  if (!finite(point)) return state;
  state.center = clean_place(point);
  const glm::dvec3 to_point = state.center - state.pose.position, forward(state.pose.forward());
  Pose to = state.pose;
  to.position += to_point - forward * glm::dot(to_point, forward);
  return travel_to(std::move(state), to);
}

glm::dvec3 target_of(const Navigation& state, const Ray& ray, std::optional<float> hit) {
  if (hit && finite(*hit) && *hit > 0) return ray.at(*hit);
  const float along = std::max(glm::dot(ray.direction, state.pose.forward()), 0.01f);
  const double behind = glm::dot(state.pose.position - ray.origin, glm::dvec3(state.pose.forward()));
  return ray.at((behind + looked_at_distance(state)) / double{along});
}

}  // namespace gs::app
