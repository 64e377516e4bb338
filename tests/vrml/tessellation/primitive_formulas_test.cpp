// Compares Boxes, Cones, Cylinders and Spheres of random sizes with the formulas of their clauses.
#include "tests/vrml/mesh_formulas.h"
#include "tests/watched.h"

#include <algorithm>

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Returns s at (x, z), which runs counter-clockwise from the back, seen from above (VRML97 6.11, 6.14, 6.43).
double s_around(double x, double z) { return (std::atan2(x, z) + std::numbers::pi) / kTurn; }

/// Compares s with the formula. At the seam it may be 0 or 1.
bool same_s(double s, double formula) {
  const double difference = std::abs(s - formula);
  return difference < 1e-5 || std::abs(difference - 1) < 1e-5;
}

bool near_all(const glm::dvec3& a, const glm::dvec3& b, double tolerance) { return glm::length(a - b) <= tolerance; }

/// Reports whether a corner fits a flat, round cap at `y`, with the texture cut out of its square (6.11, 6.14).
bool is_cap_corner(const FormulaCorner& corner, double y, double radius, bool up) {
  const glm::dvec3 p = corner.position;
  const double sign = up ? 1 : -1;
  const glm::dvec2 texture(0.5 + p.x / (2 * radius), 0.5 - sign * p.z / (2 * radius));
  const double ring = std::hypot(p.x, p.z);
  return std::abs(p.y - y) < 1e-6 * std::abs(y) && (ring < 1e-6 * radius || std::abs(ring - radius) < 1e-5 * radius) &&
         glm::length(corner.texture_coordinate - texture) < 1e-5 && corner.normal == glm::dvec3(0, sign, 0);
}

/// Counts corners that fit neither `side` nor a cap, and triangles that face inwards or span more texture than a
/// segment.
template <class Side>
std::size_t faults(const Mesh& mesh, double half, double radius, int segments, const Side& side) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < triangles_of(mesh); ++t) {
    const FormulaTriangle triangle = triangle_of(mesh, t);
    const bool top = std::all_of(triangle.begin(), triangle.end(), [&](const FormulaCorner& corner) {
      return is_cap_corner(corner, half, radius, true);
    });
    const bool bottom = std::all_of(triangle.begin(), triangle.end(), [&](const FormulaCorner& corner) {
      return is_cap_corner(corner, -half, radius, false);
    });
    double least = 2, most = -1;
    bool on_side = true;
    for (const FormulaCorner& corner : triangle) {
      on_side = on_side && side(corner);
      least = std::min(least, corner.texture_coordinate.x);
      most = std::max(most, corner.texture_coordinate.x);
    }
    on_side = on_side && most - least < 1.0 / segments + 1e-5;
    const glm::dvec3 looks = area_vector(mesh, t);
    const bool outwards = glm::dot(looks, triangle[0].normal + triangle[1].normal + triangle[2].normal) > 0;
    count += !(top || bottom || on_side) || !outwards;
  }
  return count;
}

}  // namespace

TEST_CASE("matches the formulas for Boxes of random sizes (VRML97 6.7)") {
  Random random(607);
  for (int round = 0; round < 200; round += static_cast<int>(gs::watched_step(9))) {
    const glm::dvec3 size(random.measure(), random.measure(), random.measure());
    const Mesh mesh = GeometryScene("Box").set<SFVec3f>("size", glm::vec3(size)).mesh();
    REQUIRE(triangles_of(mesh) == 12);
    REQUIRE(open_edges(mesh) == 0);
    std::size_t wrong = 0;
    for (std::size_t t = 0; t < 12; ++t)
      for (const FormulaCorner& corner : triangle_of(mesh, t)) {
        const glm::dvec3 p = corner.position / size, n = corner.normal;  // p: -1/2 to 1/2
        // The texture is upright on front, right, back and left. On the top it is upright if the box is tilted towards
        // +Z, on the bottom if it is tilted towards -Z (6.7).
        glm::dvec2 texture(0);
        if (n == glm::dvec3(0, 0, 1))
          texture = {p.x + 0.5, p.y + 0.5};
        else if (n == glm::dvec3(0, 0, -1))
          texture = {0.5 - p.x, p.y + 0.5};
        else if (n == glm::dvec3(1, 0, 0))
          texture = {0.5 - p.z, p.y + 0.5};
        else if (n == glm::dvec3(-1, 0, 0))
          texture = {0.5 + p.z, p.y + 0.5};
        else if (n == glm::dvec3(0, 1, 0))
          texture = {p.x + 0.5, 0.5 - p.z};
        else if (n == glm::dvec3(0, -1, 0))
          texture = {p.x + 0.5, 0.5 + p.z};
        else
          ++wrong;
        wrong += glm::length(corner.texture_coordinate - texture) > 1e-6;
        wrong += std::abs(glm::dot(p, n) - 0.5) > 1e-6;  // the corner is on that face
        wrong += !near_all(glm::abs(p), glm::dvec3(0.5), 1e-6);
        wrong += !(glm::dot(area_vector(mesh, t), n) > 0);
      }
    REQUIRE(wrong == 0);
    REQUIRE(area_of(mesh) == Approx(2 * (size.x * size.y + size.y * size.z + size.z * size.x)));
    REQUIRE(volume_of(mesh) == Approx(size.x * size.y * size.z));
  }
}

