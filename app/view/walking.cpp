#include "app/view/walking.h"

#include "base/finite.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gs::app {
namespace {

using glm::dvec3;
using render::WorldTriangle;

constexpr double kGravity = 9.81 / 1.6;    // eye heights/s^2; eye heights are used because worlds have different units
constexpr double kLongestFreeLine = 1e12;  // metres; longer ways are cut
constexpr double kTerminal = 40;           // eye heights/s; max speed of falling
constexpr double kLagTime = 0.08;          // seconds; time constant with which the view follows a step (63 %)
constexpr double kMinLag = 1e-4;           // eye heights; a smaller lag is removed at once
constexpr double kTolerance = 1e-3;        // radii; allowed penetration
constexpr double kSteepestGround = 0.5;    // min cosine of the slope on which the viewer can stand
constexpr int kRounds = 8;                 // max iterations to leave obstacles
constexpr double kLongestWalk = 0.25;      // seconds; longer times are shortened to this

/// Returns the point closest to `p` on the segment from `a` to `b`.
dvec3 nearest_on_line(const dvec3& a, const dvec3& b, const dvec3& p) {
  const dvec3 ab = b - a;
  const double square = glm::dot(ab, ab);
  return square > 0 ? a + ab * std::clamp(glm::dot(p - a, ab) / square, 0.0, 1.0) : a;
}

/// Returns the point of a triangle that is closest to `p` (Ericson, Real-Time Collision Detection, 5.1.5: distinguishes
/// the regions of corners and edges).
dvec3 nearest_on_triangle(const std::array<dvec3, 3>& t, const dvec3& p) {
  const dvec3 ab = t[1] - t[0], ac = t[2] - t[0], normal = glm::cross(ab, ac);
  const double square = glm::dot(normal, normal);
  if (square > 0) {
    const dvec3 foot = p - normal * (glm::dot(p - t[0], normal) / square);
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const dvec3 edge = t[(i + 1) % 3] - t[i];
      inside = inside && glm::dot(glm::cross(edge, foot - t[i]), normal) >= 0;
    }
    if (inside) return foot;
  }
  dvec3 best = t[0];
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3 q = nearest_on_line(t[i], t[(i + 1) % 3], p);
    if (const double distance = glm::dot(p - q, p - q); distance < least) {
      least = distance;
      best = q;
    }
  }
  return best;
}

struct Pair {
  dvec3 on_line, on_triangle;
};

/// Returns the points at which the segments from `a` to `b` and from `c` to `d` are closest to each other.
Pair nearest_of_lines(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
  const dvec3 u = b - a, v = d - c, w = a - c;
  const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v), uw = glm::dot(u, w), vw = glm::dot(v, w);
  const double determinant = uu * vv - uv * uv;
  double s = determinant > 1e-12 * uu * vv ? std::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0) : 0.5;
  const dvec3 q = nearest_on_line(c, d, a + u * s);
  const dvec3 p = nearest_on_line(a, b, q);
  return {p, nearest_on_line(c, d, p)};
}

/// Returns the points at which a vertical segment and a triangle are closest to each other.
Pair nearest_pair(const dvec3& low, const dvec3& high, const std::array<dvec3, 3>& t) {
  Pair best{low, nearest_on_triangle(t, low)};
  double least = glm::distance(best.on_line, best.on_triangle);
  const auto consider = [&](const Pair& pair) {
    if (const double distance = glm::distance(pair.on_line, pair.on_triangle); distance < least) {
      least = distance;
      best = pair;
    }
  };
  if (low == high) return best;
  consider({high, nearest_on_triangle(t, high)});
  for (std::size_t i = 0; i < 3; ++i) consider(nearest_of_lines(low, high, t[i], t[(i + 1) % 3]));
  // Also consider the point at which the segment crosses the plane of the triangle.
  const dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double below = glm::dot(low - t[0], normal), above = glm::dot(high - t[0], normal);
  if (below * above < 0) {
    const dvec3 through = low + (high - low) * (below / (below - above));
    consider({through, nearest_on_triangle(t, through)});
  }
  return best;
}

