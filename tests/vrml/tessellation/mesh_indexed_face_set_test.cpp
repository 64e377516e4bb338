#include "tests/vrml/mesh_checks.h"

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

GeometryScene face_set(MFVec3f points, MFInt32 index) {
  GeometryScene faces("IndexedFaceSet");
  faces.points(std::move(points)).set("coordIndex", std::move(index));
  return faces;
}
GeometryScene cube() { return face_set(cube_points(), cube_faces()); }

/// Two triangles with the common edge 1-2: in the plane z = 0, and upright in x = 1.
MFVec3f bent_points() { return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, -1}}; }
MFInt32 bent_faces() { return {0, 1, 2, -1, 1, 3, 2, -1}; }

const Color kWhite{1, 1, 1};

/// Returns the colours at the corners of all triangles, in order.
std::vector<Color> corner_colors(const Mesh& mesh) {
  std::vector<Color> colors;
  for (const std::uint32_t i : mesh.indices) colors.push_back(mesh.colors[i]);
  return colors;
}

}  // namespace

TEST_CASE("makes a closed, flat cube with its front outside") {
  const Mesh mesh = cube().mesh();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 12);
  CHECK(mesh.positions.size() == 24);
  CHECK(volume_of(mesh) == Approx(8));
  CHECK(normals_on_front(mesh));
  CHECK(mesh.colors.empty());
  CHECK(mesh.solid);
  CHECK(mesh.lit);
}

TEST_CASE("accepts an IndexedFaceSet without the last -1") {
  const MFVec3f points = cube_points();
  CHECK(triangles_of(face_set(points, {4, 5, 6, 7, -1}).mesh()) == 2);
  CHECK(triangles_of(face_set(points, {4, 5, 6, 7}).mesh()) == 2);
  CHECK(triangles_of(face_set(points, {4, 5, 6, -1, 6, 7, 4}).mesh()) == 2);
}

