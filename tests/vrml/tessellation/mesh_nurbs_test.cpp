#include "vrml/tessellation/nurbs.h"

#include "tests/vrml/mesh_checks.h"

#include <algorithm>
#include <random>

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace gs::vrml::mesh_nurbs_test {
namespace {

// Evaluates the definition by Cox and de Boor. N(i, 0) is 1 from knot i to the next knot. N(i, p) blends N(i, p - 1)
// and N(i + 1, p - 1).
double basis(const std::vector<float>& knots, std::size_t i, int degree, double t) {
  if (degree == 0) {
    const bool last = knots[i] < knots[i + 1] && knots[i + 1] >= knots.back() && t >= knots[i + 1];
    return (knots[i] <= t && t < knots[i + 1]) || last ? 1 : 0;
  }
  const double left = knots[i + static_cast<std::size_t>(degree)] - knots[i];
  const double right = knots[i + static_cast<std::size_t>(degree) + 1] - knots[i + 1];
  return (left > 0 ? (t - knots[i]) / left * basis(knots, i, degree - 1, t) : 0) +
         (right > 0 ? (knots[i + static_cast<std::size_t>(degree) + 1] - t) / right * basis(knots, i + 1, degree - 1, t)
                    : 0);
}

const float kHalfRoot = std::sqrt(0.5F);

// Returns a quarter of a cylinder of radius 1 and height 2 around the Y axis, from +Z to +X and upwards.
GeometryScene quarter_cylinder() {
  GeometryScene scene("NurbsSurface");
  scene.set<SFInt32>("uDimension", 3).set<SFInt32>("vDimension", 2).set<SFInt32>("vOrder", 2);
  const float w = kHalfRoot;  // control points are (w x, w y, w z)
  scene.set("controlPoint", MFVec3f{{0, 0, 1}, {w, 0, w}, {1, 0, 0}, {0, 2, 1}, {w, 2 * w, w}, {1, 2, 0}});
  scene.set("weight", MFFloat{1, w, 1, 1, w, 1});
  scene.set("uKnot", MFFloat{0, 0, 0, 1, 1, 1}).set("vKnot", MFFloat{5, 5, 7, 7});
  scene.set<SFInt32>("uTessellation", 8).set<SFInt32>("vTessellation", 3);
  return scene;
}

}  // namespace

TEST_CASE("evaluates NURBS basis functions and slopes as their definition does") {
  std::mt19937 random(17);
  for (int round = 0; round < 200; ++round) {
    const int order = 2 + round % 5;
    const std::size_t points = static_cast<std::size_t>(order) + random() % 6;
    std::vector<float> knots(points + static_cast<std::size_t>(order));
    for (float& knot : knots) knot = static_cast<float>(random() % 8);  // many coincide
    std::sort(knots.begin(), knots.end());
    const double begin = knots[static_cast<std::size_t>(order) - 1], end = knots[points];
    if (!(begin < end)) continue;
    const auto axis = NurbsAxis::make(points, order, knots);
    REQUIRE(axis);
    for (int k = 0; k <= 16; ++k) {
      const double place = k / 16.0, t = begin + (end - begin) * place;
      if (t >= end && end < knots.back()) continue;  // the definition continues after the end
      const NurbsAxis::Weights weights = axis->at(place);
      double sum = 0, slopes = 0;
      REQUIRE(weights.first + axis->order() <= points);
      for (std::size_t i = 0; i < points; ++i) {
        const bool counts = i >= weights.first && i < weights.first + axis->order();
        const double value = counts ? weights.value[i - weights.first] : 0;
        INFO("order " << order << " place " << place << " point " << i);
        CHECK(value == Approx(basis(knots, i, order - 1, t)).margin(1e-9));
        sum += value;
      }
      for (std::size_t i = 0; i < axis->order(); ++i) slopes += weights.slope[i];
      CHECK(sum == Approx(1));
      CHECK(slopes == Approx(0).margin(1e-9));
      // Between knots, the slope matches that of a short step.
      const double step = 1e-6;
      const NurbsAxis::Weights after = axis->at(place + step);
      if (place + step < 1 && after.first == weights.first)
        for (std::size_t i = 0; i < axis->order(); ++i)
          CHECK((after.value[i] - weights.value[i]) / step == Approx(weights.slope[i]).margin(2e-3).epsilon(1e-3));
    }
  }
}

TEST_CASE("replaces unusable knots by uniform ones from the first to the last control point") {
  const std::vector<float> unusable[] = {{},
                                         {0, 1, 2},
                                         {0, 0, 0, 2, 1, 3, 3, 3},
                                         {0, 0, 0, 0, 0, 0, 0, 0},
                                         {0, 0, 0, 1, 2, kNaN, 3, 3},
                                         {0, 0, 0, 1, 2, kInfinity, 3, 3}};
  for (const std::vector<float>& knots : unusable) {
    const auto axis = NurbsAxis::make(5, 3, knots);
    REQUIRE(axis);
    CHECK(axis->at(0).first == 0);
    CHECK(axis->at(0).value[0] == 1);
    CHECK(axis->at(1).first == 2);
    CHECK(axis->at(1).value[2] == Approx(1));
    CHECK(axis->at(0.5).value[1] == Approx(0.75));  // the middle of a uniform quadratic piece
  }
  CHECK_FALSE(NurbsAxis::make(2, 3, std::span<const float>()));
  CHECK_FALSE(NurbsAxis::make(5, 1, std::span<const float>()));
  CHECK_FALSE(NurbsAxis::make(100, NurbsAxis::kMaximumOrder + 1, std::span<const float>()));
  CHECK_FALSE(NurbsAxis::make(5, -3, std::span<const float>()));
}

TEST_CASE("divides a NURBS axis into as many pieces as tessellation demands") {
  const auto axis = NurbsAxis::make(20, 4, std::span<const float>());
  REQUIRE(axis);
  CHECK(axis->steps(7) == 7);
  CHECK(axis->steps(1) == 1);
  CHECK(axis->steps(-3) == 60);
  CHECK(axis->steps(0) == 40);
  CHECK(NurbsAxis::make(4, 4, std::span<const float>())->steps(0) == 16);
  for (const std::int32_t huge : {2'000'000'000, -2'000'000'000, INT32_MIN}) CHECK(axis->steps(huge) == 2048);
}

TEST_CASE("makes a circle of a parabola by the weights of a NurbsCurve") {
  GeometryScene scene("NurbsCurve");
  scene.set("controlPoint", MFVec3f{{1, 0, 0}, {kHalfRoot, kHalfRoot, 0}, {0, 1, 0}})
      .set("knot", MFFloat{0, 0, 0, 1, 1, 1});
  scene.set("weight", MFFloat{1, kHalfRoot, 1}).set<SFInt32>("tessellation", 10);
  const Mesh mesh = scene.mesh();
  check_promises(mesh);
  CHECK(mesh.primitive == Mesh::Primitive::lines);
  CHECK_FALSE(mesh.lit);
  REQUIRE(mesh.positions.size() == 11);
  CHECK(mesh.indices.size() == 20);
  for (const glm::vec3& point : mesh.positions) CHECK(glm::length(point) == Approx(1));
  CHECK(near(mesh.positions[0], {1, 0, 0}));
  CHECK(near(mesh.positions[5], {kHalfRoot, kHalfRoot, 0}));
  CHECK(near(mesh.positions[10], {0, 1, 0}));
  // Without weights, with too few weights, or with weights of 0 or less, the curve is the parabola.
  for (const MFFloat& weights : {MFFloat{}, MFFloat{1, kHalfRoot}, MFFloat{-1, 0, kNaN}})
    CHECK(near(scene.set("weight", weights).mesh().positions[5], {0.25F + kHalfRoot / 2, 0.25F + kHalfRoot / 2, 0}));
}

TEST_CASE("makes a quarter of a cylinder with its normals of a NurbsSurface") {
  GeometryScene scene = quarter_cylinder();
  Mesh mesh = scene.mesh();
  check_promises(mesh);
  CHECK(mesh.solid);
  CHECK(triangles_of(mesh) == 8 * 3 * 2);
  REQUIRE(mesh.positions.size() == 9 * 4);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 point = mesh.positions[i], outwards{point.x, 0, point.z};
    CHECK(glm::length(outwards) == Approx(1));
    CHECK(near(mesh.normals[i], outwards));
  }
  CHECK(normals_on_front(mesh));
  CHECK(mesh.bounds.upper.y == Approx(2));
  // Default texture coordinates cover the surface once.
  CHECK(near(mesh.texture_coordinates[0], glm::vec2(0, 0)));
  CHECK(near(mesh.texture_coordinates[8], glm::vec2(1, 0)));
  CHECK(near(mesh.texture_coordinates[35], glm::vec2(1, 1)));
  mesh = scene.set("ccw", false).set("solid", false).mesh();
  check_promises(mesh);
  CHECK_FALSE(mesh.solid);
  CHECK(near(mesh.normals[0], {0, 0, -1}));
  CHECK(normals_on_front(mesh));
}

