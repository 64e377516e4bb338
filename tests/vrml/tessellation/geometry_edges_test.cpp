// Tests of edge cases: holes with bridges, touching corners, straight and constant spines, angles at the crease angle,
// NaN.
#include "tests/vrml/mesh_formulas.h"
#include "tests/watched.h"

#include <algorithm>
#include <limits>

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

using Ring = std::vector<glm::dvec2>;

double area_of_ring(const Ring& ring) {
  double area = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
    area += (a.x * b.y - a.y * b.x) / 2;
  }
  return area;
}

bool is_inside(const Ring& ring, const glm::dvec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

/// Returns a star around `middle`. Its first corner is at angle 0.
Ring star(Random& random, int corners, double least, double most, const glm::dvec2& middle) {
  Ring ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i == 0 ? 0.0 : i + random.between(-0.3, 0.3)) / corners;
    const double radius = random.between(least, most);
    ring.push_back(middle + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

GeometryScene face(const std::vector<glm::dvec2>& corners, const MFInt32& index) {
  MFVec3f points;
  for (const glm::dvec2& p : corners) points.push_back({static_cast<float>(p.x), static_cast<float>(p.y), 0});
  GeometryScene scene("IndexedFaceSet");
  scene.points(points).set("coordIndex", index).set("convex", false);
  return scene;
}

}  // namespace

TEST_CASE("keeps holes open that a bridge joins to the outline of a face (VRML97 6.23)") {
  Random random(6232);
  for (int round = 0; round < 300; round += static_cast<int>(gs::watched_step(9))) {
    // The holes are side by side along X. A bridge joins each hole to its right neighbour, and the first hole to the
    // outline.
    const int holes = 1 + random.below(3);
    const Ring outline = star(random, 10 + random.below(20), 0.8, 1, {0, 0});
    std::vector<Ring> inner;
    for (int h = 0; h < holes; ++h) inner.push_back(star(random, 3 + random.below(8), 0.03, 0.09, {0.45 - 0.3 * h, 0}));
    Ring corners = outline;
    for (const Ring& ring : inner) corners.insert(corners.end(), ring.begin(), ring.end());
    // Corners of a hole run clockwise. The path leaves to the next hole at the leftmost corner.
    MFInt32 index;
    const auto walk = [&](const auto& self, std::size_t hole, std::size_t start) -> void {
      if (hole == inner.size()) return;
      const std::size_t count = inner[hole].size();
      std::size_t left = 0;
      for (std::size_t i = 0; i < count; ++i)
        if (inner[hole][i].x < inner[hole][left].x) left = i;
      for (std::size_t step = 0; step <= count; ++step) {
        const std::size_t at = (count - step) % count;
        index.push_back(static_cast<std::int32_t>(start + at));
        if (at != left || (step == count && left == 0)) continue;
        if (hole + 1 < inner.size()) {
          self(self, hole + 1, start + count);
          index.push_back(static_cast<std::int32_t>(start + at));
        }
      }
    };
    index.push_back(0);
    walk(walk, 0, outline.size());
    for (std::size_t i = 0; i < outline.size(); ++i) index.push_back(static_cast<std::int32_t>(i));
    double area = area_of_ring(outline);
    for (const Ring& ring : inner) area -= area_of_ring(ring);

    const Mesh mesh = face(corners, index).mesh();
    std::size_t wrong = 0;
    for (std::size_t t = 0; t < triangles_of(mesh); ++t) {
      const FormulaTriangle triangle = triangle_of(mesh, t);
      const glm::dvec2 middle((triangle[0].position + triangle[1].position + triangle[2].position) / 3.0);
      const double size = area_vector(mesh, t).z;
      wrong += size < -1e-6;
      if (size < 1e-5) continue;
      wrong += !is_inside(outline, middle);
      for (const Ring& ring : inner) wrong += is_inside(ring, middle);
    }
    INFO("round " << round << ": " << outline.size() << " corners, " << holes << " holes");
    REQUIRE(wrong == 0);
    REQUIRE(area_of(mesh) == Approx(area).epsilon(1e-4));
  }
}

TEST_CASE("covers faces that touch themselves once") {
  // Two squares with a common corner, a frame with touching inner and outer sides, and a comb with a corner on its
  // back.
  const Mesh squares =
      face({{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {1, 2}, {0, 1}}, {0, 1, 2, 3, 4, 5, 2, 6, -1}).mesh();
  CHECK(area_of(squares) == Approx(2));
  const Mesh frame = face({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 1}, {1, 2}, {2, 3}, {3, 2}, {2, 0}},
                          {0, 8, 4, 5, 6, 7, 4, 8, 1, 2, 3, -1})
                         .mesh();
  CHECK(area_of(frame) == Approx(16 - 2));
  const Mesh touching = face({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, {0, 1, 2, 3, 4, -1}).mesh();
  CHECK(area_of(touching) == Approx(8));
  for (const Mesh* mesh : {&squares, &frame, &touching}) {
    check_promises(*mesh);
    for (std::size_t t = 0; t < triangles_of(*mesh); ++t) CHECK(area_vector(*mesh, t).z >= 0);
  }
}

TEST_CASE("skips faces without area, and draws all others") {
  const MFVec3f points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 0}, {1, 1, 0}, {kNaN, 0, 0}, {0, kInfinity, 0}};
  for (const bool convex : {true, false})
    for (const float crease : {0.0f, 1.0f}) {
      // A line, coincident points, two corners, one corner and a NaN corner, beside one real face.
      GeometryScene scene("IndexedFaceSet");
      scene.points(points).set("convex", convex).set("creaseAngle", crease);
      const auto triangles = [&](const MFInt32& index) {
        const Mesh mesh = scene.set("coordIndex", index).mesh();
        check_promises(mesh, false);
        std::size_t count = 0;
        for (std::size_t t = 0; t < triangles_of(mesh); ++t) count += glm::length(area_vector(mesh, t)) > 0;
        return count;
      };
      for (const MFInt32& nothing :
           {MFInt32{0, 1, 2, -1}, MFInt32{0, 3, 0, 3, -1}, MFInt32{0, 1, -1}, MFInt32{0, -1}, MFInt32{0, 1, 5, -1},
            MFInt32{0, 1, 6, -1}, MFInt32{0, 1, 4, 5, -1}, MFInt32{-1, -1}, MFInt32{0, 0, 0, 0, -1}}) {
        CHECK(triangles(nothing) == 0);
        MFInt32 with_face = nothing;
        with_face.append(MFInt32{0, 1, 4, -1}.span());
        CHECK(triangles(with_face) == 1);
      }
      CHECK(triangles({0, 1, 2, 4, -1}) == (convex ? 1 : 2));
    }
}

