#include "app/formats/mesh/point_areas.h"
#include "app/formats/mesh/points.h"

#include "tests/app/geometry_shapes.h"

#include <algorithm>

namespace gs::app::formats_points_test {
namespace {

using namespace gs::test;
using gs::qnv::Rgb8;

constexpr float kPi = std::numbers::pi_v<float>;

bool near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) { return length(a - b) <= tolerance; }

}  // namespace

TEST_CASE("estimates the areas of points from their neighbours") {
  const Splats ball = sphere(2000, 3);
  const auto areas = point_areas(ball.positions);
  double total = 0;
  for (const float area : areas) total += area;
  CHECK(total == Approx(36 * kPi).epsilon(0.05));

  std::vector<glm::vec3> grid;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) grid.emplace_back(0.5f * static_cast<float>(x), 0.5f * static_cast<float>(y), 2.0f);
  // A centre point has four neighbours at one step, four at sqrt(2), four at two.
  CHECK(point_areas(grid)[15 * 30 + 15] == Approx(kPi * 0.25f * (4 + 4 * 2 + 4 * 4) / 84));

  // Compares with a search of all neighbours.
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<glm::vec3> points;
  for (int i = 0; i < 700; ++i)
    points.emplace_back(unit(random), std::round(unit(random) * 4), unit(random) * unit(random));
  const auto fast = point_areas(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<float> distances;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (k != i) distances.push_back(length(points[k] - points[i]));
    std::sort(distances.begin(), distances.end());
    double squares = 0;
    for (std::size_t k = 0; k < 12; ++k) squares += static_cast<double>(distances[k]) * distances[k];
    REQUIRE(fast[i] == Approx(std::numbers::pi * squares / 84).epsilon(1e-4));
  }
  CHECK(point_areas(std::vector<glm::vec3>()).empty());
  CHECK(point_areas(std::vector<glm::vec3>(1)) == std::vector<float>{1});
  CHECK(point_areas(std::vector<glm::vec3>(5000)) == std::vector<float>(5000, 0));
}

TEST_CASE("reads points with normals") {
  const char* const ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "nx\n"
      "property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\nend_header\n"
      "0 0 0 0 0 2 255 0 9\n1 0 0 0 0 2 1 2 3\n0 0 -0 0 0 1 4 5 6\n5 5 5 0 0 0 7 8 9\n";
  CHECK(is_points_ply(bytes_of(ply)));
  const Splats geometry = vectors_of(import_points_ply, bytes_of(ply));
  REQUIRE(geometry.size() == 2);
  CHECK(geometry.normals[0] == glm::vec3(0, 0, 1));
  CHECK(geometry.colors[0] == Rgb8{255, 0, 9});
  CHECK(geometry.weights[0] == Approx(kPi / 1.5));  // a disc of radius 1 contains one and a half points
  CHECK(metadata(geometry, "points doubled") == "1");
  CHECK(metadata(geometry, "points broken") == "1");
  check_hostile(import_points_ply, bytes_of(ply));

  const char* const xyz = "# points\n0 0 0 0 1 0\n\n 1 0 0 0 1 0 \r\n0 1 0 0 -3 0\n";
  CHECK(vectors_of(import_points_xyz, bytes_of(xyz)).normals[2] == glm::vec3(0, -1, 0));
  CHECK(problem_of(import_points_xyz, bytes_of("0 0 0 0 1 0\n1 2 3\n")).find("line 2") != std::string::npos);
  CHECK(vectors_of(import_points_xyz, bytes_of("0 0 0 0 1 0 9 8 7\n")).colors[0] == Rgb8{9, 8, 7});
  check_hostile(import_points_xyz, bytes_of(xyz));
}

TEST_CASE("reads scanned points") {
  const auto folder = shared_folder() / "data/meshes/cgal";
  if (!std::filesystem::exists(folder / "kitten.xyz")) {
    WARN("no " << folder);
    return;
  }
  const Splats kitten = vectors_of(import_points_xyz, file_bytes(folder / "kitten.xyz"));
  CHECK(kitten.size() == 5210);
  CHECK(near(kitten.normals[0], {0.340472f, 0.937712f, -0.0690972f}));
  // The file has no area. An ellipsoid in its box of 0.65 x 1 x 0.59 has 1.7.
  CHECK(kitten.description.total == Approx(1.7).epsilon(0.15));
  const Bytes building = file_bytes(folder / "building.ply");
  CHECK(is_points_ply(building));
  CHECK(vectors_of(import_points_ply, building).size() == 100000);
}

}  // namespace gs::app::formats_points_test