TEST_CASE("turns faces and generated normals on ccw FALSE, but no given normals") {
  GeometryScene faces = face_set({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 3, -1});
  faces.set("ccw", false);
  for (const float crease : {0.0f, 1.0f}) {
    faces.set("creaseAngle", crease);
    const Mesh mesh = faces.mesh();
    check_promises(mesh);
    CHECK(area_vector(mesh, 0).z < 0);
    CHECK(area_vector(mesh, 1).z < 0);
    for (const glm::vec3& normal : mesh.normals) CHECK(normal == glm::vec3(0, 0, -1));
  }
  faces.normals({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  const Mesh given = faces.mesh();
  CHECK(area_vector(given, 0).z < 0);
  CHECK(given.normals[0] == glm::vec3(0, 0, 1));
}

TEST_CASE("copies solid of an IndexedFaceSet to the mesh") {
  CHECK_FALSE(cube().set("solid", false).mesh().solid);
  CHECK_FALSE(face_set({}, {}).set("solid", false).mesh().solid);
}

TEST_CASE("triangulates concave faces if convex is FALSE") {
  GeometryScene faces =
      face_set({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 4, 0}, {3, 1, 0}, {0, 1, 0}}, {0, 1, 2, 3, 4, 5});
  faces.set("convex", false);
  for (const bool ccw : {true, false}) {
    const Mesh mesh = faces.set("ccw", ccw).mesh();
    check_promises(mesh);
    CHECK(triangles_of(mesh) == 4);
    CHECK(area_of(mesh) == Approx(7));
    CHECK(normals_on_front(mesh));
    CHECK(mesh.normals[0].z == (ccw ? 1 : -1));
  }
}

TEST_CASE("smooths IndexedFaceSet edges below the crease angle") {
  GeometryScene faces = face_set(bent_points(), bent_faces());
  SECTION("0 is flat") {
    const Mesh mesh = faces.mesh();
    CHECK(mesh.positions.size() == 6);
    CHECK(mesh.normals[mesh.indices[0]] == glm::vec3(0, 0, 1));
    CHECK(mesh.normals[mesh.indices[3]] == glm::vec3(1, 0, 0));
  }
  SECTION("less than the angle between the faces keeps the edge") {
    const Mesh mesh = faces.set<SFFloat>("creaseAngle", 1.5f).mesh();
    check_promises(mesh);
    CHECK(mesh.positions.size() == 6);
    CHECK(near(mesh.normals[mesh.indices[1]], {0, 0, 1}));
    CHECK(near(mesh.normals[mesh.indices[3]], {1, 0, 0}));
  }
  SECTION("more smooths it, and vertices stay shared") {
    const Mesh mesh = faces.set<SFFloat>("creaseAngle", 1.6f).mesh();
    check_promises(mesh);
    CHECK(mesh.positions.size() == 4);
    const float half = std::sqrt(0.5f);
    CHECK(near(mesh.normals[1], {half, 0, half}));
    CHECK(near(mesh.normals[2], {half, 0, half}));
    CHECK(near(mesh.normals[0], {0, 0, 1}));
    CHECK(near(mesh.normals[3], {1, 0, 0}));
    CHECK(normals_on_front(mesh));
  }
}

TEST_CASE("shares one vertex per corner of a smooth cube, with diagonal normals") {
  GeometryScene faces = cube();
  for (const float crease : {1.6f, kPi, 100.0f}) {
    const Mesh mesh = faces.set<SFFloat>("creaseAngle", crease).mesh();
    check_promises(mesh);
    CHECK(mesh.positions.size() == 8);
    for (std::size_t i = 0; i < 8; ++i) CHECK(near(mesh.normals[i], glm::normalize(mesh.positions[i])));
  }
  CHECK(faces.set<SFFloat>("creaseAngle", kPi / 2 - 0.01f).mesh().positions.size() == 24);
  for (const float none : {-1.0f, kNaN}) CHECK(faces.set<SFFloat>("creaseAngle", none).mesh().positions.size() == 24);
}

TEST_CASE("smooths the sides of a prism and keeps the edges at its caps") {
  // A tube of 16 sides with caps: the sides are 22.5 degrees apart, the caps 90.
  constexpr int kSides = 16;
  MFVec3f points;
  MFInt32 index;
  for (int i = 0; i < kSides; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / kSides;
    points.push_back({std::cos(angle), 0, -std::sin(angle)});
    points.push_back({std::cos(angle), 1, -std::sin(angle)});
  }
  for (int i = 0; i < kSides; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % kSides);
    for (const int vertex : {a, b, b + 1, a + 1, -1}) index.push_back(vertex);
  }
  for (int i = 0; i < kSides; ++i) index.push_back(2 * i + 1);
  index.push_back(-1);
  for (int i = kSides - 1; i >= 0; --i) index.push_back(2 * i);
  const Mesh mesh = face_set(points, index).set<SFFloat>("creaseAngle", 0.5f).mesh();
  check_promises(mesh);
  CHECK(mesh.positions.size() == 4 * kSides);  // each corner once for the side, once for the cap
  CHECK(volume_of(mesh) > 0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 outwards(mesh.positions[i].x, 0, mesh.positions[i].z);
    const glm::vec3 along(0, mesh.positions[i].y > 0.5f ? 1 : -1, 0);
    CHECK((near(mesh.normals[i], outwards, 1e-4f) || near(mesh.normals[i], along, 1e-4f)));
  }
}

TEST_CASE("smooths a vertex with thousands of faces") {
  for (const int sides : {255, 257, 5000}) {
    MFVec3f points{{0, 0.2f, 0}};
    MFInt32 index;
    for (int i = 0; i < sides; ++i) {
      const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(sides);
      points.push_back({std::cos(angle), 0, -std::sin(angle)});
      for (const int vertex : {0, 1 + i, 1 + (i + 1) % sides, -1}) index.push_back(vertex);
    }
    // All face normals are within 0.5 of the axis, so creaseAngle 0.5 smooths all. With 0.1, only near faces share
    // normals.
    const Mesh smooth = face_set(points, index).set<SFFloat>("creaseAngle", 0.5f).mesh();
    check_promises(smooth);
    CHECK(near(smooth.normals[0], {0, 1, 0}, 1e-3f));
    const Mesh sharp = face_set(points, index).set<SFFloat>("creaseAngle", 0.1f).mesh();
    check_promises(sharp);
    CHECK(normals_on_front(sharp));
    CHECK(sharp.positions.size() > static_cast<std::size_t>(sides) + 3);
  }
}

TEST_CASE("shares arrays that fit with the node, without a copy") {
  GeometryScene faces = cube();
  MFVec3f normals;
  for (const glm::vec3& p : cube_points()) normals.push_back(glm::normalize(p));
  const MFColor colors{kRed, kGreen, kBlue, kWhite, kRed, kGreen, kBlue, kWhite};
  faces.normals(normals).colors(colors);
  SECTION("by coordIndex") {}
  SECTION("by indices that repeat coordIndex") {
    faces.set("normalIndex", MFInt32(cube_faces().span()));
    faces.set("colorIndex", MFInt32(cube_faces().span().first(29)));  // without the last -1
  }
  const Mesh mesh = faces.mesh({.texture_coordinates = false});
  check_promises(mesh);
  CHECK(mesh.normals.shares_with(normals));
  CHECK(mesh.colors.shares_with(colors));
  const auto coord = faces.scene.get<SFNode>(faces.geometry, "coord");
  CHECK(mesh.positions.shares_with(faces.scene.get<MFVec3f>(coord, "point")));
  CHECK(triangles_of(mesh) == 12);
  CHECK(mesh.texture_coordinates.empty());
  CHECK(faces.mesh().texture_coordinates.size() == 8);
}