TEST_CASE("makes edges sharp from the crease angle on (VRML97 4.6.3.5)") {
  // The faces of a cube meet at 90 degrees. Smaller angles are smooth.
  GeometryScene cube("IndexedFaceSet");
  cube.points(cube_points()).set("coordIndex", cube_faces());
  const auto corner_normals = [&](float angle) {
    const Mesh mesh = cube.set("creaseAngle", angle).mesh();
    check_promises(mesh);
    std::size_t diagonal = 0;
    for (const glm::vec3& normal : mesh.normals) diagonal += near(glm::abs(normal), glm::vec3(0.57735027f), 1e-4f);
    return std::pair{mesh.normals.size(), diagonal};
  };
  for (const float sharp : {0.0f, 1.0f, 1.5707f, -1.0f, kNaN}) CHECK(corner_normals(sharp) == std::pair{24ul, 0ul});
  for (const float smooth : {1.5709f, 2.0f, 3.1415927f, 100.0f, kInfinity})
    CHECK(corner_normals(smooth) == std::pair{8ul, 8ul});
}

TEST_CASE("ignores repeated points of an Extrusion (VRML97 6.18.3)") {
  Random random(6186);
  for (int round = 0; round < 200; round += static_cast<int>(gs::watched_step(9))) {
    MFVec2f section, repeated_section, scale, repeated_scale;
    MFVec3f spine, repeated_spine;
    for (int i = 3 + random.below(5); i > 0; --i) section.push_back({random.number(-1, 1), random.number(-1, 1)});
    for (int i = 2 + random.below(5); i > 0; --i) {
      spine.push_back({random.number(-5, 5), random.number(-5, 5), random.number(-5, 5)});
      scale.push_back({random.number(0.5, 2), random.number(0.5, 2)});
    }
    const bool closed = random.flip() && spine.size() > 3;
    if (closed) {
      spine.push_back(spine.front());
      scale.push_back(scale.front());
    }
    for (std::size_t i = 0; i < spine.size(); ++i)
      for (int times = random.below(3); times >= 0; --times) {
        repeated_spine.push_back(spine[i]);
        repeated_scale.push_back(scale[i]);
      }
    for (const glm::vec2& point : section)
      for (int times = random.below(3); times >= 0; --times) repeated_section.push_back(point);
    const auto extrusion = [](const MFVec2f& a, const MFVec3f& b, const MFVec2f& c) {
      return GeometryScene("Extrusion").set("crossSection", a).set("spine", b).set("scale", c).mesh();
    };
    const Mesh mesh = extrusion(section, spine, scale),
               other = extrusion(repeated_section, repeated_spine, repeated_scale);
    std::vector<FormulaTriangle> expected;
    for (std::size_t t = 0; t < triangles_of(mesh); ++t) expected.push_back(triangle_of(mesh, t));
    // Caps of self-intersecting cross-sections may be cut in any way.
    const std::size_t sides = 2 * (section.size() - 1) * (spine.size() - 1);
    REQUIRE(expected.size() >= sides);
    expected.resize(sides);
    const Differences found = differences(other, expected, 10, {.texture_coordinate = true});
    INFO("round " << round << ": " << section.size() << " x " << spine.size());
    CHECK(found.missing == 0);
  }
}

