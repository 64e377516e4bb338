#include "render/scene/camera.h"

#include <catch2/catch.hpp>
#include <glm/glm.hpp>

#include <cmath>

using namespace gs;
using namespace gs::render;

namespace {

Box box(const glm::vec3& lower, const glm::vec3& upper) {
  Box bounds;
  bounds.add(lower);
  bounds.add(upper);
  return bounds;
}

glm::vec3 corner(const Box& b, int i) {
  return {i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z};
}

glm::dvec4 clip(const Camera& camera, float width, float height, const glm::vec3& point) {
  const glm::dmat3 rotation(glm::mat3(camera.world_from_camera));
  const glm::dvec3 in_camera = glm::transpose(rotation) * (glm::dvec3(point) - glm::dvec3(camera.world_from_camera[3]));
  return glm::dmat4(projection(camera, width, height).clip_from_camera) * glm::dvec4(in_camera, 1);
}

}  // namespace

TEST_CASE("uses fieldOfView for the smaller of the two angles (VRML97 6.53)") {
  Camera camera;
  camera.near_plane = 1;
  camera.far_plane = 100;
  camera.field_of_view = 1.0f;
  const float edge = 10 * std::tan(0.5f);
  const auto check = [&](float width, float height, const glm::vec3& at_edge, int axis) {
    const glm::dvec4 c = clip(camera, width, height, at_edge);
    CHECK(c[axis] / c.w == Approx(1).epsilon(1e-5));
  };
  check(200, 100, {0, edge, -10}, 1);
  check(200, 100, {2 * edge, 0, -10}, 0);
  check(100, 300, {edge, 0, -10}, 0);
  check(100, 300, {0, 3 * edge, -10}, 1);
  const glm::dvec4 at_near = clip(camera, 1, 1, {0, 0, -1}), at_far = clip(camera, 1, 1, {0, 0, -100});
  CHECK(at_near.z / at_near.w == Approx(-1));
  CHECK(at_far.z / at_far.w == Approx(1));
}

TEST_CASE("keeps all corners in view of an orbit camera from every direction") {
  const Box boxes[] = {box({-1, -2, -3}, {4, 5, 6}), box({0, 0, 0}, {100, 0.1f, 3}), box({5, 5, 5}, {5, 5, 5}),
                       box({1e6f, 2e6f, 0}, {1e6f + 64, 2e6f + 64, 32}), box({-1e-4f, 0, 0}, {1e-4f, 2e-4f, 1e-4f})};
  for (const Box& bounds : boxes)
    for (float azimuth = -3.0f; azimuth < 6.5f; azimuth += 0.7f)
      for (float elevation : {-1.5707963f, -1.0f, -0.2f, 0.0f, 0.6f, 1.5707963f})
        for (const auto& [width, height] : {std::pair{640.0f, 480.0f}, {100.0f, 700.0f}}) {
          const Camera camera = fit_depth(orbit_camera(bounds, azimuth, elevation, 0.785398f, width, height), bounds);
          REQUIRE(camera.near_plane > 0);
          REQUIRE(camera.far_plane > camera.near_plane);
          double largest = 0;
          for (int i = 0; i < 8; ++i) {
            const glm::dvec4 c = clip(camera, width, height, corner(bounds, i));
            REQUIRE(c.w > 0);
            REQUIRE(std::abs(c.x) <= c.w);
            REQUIRE(std::abs(c.y) <= c.w);
            REQUIRE(std::abs(c.z) <= c.w);
            largest = std::max({largest, std::abs(c.x / c.w), std::abs(c.y / c.w)});
          }
          if (bounds.size() != glm::vec3(0)) CHECK(largest > 0.85);  // the object fills the picture
          REQUIRE(has_in_view(camera, bounds, width, height));
        }
}

TEST_CASE("reports points beyond a side or behind the camera as out of view") {
  Camera camera;  // looks along -Z
  camera.field_of_view = 1.5707963f;
  const auto sees = [&](const glm::vec3& lower, const glm::vec3& upper) {
    return has_in_view(camera, box(lower, upper), 200, 100);
  };
  // At a distance of 10 the view is 40 metres wide and 20 high.
  CHECK(sees({-19.9f, -9.9f, -12}, {19.9f, 9.9f, -10}));
  CHECK_FALSE(sees({-20.1f, -1, -10}, {1, 1, -10}));
  CHECK_FALSE(sees({-1, -1, -10}, {20.1f, 1, -10}));
  CHECK_FALSE(sees({-1, -10.1f, -10}, {1, 1, -10}));
  CHECK_FALSE(sees({-1, -1, -10}, {1, 10.1f, -10}));
  CHECK_FALSE(sees({0, 0, 1}, {0, 0, 2}));
  CHECK_FALSE(sees({-1, -1, -10}, {1, 1, 1}));
  CHECK(has_in_view(camera, {}, 200, 100));
}