TEST_CASE("makes a smaller array for few faces out of many coordinates") {
  MFVec3f points, normals;
  MFColor colors;
  MFVec2f texture;
  for (int i = 0; i < 5000; ++i) {
    points.push_back({static_cast<float>(i), static_cast<float>(i % 7), static_cast<float>(i % 5)});
    normals.push_back({0, 0, 1});
    colors.push_back({static_cast<float>(i) / 5000, 0, 0});
    texture.push_back({static_cast<float>(i), 0});
  }
  GeometryScene faces = face_set(points, {4000, 4001, 4003, -1, 4003, 9999, 1, -1, 4003, 4001, 4008, -1});
  faces.normals(normals).colors(colors).texture(texture);
  const Mesh mesh = faces.mesh();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 2);
  CHECK(mesh.positions.size() <= 8);
  CHECK(mesh.positions[mesh.indices[1]].x == 4001);
  CHECK(mesh.colors[mesh.indices[1]].r == Approx(4001.0 / 5000));
  CHECK(mesh.texture_coordinates[mesh.indices[5]].x == 4008);
}

TEST_CASE("assigns IndexedFaceSet normals per vertex and per face") {
  GeometryScene faces = face_set(bent_points(), bent_faces());
  const glm::vec3 a(0, 0, 1), b(1, 0, 0), c(0, 1, 0);
  const auto corner_normals = [&] {
    const Mesh mesh = faces.mesh();
    check_promises(mesh);
    std::vector<glm::vec3> normals;
    for (const std::uint32_t i : mesh.indices) normals.push_back(mesh.normals[i]);
    return normals;
  };
  using Normals = std::vector<glm::vec3>;
  SECTION("a vertex, by coordIndex") {
    faces.normals({a, b, c, a});
    CHECK(corner_normals() == Normals{a, b, c, b, a, c});
  }
  SECTION("a vertex, by normalIndex") {
    faces.normals({a, b}).set("normalIndex", MFInt32{0, 0, 1, -1, 1, 1, 0, -1});
    CHECK(corner_normals() == Normals{a, a, b, b, b, a});
  }
  SECTION("a face, in order") {
    faces.normals({b, c}).set("normalPerVertex", false);
    CHECK(corner_normals() == Normals{b, b, b, c, c, c});
  }
  SECTION("a face, by normalIndex") {
    faces.normals({b, c}).set("normalPerVertex", false).set("normalIndex", MFInt32{1, 0});
    CHECK(corner_normals() == Normals{c, c, c, b, b, b});
  }
  SECTION("are made unit vectors") {
    faces.normals({a * 3.0f, b * 0.01f, c * 1e5f, a});
    CHECK(corner_normals() == Normals{a, b, c, b, a, c});
    faces.set("normalIndex", MFInt32{1, 1, 1, -1, 0, 0, 2});
    CHECK(corner_normals() == Normals{b, b, b, a, a, c});
  }
  SECTION("that are missing or without direction become those of the face") {
    faces.normals({c, glm::vec3(0), {kNaN, 0, 0}});
    CHECK(corner_normals() == Normals{c, a, a, b, b, b});
    faces.set("normalIndex", MFInt32{0, -1, 7, -1, 0});
    CHECK(corner_normals() == Normals{c, a, a, c, b, b});
    faces.set("normalPerVertex", false).set("normalIndex", MFInt32{0});
    CHECK(corner_normals() == Normals{c, c, c, b, b, b});
  }
  SECTION("a Normal node without vectors is none") {
    faces.normals({});
    CHECK(corner_normals() == Normals{a, a, a, b, b, b});
  }
  SECTION("fewer than coordinates are enough where the rest is not used") {
    faces.points({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, -1}, {9, 9, 9}}).normals({a, b, c, a});
    CHECK(corner_normals() == Normals{a, b, c, b, a, c});
    CHECK(faces.mesh().bounds.upper == glm::vec3(1, 1, 0));
  }
}