TEST_CASE("turns the cross-section of a straight spine as +Y turns to the spine (VRML97 6.18.3)") {
  Random random(6187);
  for (int round = 0; round < 200; round += static_cast<int>(gs::watched_step(9))) {
    const glm::dvec3 along = glm::normalize(
        glm::dvec3(random.between(-1, 1), random.between(-0.95, 1), random.between(-1, 1)) + glm::dvec3(1e-3));
    const glm::dvec3 origin(random.between(-3, 3), random.between(-3, 3), random.between(-3, 3));
    MFVec3f spine;
    double way = 0;
    for (int i = 2 + random.below(5); i > 0; --i, way += random.between(0.3, 2))
      spine.push_back(glm::vec3(origin + along * way));
    const MFVec2f section{{1, 1}, {1, -1}, {-1, -1}, {-1, 2}};
    const Mesh mesh = GeometryScene("Extrusion")
                          .set("spine", spine)
                          .set("crossSection", section)
                          .set("beginCap", false)
                          .set("endCap", false)
                          .mesh();
    // Rodrigues' formula, with the axis Y x direction.
    const glm::dvec3 axis = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), along));
    const double c = along.y, s = std::sqrt(1 - c * c);
    const auto turned = [&](const glm::dvec3& v) {
      return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1 - c));
    };
    std::vector<FormulaTriangle> expected;
    const auto corner = [&](std::size_t i, std::size_t j) {
      FormulaCorner result;
      result.position = glm::dvec3(spine[i]) + turned({section[j].x, 0, section[j].y});
      return result;
    };
    for (std::size_t i = 0; i + 1 < spine.size(); ++i)
      for (std::size_t j = 0; j + 1 < section.size(); ++j)
        add_quadrilateral(expected, {corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)}, true);
    const Differences found = differences(mesh, expected, 100, {});
    INFO("round " << round << ": " << along.x << ' ' << along.y << ' ' << along.z);
    REQUIRE(found.missing == 0);
    REQUIRE(found.unexpected == 0);
  }
  // A spine upwards causes no rotation, a spine downwards half a turn. A constant spine counts as upwards.
  const MFVec2f section{{1, 1}, {1, -1}, {-1, -1}};
  const auto bounds = [&](const MFVec3f& spine) {
    return GeometryScene("Extrusion").set("spine", spine).set("crossSection", section).mesh().bounds;
  };
  CHECK(near(bounds({{0, 0, 0}, {0, 3, 0}}).upper, {1, 3, 1}));
  CHECK(near(bounds({{0, 0, 0}, {0, -3, 0}}).lower, {-1, -3, -1}));
  CHECK(near(bounds({{0, 5, 0}, {0, 5, 0}}).upper, {1, 5, 1}));
}

TEST_CASE("ends an Extrusion with scale 0 in a point") {
  GeometryScene pyramid("Extrusion");
  pyramid.set("scale", MFVec2f{{1, 1}, {0, 0}}).set("spine", MFVec3f{{0, 0, 0}, {0, 3, 0}});
  const Mesh mesh = pyramid.mesh();
  check_promises(mesh);
  CHECK(volume_of(mesh) == Approx(4));
  CHECK(normals_on_front(mesh));
  for (const std::uint32_t index : mesh.indices) {
    CHECK(std::isfinite(mesh.normals[index].x));
    CHECK(glm::length(mesh.normals[index]) == Approx(1).epsilon(1e-3));
  }
}

TEST_CASE("drops only the faces at NaN or overflowing coordinates") {
  for (const float odd : {kNaN, kInfinity, -kInfinity, 3e38f, -3e38f}) {
    MFVec3f spine{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 3, 0}};
    for (std::size_t i = 0; i < spine.size(); ++i) {
      MFVec3f broken = spine;
      broken.mutable_data()[i].x = odd;
      check_promises(GeometryScene("Extrusion").set("spine", broken).mesh());
    }
    for (const char* field : {"xSpacing", "zSpacing", "creaseAngle"})
      check_promises(GeometryScene("ElevationGrid")
                         .set("height", MFFloat{0, 1, 2, 0})
                         .set("xDimension", SFInt32{2})
                         .set("zDimension", SFInt32{2})
                         .set(field, odd)
                         .mesh());
    MFVec3f corners = cube_points();
    corners.mutable_data()[6].y = odd;
    for (const float crease : {0.0f, 2.0f}) {
      const Mesh mesh = GeometryScene("IndexedFaceSet")
                            .points(corners)
                            .set("coordIndex", cube_faces())
                            .set("creaseAngle", crease)
                            .mesh();
      check_promises(mesh);
      if (!std::isfinite(odd)) CHECK(triangles_of(mesh) == 6);  // three of six faces have that corner
    }
  }
}