TEST_CASE("looks from +Z at azimuth 0 and elevation 0, and turns towards +X and up") {
  const Box bounds = box({-1, -1, -1}, {1, 1, 1});
  const glm::vec3 front(orbit_camera(bounds, 0, 0, 0.8f, 1, 1).world_from_camera[3]);
  CHECK(front.x == Approx(0).margin(1e-5));
  CHECK(front.y == Approx(0).margin(1e-5));
  CHECK(front.z > 1);
  const glm::vec3 side(orbit_camera(bounds, 1.5707963f, 0, 0.8f, 1, 1).world_from_camera[3]);
  CHECK(side.x > 1);
  CHECK(side.z == Approx(0).margin(1e-4));
  const glm::vec3 above(orbit_camera(bounds, 0, 1.5707963f, 0.8f, 1, 1).world_from_camera[3]);
  CHECK(above.y > 1);
}

TEST_CASE("avoids an initial view of flat objects edge on") {
  const auto back = [](const glm::vec3& size) {
    return glm::vec3(first_camera(box(-size / 2.0f, size / 2.0f), 0.8f, 4, 3).world_from_camera[2]);
  };
  for (const glm::vec3& size :
       {glm::vec3(1, 1, 1), glm::vec3(3, 1, 2), glm::vec3(9, 9, 0.1f), glm::vec3(9, 0.1f, 0.1f)})
    CHECK(back(size) == glm::vec3(0, 0, 1));
  CHECK(back({9, 1, 9}).y > 0.5f);  // horizontal: seen from above
  CHECK(back({9, 1, 9}).x == 0);
  CHECK(back({1, 9, 9}).x > 0.5f);  // upright: seen from the side
  CHECK(back({1, 9, 9}).y == 0);
}

TEST_CASE("places the camera of an empty world at the default Viewpoint") {
  const Camera camera = fit_depth(orbit_camera({}, 0, 0, 0.785398f, 4, 3), {});
  CHECK(camera.world_from_camera[3].z == Approx(10));
  CHECK(camera.near_plane > 0);
  CHECK(camera.far_plane > 10);
}

TEST_CASE("encloses the bounds by depth planes with a small ratio") {
  Camera camera;
  camera.world_from_camera[3] = {0, 0, 10, 1};
  const Camera outside = fit_depth(camera, box({-1, -1, -1}, {1, 1, 1}));
  CHECK(outside.near_plane <= 9);
  CHECK(outside.near_plane > 8.5f);
  CHECK(outside.far_plane >= 11);
  CHECK(outside.far_plane < 11.5f);
  const Camera inside = fit_depth(camera, box({-500, -500, -500}, {500, 500, 500}));
  CHECK(inside.near_plane <= 0.11f);
  CHECK(inside.near_plane >= inside.far_plane / 11000);
  camera.far_plane = 50;  // a visibilityLimit
  const Camera limited = fit_depth(camera, box({-500, -500, -500}, {500, 500, 500}));
  CHECK(limited.far_plane == 50);
  CHECK(limited.near_plane == Approx(50 / 1e4f));
  camera.far_plane = 0;
  const Camera behind = fit_depth(camera, box({-1, -1, 20}, {1, 1, 21}));
  CHECK(behind.near_plane > 0);
  CHECK(behind.far_plane > behind.near_plane);
}

TEST_CASE("maps reversed depth from 1 to 0 by inverse distance, with any near plane") {
  Camera camera;
  camera.near_plane = 0.5f;
  camera.far_plane = 1e7f;
  for (const bool reversed : {false, true}) {
    const Projection lens = projection(camera, 300, 200, reversed);
    CHECK(lens.window_depth(camera.near_plane) == Approx(lens.nearest_depth()).margin(1e-6));
    CHECK(lens.window_depth(camera.far_plane) == Approx(lens.farthest_depth()).margin(1e-6));
    // Computes the depth as the rasteriser does from clip space. OpenGL's default depths are -1 to 1.
    for (const double distance : {0.5, 0.7, 3.0, 900.0, 5e6}) {
      const glm::dvec4 c = glm::dmat4(lens.clip_from_camera) * glm::dvec4(0, 0, -distance, 1);
      const double depth = reversed ? c.z / c.w : c.z / c.w * 0.5 + 0.5;
      CHECK(lens.window_depth(static_cast<float>(distance)) == Approx(depth).margin(1e-6));
    }
  }
  // Floats distinguish a millionth of the distance everywhere.
  const Projection lens = projection(camera, 1, 1, true);
  for (float distance = 1; distance < 9e6f; distance *= 1.7f)
    CHECK(lens.window_depth(distance) > lens.window_depth(distance * 1.000001f));
  const Camera near = fit_depth(Camera{}, box({-1e7f, -1e7f, -1e7f}, {1e7f, 1e7f, 1e7f}), true);
  CHECK(near.near_plane < 0.01f);
  CHECK(near.far_plane >= 1e7f);
}

TEST_CASE("returns a usable projection for invalid fields of view and sizes") {
  for (float angle : {0.0f, -1.0f, 4.0f, std::nanf(""), HUGE_VALF}) {
    Camera camera;
    camera.near_plane = 1;
    camera.far_plane = 2;
    camera.field_of_view = angle;
    const glm::mat4 matrix = projection(camera, 0, -5).clip_from_camera;
    for (int i = 0; i < 16; ++i) CHECK(std::isfinite((&matrix[0][0])[i]));
    CHECK(matrix[0][0] > 0);
  }
}