TEST_CASE("gives the tip of a cone of NURBS normals of its sides") {
  GeometryScene scene = quarter_cylinder();
  const float w = kHalfRoot, rounded = w * 2 * 1.000001F;  // the rounding of a file
  scene.set("controlPoint", MFVec3f{{0, 0, 1}, {w, 0, w}, {1, 0, 0}, {0, 2, 0}, {0, rounded, 0}, {0, 2, 0}});
  const Mesh mesh = scene.mesh();
  check_promises(mesh);
  REQUIRE(mesh.normals.size() == 9 * 4);
  for (std::size_t i = 0; i < 9; ++i) {
    const glm::vec3 foot = mesh.positions[i], side = glm::normalize(glm::vec3(2 * foot.x, 1, 2 * foot.z));
    CHECK(glm::distance(mesh.normals[27 + i], side) < 0.01F);
  }
}

TEST_CASE("takes texture coordinates of a NurbsSurface from its control points or a NurbsTextureSurface") {
  GeometryScene scene = quarter_cylinder();
  scene.texture({{0, 0}, {1, 0}, {2, 0}, {0, 4}, {1, 4}, {2, 4}});
  Mesh mesh = scene.mesh();
  CHECK(near(mesh.texture_coordinates[4], glm::vec2(1, 0)));
  CHECK(near(mesh.texture_coordinates[35], glm::vec2(2, 4)));
  const NodeId picture = scene.make("NurbsTextureSurface");
  scene.scene.set<MFVec2f>(picture, "controlPoint", {{0, 0}, {0.5F, 0}, {0, 0.25F}, {0.5F, 0.25F}});
  for (const char* field : {"uDimension", "vDimension", "uOrder", "vOrder"})
    scene.scene.set<SFInt32>(picture, field, 2);
  scene.set<SFNode>("texCoord", picture);
  mesh = scene.mesh();
  CHECK(near(mesh.texture_coordinates[4], glm::vec2(0.25F, 0)));
  CHECK(near(mesh.texture_coordinates[35], glm::vec2(0.5F, 0.25F)));
  // Too few coordinates are ignored.
  scene.texture({{3, 3}});
  CHECK(near(scene.mesh().texture_coordinates[35], glm::vec2(1, 1)));
}

