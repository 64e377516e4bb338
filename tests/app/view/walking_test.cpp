#include "app/view/walking.h"
#include "app/view/navigation.h"

#include <catch2/catch.hpp>
#include <glm/glm.hpp>

#include <cmath>
#include <random>
#include <vector>

namespace gs::app::walking_test {
namespace {

using glm::dvec3;
using render::WorldTriangle;

/// World of triangles that are all tested.
struct Site {
  std::vector<WorldTriangle> triangles;

  void triangle(const dvec3& a, const dvec3& b, const dvec3& c) { triangles.push_back({triangles.size(), {a, b, c}}); }
  void face(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  /// Adds a level floor.
  void floor(double y, double x0 = -50, double x1 = 50, double z0 = -50, double z1 = 50) {
    face({x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x1, y, z0});
  }
  void box(const dvec3& lower, const dvec3& upper) {
    floor(upper.y, lower.x, upper.x, lower.z, upper.z);
    floor(lower.y, lower.x, upper.x, lower.z, upper.z);
    const dvec3 a = lower, c = upper;
    face({a.x, a.y, a.z}, {a.x, c.y, a.z}, {c.x, c.y, a.z}, {c.x, a.y, a.z});
    face({a.x, a.y, c.z}, {a.x, c.y, c.z}, {c.x, c.y, c.z}, {c.x, a.y, c.z});
    face({a.x, a.y, a.z}, {a.x, a.y, c.z}, {a.x, c.y, c.z}, {a.x, c.y, a.z});
    face({c.x, a.y, a.z}, {c.x, a.y, c.z}, {c.x, c.y, c.z}, {c.x, c.y, a.z});
  }
  [[nodiscard]] Obstacles obstacles() const {
    Obstacles result;
    result.near = [this](const dvec3& lower, const dvec3& upper) {
      std::vector<WorldTriangle> found;
      for (const WorldTriangle& t : triangles) {
        bool touches = true;
        for (int i = 0; i < 3; ++i)
          touches = touches && std::min({t.corners[0][i], t.corners[1][i], t.corners[2][i]}) <= upper[i] &&
                    std::max({t.corners[0][i], t.corners[1][i], t.corners[2][i]}) >= lower[i];
        if (touches) found.push_back(t);
      }
      return found;
    };
    result.distance = [this](const dvec3& origin, const dvec3& direction) -> std::optional<double> {
      std::optional<double> nearest;
      for (const WorldTriangle& t : triangles) {
        const dvec3 normal = glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
        const double fall = glm::dot(direction, normal);
        if (fall == 0) continue;
        const double distance = glm::dot(t.corners[0] - origin, normal) / fall;
        const dvec3 at = origin + direction * distance;
        bool inside = distance > 0;
        for (int i = 0; i < 3; ++i)
          inside =
              inside && glm::dot(glm::cross(t.corners[(i + 1) % 3] - t.corners[i], at - t.corners[i]), normal) >= 0;
        if (inside && !(nearest && *nearest <= distance)) nearest = distance;
      }
      return nearest;
    };
    return result;
  }
};

const Avatar kBody;  // 0.25, 1.6, 0.75: the standard's defaults

/// Walks for some time at a steady speed.
Walk go(const Site& site, Walk body, const dvec3& velocity, double seconds, double rate = 60,
        const Avatar& avatar = kBody) {
  const Obstacles obstacles = site.obstacles();
  const int steps = static_cast<int>(std::lround(seconds * rate));
  for (int i = 0; i < steps; ++i) body = walk(body, avatar, obstacles, velocity / rate, 1 / rate);
  return body;
}
Walk at(const dvec3& eye) {
  Walk body;
  body.eye = eye;
  return body;
}

}  // namespace

TEST_CASE("keeps a walking viewer avatarSize[1] above the ground (4.13.4, 6.29)") {
  Site site;
  site.floor(2);
  Walk body = go(site, at({0, 3.6, 0}), {1, 0, 0}, 1);
  CHECK(body.on_ground);
  CHECK(body.eye.x == Approx(1));
  CHECK(body.eye.y == Approx(3.6));
  // The viewer walks up and down a slope of 30 degrees.
  Site hill;
  hill.floor(0, -50, 5);
  const double rise = std::tan(0.5235988);
  hill.face({5, 0, -50}, {5, 0, 50}, {15, 10 * rise, 50}, {15, 10 * rise, -50});
  hill.face({15, 10 * rise, -50}, {15, 10 * rise, 50}, {25, 0, 50}, {25, 0, -50});
  body = go(hill, at({4, 1.6, 0}), {2, 0, 0}, 3);
  CHECK(body.eye.x == Approx(10).margin(0.01));
  CHECK(body.eye.y == Approx(1.6 + 5 * rise).margin(0.1));  // the ground below the whole width of the body
  body = go(hill, body, {2, 0, 0}, 5);
  CHECK(body.eye.y == Approx(1.6 + 5 * rise).margin(0.1));
  CHECK(body.on_ground);
}

TEST_CASE("steps over avatarSize[2] and no higher") {
  for (const double height : {0.3, 0.7, 0.8, 1.2}) {
    Site site;
    site.floor(0);
    site.box({3, 0, -10}, {30, height, 10});
    const Walk body = go(site, at({0, 1.6, 0}), {2, 0, 0}, 4);
    INFO("a block " << height << " high");
    if (height < 0.75) {
      CHECK(body.eye.x == Approx(8));
      CHECK(body.eye.y == Approx(1.6 + height));
    } else {
      CHECK(body.eye.x < 2.9);  // the lower end of the body is round
      CHECK(body.eye.x > 2.7);
      CHECK(body.eye.y == Approx(1.6));
    }
  }
}

TEST_CASE("keeps avatarSize[0] from walls, and slides along them") {
  Site site;
  site.floor(0);
  site.face({-50, 0, -3}, {50, 0, -3}, {50, 4, -3}, {-50, 4, -3});
  Walk body = go(site, at({0, 1.6, 0}), {0, 0, -1.5}, 4);
  CHECK(body.eye.z == Approx(-2.75).margin(0.005));
  CHECK(body.item);
  // Half of the movement is along the wall.
  body = go(site, body, {1, 0, -1}, 3);
  CHECK(body.eye.x == Approx(3).margin(0.02));
  CHECK(body.eye.z == Approx(-2.75).margin(0.005));
  // The viewer walks into the corner of two walls, and out again.
  site.face({5, 0, -50}, {5, 0, 50}, {5, 4, 50}, {5, 4, -50});
  body = go(site, body, {1, 0, -1}, 6);
  CHECK(body.eye.x == Approx(4.75).margin(0.01));
  CHECK(body.eye.z == Approx(-2.75).margin(0.01));
  body = go(site, body, {-1, 0, 1}, 1);
  CHECK(body.eye.x == Approx(3.75).margin(0.02));
}

TEST_CASE("walks equally at 10 and at 200 frames per second") {
  Site site;
  site.floor(0);
  site.box({3, 0, -10}, {6, 0.6, 10});                              // a step
  site.face({12, 0, -50}, {14, 0, 50}, {14, 4, 50}, {12, 4, -50});  // a slanted wall
  site.floor(-4, 20, 60);
  Walk slow = go(site, at({0, 1.6, 0}), {2.5, 0, 0.4}, 8, 10), fast = go(site, at({0, 1.6, 0}), {2.5, 0, 0.4}, 8, 200);
  CHECK(glm::distance(slow.eye, fast.eye) < 0.05);
  // The viewer falls from 30 m.
  slow = go(site, at({-20, 31.6, 0}), dvec3(0), 1.5, 10);
  fast = go(site, at({-20, 31.6, 0}), dvec3(0), 1.5, 200);
  CHECK(slow.eye.y == Approx(31.6 - 9.81 / 2 * 1.5 * 1.5));
  CHECK(fast.eye.y == Approx(slow.eye.y));
  CHECK(go(site, slow, dvec3(0), 3, 10).eye.y == Approx(1.6));
  CHECK(go(site, fast, dvec3(0), 3, 200).eye.y == Approx(1.6));
}

TEST_CASE("falls off an edge to the ground below, but not where there is none") {
  Site site;
  site.floor(0, -10, 2);
  Walk body = go(site, at({0, 1.6, 0}), {2, 0, 0}, 4);
  CHECK(body.eye.x == Approx(8));
  CHECK(body.eye.y == Approx(1.6));  // no ground below
  CHECK(body.falling == 0);
  site.floor(-20, 0, 50);
  body = go(site, at({0, 1.6, 0}), {2, 0, 0}, 1.5);
  CHECK(body.eye.y < 1.6);
  CHECK(body.falling > 0);
  body = go(site, body, dvec3(0), 4);
  CHECK(body.on_ground);
  CHECK(body.eye.y == Approx(-18.4));
}

TEST_CASE("frees a viewer that starts too low or in a wall, and blocks passage at any speed") {
  Site site;
  site.floor(0);
  CHECK(go(site, at({0, 0.4, 0}), {1, 0, 0}, 0.5).eye.y == Approx(1.6));  // a Viewpoint below the avatar's height
  site.face({-50, 0, -3}, {50, 0, -3}, {50, 4, -3}, {-50, 4, -3});
  const Walk inside = at({0, 1.6, -2.95});  // nearer than the body's width
  CHECK(go(site, inside, {0, 0, 1}, 1).eye.z == Approx(-1.95));
  CHECK(go(site, inside, {1, 0, 0}, 1).eye.x == Approx(1));
  CHECK(go(site, inside, {0, 0, -1}, 1).eye.z > -3);
  for (const double speed : {1.0, 30.0, 300.0})
    for (const double rate : {5.0, 30.0}) {
      INFO(speed << " m/s at " << rate << " frames a second");
      CHECK(go(site, at({0, 1.6, 0}), {0, 0, -speed}, 4, rate).eye.z == Approx(-2.75).margin(0.01));
    }
}

TEST_CASE("flies up and down, and through nothing") {
  Avatar body = kBody;
  body.gravity = false;
  Site site;
  site.box({-2, -2, -2}, {2, 2, 2});
  CHECK(go(site, at({0, 0, 0}), {0, 3, 0}, 2, 60, body).eye.y == Approx(1.75).margin(0.005));
  CHECK(go(site, at({0, 0, 0}), {0, -3, 1}, 2, 60, body).eye.y == Approx(-1.75).margin(0.005));
  CHECK(go(site, at({0, 9, 0}), dvec3(0), 2, 60, body).eye.y == 9);  // no gravity
}

TEST_CASE("shows a step as a rise, not as a jump") {
  Site site;
  site.floor(0);
  site.box({1, 0, -10}, {30, 0.5, 10});
  Walk body = at({0, 1.6, 0});
  double before = 1.6, most = 0;
  const Obstacles obstacles = site.obstacles();
  for (int i = 0; i < 120; ++i) {
    body = walk(body, kBody, obstacles, {1.0 / 60, 0, 0}, 1.0 / 60);
    const double seen = body.seen_from(kBody).y;
    most = std::max(most, seen - before);
    before = seen;
  }
  CHECK(most < 0.15);
  CHECK(before == Approx(2.1).margin(0.01));
}

TEST_CASE("survives invalid avatar sizes, and keeps the viewer in a room") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  Site room;
  room.box({-4, 0, -4}, {4, 3, 4});
  for (int i = 0; i < 12; ++i) {  // clutter
    const dvec3 a(3 * number(random), 1.5 + number(random), 3 * number(random));
    room.triangle(a, a + dvec3(number(random), number(random), number(random)),
                  a + dvec3(number(random), number(random), number(random)));
  }
  Walk body = at({0, 1.6, 0});
  const Obstacles obstacles = room.obstacles();
  for (int i = 0; i < 3000; ++i) {
    const double speed = 0.4 * std::abs(number(random));
    body = walk(body, kBody, obstacles, dvec3(number(random), number(random), number(random)) * speed, 0.02);
    const bool stays = std::abs(body.eye.x) < 4 && std::abs(body.eye.z) < 4 && body.eye.y > 0 && body.eye.y < 3;
    INFO("step " << i << ": " << body.eye.x << " " << body.eye.y << " " << body.eye.z);
    REQUIRE(stays);
  }
  for (const double bad : {HUGE_VAL, -HUGE_VAL, std::nan(""), 1e300}) {
    Walk next = walk(at({bad, 0, 0}), kBody, obstacles, {1, 0, 0}, 0.1);
    next = walk(at({0, 1.6, 0}), kBody, obstacles, {bad, 0, bad}, 0.1);
    CHECK(std::isfinite(next.eye.x + next.eye.y + next.eye.z));
    next = walk(at({0, 1.6, 0}), kBody, obstacles, {1, 0, 0}, bad);
    CHECK(std::isfinite(next.eye.x + next.eye.y + next.eye.z));
    Avatar odd = kBody;
    odd.radius = odd.height = bad;
    (void)walk(at({0, 1.6, 0}), odd, obstacles, {1, 0, 0}, 0.1);
  }
}

TEST_CASE("applies no gravity before the first movement, during transitions, in EXAMINE or without collision") {
  Site site;
  site.floor(0);
  const Obstacles obstacles = site.obstacles();
  Pose pose;
  pose.position = {0, 30, 0};
  Navigation still = start_navigation({NavigationMode::walk, {true, true, true, true, true}, true, 1, {}}, {}, pose);
  NavigationInput keys;
  const auto after = [&](Navigation state, int steps) {
    for (int i = 0; i < steps; ++i) state = with_body(state, step(state, keys, 0.02f), kBody, obstacles, 0.02f);
    return state;
  };
  CHECK(after(still, 50).pose.position.y == 30);
  keys.move = {0, 0, 1};
  CHECK(after(still, 50).pose.position.y < 28);
  Navigation other = with_mode(still, NavigationMode::examine);
  other.center = {0, 30, -5};
  CHECK(after(other, 50).pose.position.y == Approx(30));
  other = still;
  other.ghost = true;
  CHECK(after(other, 50).pose.position.y == 30);
  CHECK(after(with_mode(still, NavigationMode::fly), 50).pose.position.y == Approx(30));
  keys.move = glm::vec3(0);
  Pose there = pose;
  there.position.x = 5;
  CHECK(after(travel_to(still, there), 10).pose.position.y == 30);
}

TEST_CASE("takes down from the bound Viewpoint's coordinates (6.29)") {
  Site site;  // a wall along x = 0 as ground, with +X up
  site.face({0, -50, -50}, {0, 50, -50}, {0, 50, 50}, {0, -50, 50});
  Pose pose;
  pose.position = {5, 0, 0};
  pose.orientation = glm::angleAxis(-1.5707963f, glm::vec3(0, 0, 1));  // the top of the view is +X
  Navigation state = start_navigation({NavigationMode::walk, {true, true, true, true, true}, true, 1, {}}, {}, pose);
  state.up = {1, 0, 0};
  NavigationInput keys;
  keys.move = {0, 0, 1};
  const Obstacles obstacles = site.obstacles();
  for (int i = 0; i < 200; ++i) state = with_body(state, step(state, keys, 0.02f), kBody, obstacles, 0.02f);
  CHECK(state.pose.position.x == Approx(1.6));
  CHECK(state.pose.position.z < -3);
  CHECK(glm::dot(state.pose.up(), glm::vec3(1, 0, 0)) == Approx(1));
}

}  // namespace gs::app::walking_test