TEST_CASE("assigns IndexedFaceSet colours per vertex and per face") {
  GeometryScene faces = face_set(bent_points(), bent_faces());
  faces.set<SFFloat>("creaseAngle", 3);
  using Colors = std::vector<Color>;
  const auto colors = [&] {
    const Mesh mesh = faces.mesh();
    check_promises(mesh);
    return corner_colors(mesh);
  };
  SECTION("a vertex, by coordIndex") {
    faces.colors({kRed, kGreen, kBlue, kWhite});
    CHECK(colors() == Colors{kRed, kGreen, kBlue, kGreen, kWhite, kBlue});
  }
  SECTION("a vertex, by colorIndex") {
    faces.colors({kRed, kGreen}).set("colorIndex", MFInt32{0, 0, 1, -1, 1, 1, 0, -1});
    CHECK(colors() == Colors{kRed, kRed, kGreen, kGreen, kGreen, kRed});
  }
  SECTION("a face, in order; faces that cannot be drawn count") {
    faces.set("coordIndex", MFInt32{0, 1, 99, -1, 0, 1, 2, -1, -1, 1, 3, 2, -1});
    faces.colors({kWhite, kRed, kGreen, kBlue}).set("colorPerVertex", false);
    CHECK(colors() == Colors{kRed, kRed, kRed, kBlue, kBlue, kBlue});
  }
  SECTION("a face, by colorIndex") {
    faces.colors({kRed, kGreen}).set("colorPerVertex", false).set("colorIndex", MFInt32{1, 0});
    CHECK(colors() == Colors{kGreen, kGreen, kGreen, kRed, kRed, kRed});
  }
  SECTION("too few: the last one goes on") {
    faces.colors({kRed, kGreen});
    CHECK(colors() == Colors{kRed, kGreen, kGreen, kGreen, kGreen, kGreen});
    faces.set("colorPerVertex", false).colors({kBlue});
    CHECK(colors() == Colors(6, kBlue));
    faces.colors({});
    CHECK(faces.mesh().colors.empty());
  }
  SECTION("too many: the arrays of the mesh still match") {
    faces.colors({kRed, kGreen, kBlue, kWhite, kRed, kRed});
    CHECK(faces.mesh().colors.size() == 4);
  }
}

TEST_CASE("assigns IndexedFaceSet texture coordinates by texCoordIndex") {
  GeometryScene faces = face_set({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 3});
  using Corners = std::vector<glm::vec2>;
  const auto corners = [&] {
    const Mesh mesh = faces.mesh({.texture_coordinates = false});
    check_promises(mesh);
    Corners result;
    for (const std::uint32_t i : mesh.indices) result.push_back(mesh.texture_coordinates[i]);
    return result;
  };
  faces.texture({{0, 0}, {5, 0}, {5, 5}, {0, 5}});
  CHECK(corners() == Corners{{0, 0}, {5, 0}, {5, 5}, {0, 0}, {5, 5}, {0, 5}});
  faces.set("texCoordIndex", MFInt32{3, 2, 1, 0, -1});
  CHECK(corners() == Corners{{0, 5}, {5, 5}, {5, 0}, {0, 5}, {5, 0}, {0, 0}});
  faces.set("texCoordIndex", MFInt32{3, 2, 40, -1});
  CHECK(corners() == Corners{{0, 5}, {5, 5}, {0, 0}, {0, 5}, {0, 0}, {0, 0}});
}

TEST_CASE("derives default texture coordinates from the bounding box") {
  const auto mapped = [](glm::vec3 size, glm::vec3 at) {
    MFVec3f points = cube_points();
    glm::vec3* p = points.mutable_data();
    for (std::size_t i = 0; i < 8; ++i) p[i] = (p[i] + 1.0f) * 0.5f * size + glm::vec3(10, 20, 30);
    const Mesh mesh = face_set(points, cube_faces()).mesh();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      if (near(mesh.positions[i], at * size + glm::vec3(10, 20, 30), 1e-4f)) return mesh.texture_coordinates[i];
    return glm::vec2(-1);
  };
  // Figure 6.10: X twice as large as Z, four times as large as Y.
  CHECK(near(mapped({4, 1, 2}, {1, 1, 1}), {1, 0.5f}));
  CHECK(near(mapped({4, 1, 2}, {0, 1, 1}), {0, 0.5f}));
  CHECK(near(mapped({1, 4, 2}, {0, 1, 0}), {1, 0}));
  CHECK(near(mapped({1, 2, 4}, {0, 1, 0}), {0, 0.5f}));
  // The order X, Y, Z decides between equal sides.
  CHECK(near(mapped({2, 2, 2}, {1, 0, 1}), {1, 0}));
  CHECK(near(mapped({1, 2, 2}, {1, 1, 0}), {1, 0}));
  CHECK(near(mapped({1, 2, 1}, {1, 0, 1}), {0, 0.5f}));
  CHECK(near(mapped({2, 1, 2}, {0, 1, 1}), {0, 1}));
}