TEST_CASE("tolerates broken fields of a NurbsSurface, and bounds huge ones") {
  CHECK(quarter_cylinder().set<SFInt32>("uDimension", 4).mesh().empty());
  CHECK(quarter_cylinder().set<SFInt32>("vDimension", -2).mesh().empty());
  CHECK(quarter_cylinder().set<SFInt32>("uDimension", INT32_MAX).set<SFInt32>("vDimension", INT32_MAX).mesh().empty());
  CHECK(quarter_cylinder().set<SFInt32>("uOrder", 4).mesh().empty());
  CHECK(quarter_cylinder().set<SFInt32>("vOrder", INT32_MIN).mesh().empty());
  CHECK(quarter_cylinder().set("controlPoint", MFVec3f{}).mesh().empty());
  Mesh mesh = quarter_cylinder().set("uKnot", MFFloat{3, 2, 1}).mesh();
  check_promises(mesh);
  CHECK(triangles_of(mesh) == 48);
  mesh = quarter_cylinder()
             .set("controlPoint", MFVec3f{{0, 0, 1}, {1, kNaN, 1}, {1, 0, 0}, {0, 2, 1}, {1, kInfinity, 1}, {1, 2, 0}})
             .mesh();
  check_promises(mesh);
  // Coincident points have no area and draw no wrong triangle.
  mesh = quarter_cylinder()
             .set("controlPoint", MFVec3f{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}})
             .mesh();
  check_promises(mesh);
  mesh = quarter_cylinder().set<SFInt32>("uTessellation", 2'000'000'000).set<SFInt32>("vTessellation", 1).mesh();
  CHECK(triangles_of(mesh) == 2 * 2048);
}

}  // namespace gs::vrml::mesh_nurbs_test