/// Capsule of the viewer, with the triangles near its path.
class Body {
 public:
  Body(const Avatar& avatar, std::vector<WorldTriangle> triangles, const dvec3& start)
      : avatar_(avatar), triangles_(std::move(triangles)) {
    // If the body penetrates a triangle at the start, it may stay there but not go deeper.
    room_.reserve(triangles_.size());
    for (const WorldTriangle& triangle : triangles_) {
      const Pair pair = nearest_pair(low(start), start, triangle.corners);
      room_.push_back(std::min(avatar_.radius, glm::distance(pair.on_line, pair.on_triangle)));
    }
  }

  /// Returns the lower end of the capsule's axis when the eye is at `eye`.
  [[nodiscard]] dvec3 low(const dvec3& eye) const {
    if (!avatar_.gravity) return eye;
    return eye - avatar_.up * std::max(0.0, avatar_.height - avatar_.step - avatar_.radius);
  }

  /// Moves the body by a short way from an eye position without collisions. Slides along obstacles. Returns the new eye
  /// position, and sets `item` to the last item touched.
  dvec3 slide(const dvec3& eye, const dvec3& way, std::optional<std::size_t>& item) const {
    dvec3 at = eye + way;
    for (int round = 0; round < kRounds; ++round) {
      double deepest = kTolerance * avatar_.radius;
      dvec3 push(0);
      for (std::size_t i = 0; i < triangles_.size(); ++i) {
        const Pair pair = nearest_pair(low(at), at, triangles_[i].corners);
        const dvec3 away = pair.on_line - pair.on_triangle;
        const double distance = glm::length(away), depth = room_[i] - distance;
        if (!(depth > deepest)) continue;
        deepest = depth;
        item = triangles_[i].item;
        if (distance > 1e-9 * avatar_.radius) {
          push = away * (depth / distance);
        } else {
          // The axis intersects the triangle. Push the body back to the side from which it came.
          const dvec3 normal = glm::cross(triangles_[i].corners[1] - triangles_[i].corners[0],
                                          triangles_[i].corners[2] - triangles_[i].corners[0]);
          const double length = glm::length(normal);
          const double side = glm::dot(eye - triangles_[i].corners[0], normal) < 0 ? -1 : 1;
          push = length > 0 ? normal * (side * depth / length) : -way;
        }
      }
      if (push == dvec3(0)) return at;
      if (avatar_.gravity) {
        // Push only sideways, so that a wall neither lifts the viewer nor presses the viewer into the ground.
        const dvec3 sideways = push - avatar_.up * glm::dot(push, avatar_.up);
        const double part = glm::length(sideways), all = glm::length(push);
        if (part < 0.1 * all) return eye;  // stop at a low ceiling, or at a step that is too high
        push = sideways * std::min(all * all / (part * part), 4.0);
      }
      at += push;
    }
    return eye;  // no free position found; stay
  }

  /// Returns the depth of the highest ground below the eye. Considers only depths from `highest` to `deepest`.
  [[nodiscard]] std::optional<double> ground(const dvec3& eye, double highest, double deepest) const {
    const dvec3 up = avatar_.up, side = std::abs(up.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 0, 1);
    const dvec3 across = glm::normalize(glm::cross(up, side)) * (avatar_.radius * 0.5), along = glm::cross(up, across);
    std::optional<double> best;
    for (const dvec3& offset : {dvec3(0), across, -across, along, -along})
      for (const WorldTriangle& triangle : triangles_) {
        const auto depth = below(eye + offset, triangle.corners);
        if (depth && *depth >= highest && *depth <= deepest && !(best && *best <= *depth)) best = depth;
      }
    return best;
  }

 private:
  /// Returns the depth of a triangle below a point. Returns nullopt if the triangle is not below it, or too steep to
  /// stand on.
  [[nodiscard]] std::optional<double> below(const dvec3& p, const std::array<dvec3, 3>& t) const {
    const dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double rise = glm::dot(normal, avatar_.up);
    if (!(std::abs(rise) >= kSteepestGround * glm::length(normal)) || rise == 0) return std::nullopt;
    const double depth = glm::dot(p - t[0], normal) / rise;
    const dvec3 foot = p - avatar_.up * depth;
    for (std::size_t i = 0; i < 3; ++i)
      if (glm::dot(glm::cross(t[(i + 1) % 3] - t[i], foot - t[i]), normal) < -1e-9 * glm::dot(normal, normal))
        return std::nullopt;
    return depth;
  }