TEST_CASE("matches the formulas for Cylinders of random sizes (VRML97 6.14)") {
  Random random(614);
  for (int round = 0; round < 200; round += static_cast<int>(gs::watched_step(9))) {
    const double radius = random.measure(), height = random.measure();
    const int segments = 3 + random.below(40);
    GeometryScene scene("Cylinder");
    scene.set("radius", static_cast<SFFloat>(radius)).set("height", static_cast<SFFloat>(height));
    const Mesh mesh = scene.mesh({.segments = segments});
    const auto side = [&](const FormulaCorner& corner) {
      const glm::dvec3 p = corner.position;
      return near_all(corner.normal, {p.x / radius, 0, p.z / radius}, 1e-5) &&
             std::abs(std::abs(p.y) - height / 2) < 1e-6 * height &&
             same_s(corner.texture_coordinate.x, s_around(p.x, p.z)) &&
             std::abs(corner.texture_coordinate.y - (p.y / height + 0.5)) < 1e-5;
    };
    REQUIRE(triangles_of(mesh) == static_cast<std::size_t>(4 * segments));
    REQUIRE(open_edges(mesh) == 0);
    REQUIRE(faults(mesh, height / 2, radius, segments, side) == 0);
    // The volume is that of a prism over a regular polygon.
    const double base = 0.5 * segments * radius * radius * std::sin(kTurn / segments);
    REQUIRE(volume_of(mesh) == Approx(base * height));
    REQUIRE(area_of(mesh) == Approx(2 * base + 2 * segments * radius * std::sin(kTurn / 2 / segments) * height));
  }
}

TEST_CASE("matches the formulas for Cones of random sizes (VRML97 6.11)") {
  Random random(611);
  for (int round = 0; round < 200; round += static_cast<int>(gs::watched_step(9))) {
    const double radius = random.measure(), height = random.measure();
    const int segments = 3 + random.below(40);
    GeometryScene scene("Cone");
    scene.set("bottomRadius", static_cast<SFFloat>(radius)).set("height", static_cast<SFFloat>(height));
    const Mesh mesh = scene.mesh({.segments = segments});
    const double slant = std::hypot(radius, height);
    const auto side = [&](const FormulaCorner& corner) {
      const glm::dvec3 p = corner.position, n = corner.normal;
      if (std::abs(corner.texture_coordinate.y - (p.y / height + 0.5)) > 1e-5) return false;
      if (std::abs(n.y - radius / slant) > 1e-5) return false;  // perpendicular to the slope
      // At the apex every normal is valid. The texture coordinate of a corner gives its direction.
      const double s = corner.texture_coordinate.x;
      const glm::dvec3 outwards(-std::sin(kTurn * s) * height / slant, radius / slant,
                                -std::cos(kTurn * s) * height / slant);
      if (!near_all(n, outwards, 1e-4)) return false;
      const double ring = std::hypot(p.x, p.z);
      if (std::abs(p.y - height / 2) < 1e-6 * height) return ring == 0;
      return std::abs(ring - radius) < 1e-5 * radius && same_s(s, s_around(p.x, p.z));
    };
    REQUIRE(triangles_of(mesh) == static_cast<std::size_t>(2 * segments));
    REQUIRE(open_edges(mesh) == 0);
    REQUIRE(faults(mesh, height / 2, radius, segments, side) == 0);
    const double base = 0.5 * segments * radius * radius * std::sin(kTurn / segments);
    REQUIRE(volume_of(mesh) == Approx(base * height / 3));
  }
}

TEST_CASE("matches the formulas for Spheres of random radii (VRML97 6.43)") {
  Random random(640);
  for (int round = 0; round < 100; round += static_cast<int>(gs::watched_step(9))) {
    const double radius = random.measure();
    const int segments = 3 + random.below(40);
    const Mesh mesh = GeometryScene("Sphere").set("radius", static_cast<SFFloat>(radius)).mesh({.segments = segments});
    std::size_t wrong = 0;
    for (std::size_t t = 0; t < triangles_of(mesh); ++t) {
      double least = 2, most = -1;
      for (const FormulaCorner& corner : triangle_of(mesh, t)) {
        const glm::dvec3 p = corner.position / radius;
        const glm::dvec2 texture = corner.texture_coordinate;
        const bool pole = std::abs(p.y) > 1 - 1e-7;
        wrong += std::abs(glm::length(p) - 1) > 1e-5;
        wrong += !near_all(corner.normal, p, 1e-5);
        wrong += !pole && !same_s(texture.x, s_around(p.x, p.z));
        wrong += std::abs(texture.y - (0.5 + std::asin(std::clamp(p.y, -1.0, 1.0)) / std::numbers::pi)) > 1e-3;
        least = std::min(least, texture.x);
        most = std::max(most, texture.x);
      }
      wrong += most - least > 1.0 / segments + 1e-5;
      wrong += !(glm::dot(area_vector(mesh, t), corner(mesh, 3 * t)) > 0);
    }
    REQUIRE(wrong == 0);
    REQUIRE(open_edges(mesh) == 0);
    REQUIRE(volume_of(mesh) > 0.2 * radius * radius * radius);
    REQUIRE(volume_of(mesh) < 4.0 / 3 * std::numbers::pi * radius * radius * radius);
  }
  const double fine = volume_of(GeometryScene("Sphere").mesh({.segments = 256}));
  CHECK(fine == Approx(4.0 / 3 * std::numbers::pi).epsilon(1e-3));
}