TEST_CASE("drops only the broken faces of an IndexedFaceSet") {
  const MFVec3f points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {kNaN, 0, 0}, {0, HUGE_VALF, 0}};
  const auto triangles = [&](MFInt32 index) {
    GeometryScene faces = face_set(points, std::move(index));
    std::size_t count = 0;
    for (const float crease : {0.0f, 2.0f}) {
      for (const bool convex : {true, false}) {
        const Mesh mesh = faces.set("creaseAngle", crease).set("convex", convex).mesh();
        check_promises(mesh);
        count = triangles_of(mesh);
      }
    }
    faces.normals({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
    const Mesh shared = faces.mesh();
    check_promises(shared);
    CHECK(triangles_of(shared) == count);
    return count;
  };
  CHECK(triangles({}) == 0);
  CHECK(triangles({-1}) == 0);
  CHECK(triangles({-1, -1, -1, 0, 1, 2, -1, -1}) == 1);
  CHECK(triangles({0, 1, -1, 0, -1, 0, 1, 2, -1}) == 1);  // too short
  CHECK(triangles({0, 1, 6, -1, 0, 1, 2, -1}) == 1);      // out of range
  CHECK(triangles({0, 1, 2147483647, -1, 0, 1, 2, -1}) == 1);
  CHECK(triangles({0, 1, 4, -1, 0, 1, 2, -1}) == 1);                  // not a number
  CHECK(triangles({0, 1, 2, 5, -1, 0, 1, 2, -1}) == 1);               // infinite
  CHECK(triangles({0, 0, 1, -1, 0, 1, 0, 1, -1, 0, 1, 2, -1}) == 1);  // fewer than three different vertices
  CHECK(triangles({0, 1, 1, 2, 2, 0, -1}) == 1);                      // repeated corners
  CHECK(triangles({0, 1, 2, 3, 0, -1}) == 2);                         // closed by repeating the first
  CHECK(triangles({0, 1, 2, -7, 0, 2, 3, -2147483647}) == 2);         // any negative number ends a face
}

TEST_CASE("makes an empty mesh of an IndexedFaceSet without coordinates") {
  GeometryScene faces("IndexedFaceSet");
  faces.set("coordIndex", cube_faces());
  CHECK(faces.mesh().empty());
  faces.points({});
  CHECK(faces.mesh().empty());
  faces.set<SFNode>("coord", faces.make("Normal"));  // the wrong node
  CHECK(faces.mesh().empty());
}

TEST_CASE("accepts PROTO instances as coord of an IndexedFaceSet") {
  GeometryScene faces = cube();
  const auto coord = faces.scene.get<SFNode>(faces.geometry, "coord");
  faces.set<SFNode>("coord", faces.instance_of(coord));
  CHECK(triangles_of(faces.mesh()) == 12);
}

TEST_CASE("mixes triangles, quadrilaterals and larger faces in one IndexedFaceSet") {
  // The strip in the plane z = 0 has faces of all three kinds, with shared arrays.
  MFVec3f points, normals;
  for (int i = 0; i < 2000; ++i) {
    points.push_back({static_cast<float>(i / 2), static_cast<float>(i % 2), 0});
    normals.push_back({0, 0, 1});
  }
  MFInt32 index;
  const auto add = [&](std::initializer_list<int> face) {
    for (const int vertex : face) index.push_back(vertex);
  };
  double area = 0;
  for (int i = 0; i + 4 < 2000; i += 2, area += 1) {
    if (i % 10 == 0)
      add({i, i + 2, i + 3, i + 1, -1});
    else if (i % 14 == 0)
      add({i, i + 2, i + 3, i + 3, i + 1, i, -1});
    else
      add({i, i + 2, i + 3, -1, i, i + 3, i + 1, -1});
  }
  for (const bool convex : {true, false}) {
    const Mesh mesh = face_set(points, index).normals(normals).set("convex", convex).mesh();
    check_promises(mesh);
    CHECK(area_of(mesh) == Approx(area));
    CHECK(normals_on_front(mesh));
    const Mesh back = face_set(points, index).normals(normals).set("convex", convex).set("ccw", false).mesh();
    CHECK(area_of(back) == Approx(area));
    CHECK(area_vector(back, 0).z < 0);
    CHECK(area_vector(back, triangles_of(back) - 1).z < 0);
  }
}