  const Avatar& avatar_;
  std::vector<WorldTriangle> triangles_;
  std::vector<double> room_;  // min distance to keep from each triangle
};

}  // namespace

Walk walk(const Walk& from, const Avatar& avatar, const Obstacles& obstacles, const dvec3& way, double seconds) {
  Walk next = from;
  next.item.reset();
  if (!finite(from.eye) || !finite(way) || !(seconds >= 0) || !(avatar.radius > 0)) return next;
  seconds = std::min(seconds, kLongestWalk);
  const dvec3 flat = avatar.gravity ? way - avatar.up * glm::dot(way, avatar.up) : way;
  const double piece = avatar.radius * 0.5, length = glm::length(flat);
  // Skips the first part of a way that has too many pieces, as above a globe, if nothing stands on the whole line.
  if (const double most = piece * kMaxPieces * 0.99; length > most && length < kLongestFreeLine) {
    const dvec3 ahead = flat / length;
    const auto hit = obstacles.distance(from.eye, ahead);
    if (!hit || *hit > length + avatar.radius) {
      Walk near_end = from;
      near_end.eye += ahead * (length - most);
      return walk(near_end, avatar, obstacles, way - ahead * (length - most), seconds);
    }
  }
  const int pieces =
      std::clamp(static_cast<int>(std::ceil(std::min(length / piece, 1e6))), length > 0 ? 1 : 0, kMaxPieces);
  const double gone = std::min(length, pieces * piece);
  const dvec3 step = pieces > 0 ? flat * (gone / length / pieces) : dvec3(0);

  // Use the mean speed of the step, so that falling does not depend on the step length.
  const double gravity = kGravity * avatar.height, fastest = kTerminal * avatar.height;
  const double speed = std::min(from.falling + gravity * seconds, fastest);
  const double fall = avatar.gravity ? (from.falling + speed) / 2 * seconds : 0;

  const double reach = avatar.radius + gone + avatar.step + 2 * kTolerance * avatar.radius;
  const double down = avatar.height + avatar.step + fall + gone;
  dvec3 lower = from.eye - dvec3(reach), upper = from.eye + dvec3(reach);
  if (avatar.gravity) {
    lower = glm::min(lower, from.eye - avatar.up * down - dvec3(reach));
    upper = glm::max(upper, from.eye - avatar.up * down + dvec3(reach));
  }
  const Body body(avatar, obstacles.near(lower, upper), from.eye);
  // On the ground, follow steps upwards and downwards. Otherwise fall, or rise if the body began below the ground.
  double left = fall;
  const auto settle = [&](double most) {
    const bool stood = next.on_ground;
    const auto depth =
        body.ground(next.eye, stood ? avatar.height - avatar.step : 0, avatar.height + (stood ? avatar.step : most));
    next.on_ground = depth.has_value();
    if (depth) {
      const double rise = avatar.height - *depth;
      next.eye += avatar.up * rise;
      if (stood || rise > 0) next.lag += rise;  // smooth the view at steps, not at the end of a fall
      next.falling = 0;
      left = 0;
    }
  };
  for (int i = 0; i < pieces; ++i) {
    const dvec3 slid = body.slide(next.eye, step, next.item);
    next.eye = slid;
    if (avatar.gravity) settle(0);
  }
  if (avatar.gravity) {
    if (pieces == 0) settle(0);
    if (!next.on_ground) {
      settle(left);
      if (!next.on_ground) {
        // If there is no ground anywhere below, do not fall.
        if (obstacles.distance(next.eye, -avatar.up)) {
          next.eye -= avatar.up * left;
          next.falling = speed;
        } else {
          next.falling = 0;
        }
      }
    }
  } else {
    next.falling = 0;
    next.on_ground = false;
  }
  next.lag *= std::exp(-seconds / kLagTime);
  if (std::abs(next.lag) < kMinLag * avatar.height) next.lag = 0;
  return next;
}

}  // namespace gs::app
