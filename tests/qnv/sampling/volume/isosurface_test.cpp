#include "qnv/sampling/volume/isosurface.h"
#include "qnv/sampling/volume/marching_cubes.h"

#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <unordered_map>

using namespace gs;

using namespace gs::qnv;
using namespace gs::test;

namespace {

std::vector<Triangle> surface(const VolumeSource& source, double isovalue, unsigned threads = 0) {
  std::vector<Triangle> triangles;
  const auto problem =
      isosurface(source, {.isovalue = isovalue, .threads = threads}, [&](std::span<const Triangle> batch) {
        triangles.insert(triangles.end(), batch.begin(), batch.end());
        return true;
      });
  if (problem) FAIL(problem->message);
  return triangles;
}

struct Bits {
  std::size_t operator()(const std::array<float, 3>& p) const {
    std::size_t hash = 0;
    for (const float v : p) hash = hash * 1000003 ^ std::hash<float>()(v);
    return hash;
  }
};

/// Properties of a mesh, with corners joined at equal floats.
struct Mesh {
  double area = 0, volume = 0;
  std::size_t points = 0;
  std::size_t open_edges = 0;    // directed edges without an equal number in reverse
  std::size_t shared_edges = 0;  // with several triangles on one side
};

Mesh measured(const std::vector<std::array<glm::vec3, 3>>& triangles) {
  Mesh mesh;
  std::unordered_map<std::array<float, 3>, std::uint32_t, Bits> points;
  points.reserve(triangles.size() / 2 + 16);
  std::vector<std::uint64_t> edges, opposite;  // from the upper half to the lower, and in reverse
  edges.reserve(3 * triangles.size());
  for (const auto& corners : triangles) {
    std::array<std::uint32_t, 3> index{};
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::vec3 p = corners[i] + 0.0f;  // -0 and 0 are one
      index[i] =
          points.emplace(std::array<float, 3>{p.x, p.y, p.z}, static_cast<std::uint32_t>(points.size())).first->second;
    }
    const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
    mesh.area += glm::length(glm::cross(b - a, c - a)) / 2;
    mesh.volume += glm::dot(a, glm::cross(b, c)) / 6;
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::uint64_t{index[i]} << 32 | index[(i + 1) % 3]);
  }
  mesh.points = points.size();
  for (const std::uint64_t edge : edges) opposite.push_back(edge >> 32 | edge << 32);
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  for (auto edge = edges.begin(), other = opposite.begin(); edge != edges.end();) {
    const auto end = std::find_if(edge, edges.end(), [&](std::uint64_t one) { return one != *edge; });
    while (other != opposite.end() && *other < *edge) ++other;
    std::ptrdiff_t back = 0;
    for (; other != opposite.end() && *other == *edge; ++other) ++back;
    mesh.open_edges += static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, end - edge - back));
    mesh.shared_edges += end - edge > 1;
    edge = end;
  }
  return mesh;
}

Mesh measured(const std::vector<Triangle>& triangles) {
  std::vector<std::array<glm::vec3, 3>> corners;
  for (const Triangle& triangle : triangles) corners.push_back(triangle.positions);
  return measured(corners);
}

/// Returns noise with a border of zeros, so that surfaces close.
VolumeSource closed_noise(std::uint32_t n, unsigned levels, unsigned seed) {
  std::mt19937 random(seed);
  return volume_of(oblique(n, n, n), [&, n](auto x, auto y, auto z) {
    const bool border = std::min({x, y, z}) == 0 || std::max({x, y, z}) == n - 1;
    const auto value = static_cast<float>(random() % levels);
    return border ? 0.0f : value;
  });
}

VolumeSource ball(VolumeLayout layout, glm::vec3 centre, float radius) {
  return volume_of(layout, [&](auto x, auto y, auto z) {
    return radius -
           glm::distance(centre, place_of(layout, static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)));
  });
}

}  // namespace

TEST_CASE("makes closed loops around the cut edges in every case of marching cubes") {
  using namespace gs::qnv::marching_cubes;
  const Cases& cases = Cases::get();
  std::size_t most = 0;
  for (unsigned inside = 0; inside < 256; ++inside) {
    const unsigned ambiguous = cases.ambiguous_faces(static_cast<std::uint8_t>(inside));
    std::set<std::uint8_t> crossed;
    for (std::uint8_t e = 0; e < 12; ++e)
      if ((inside >> kEdges[e].lower & 1) != (inside >> kEdges[e].upper & 1)) crossed.insert(e);
    for (unsigned joined = 0; joined < 64; ++joined) {
      if ((joined & ~ambiguous) != 0) continue;
      const auto triangles = cases.triangles(static_cast<std::uint8_t>(inside), static_cast<std::uint8_t>(joined));
      most = std::max(most, triangles.size());
      std::set<std::uint8_t> used;
      std::map<std::pair<int, int>, int> sides;
      for (const EdgeTriangle& triangle : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
          used.insert(triangle[i]);
          ++sides[{triangle[i], triangle[(i + 1) % 3]}];
        }
      CHECK(used == crossed);
      std::map<int, int> outline;  // open edges leave each cut edge of the lattice once
      for (const auto& [side, count] : sides) {
        CHECK(count == 1);
        if (!sides.contains({side.second, side.first})) ++outline[side.first];
      }
      CHECK(outline.size() == crossed.size());
      for (const auto& [edge, count] : outline) CHECK(count == 1);
    }
  }
  CHECK(most <= 10);
  CHECK(cases.triangles(0, 0).empty());
  CHECK(cases.triangles(255, 0).empty());
  CHECK(cases.triangles(1, 0).size() == 1);
  CHECK(cases.triangles(0x0f, 0).size() == 2);
}

TEST_CASE("makes the isosurface of a ball with its area, its volume and outward normals") {
  VolumeLayout layout;
  layout.dimensions = {44, 44, 24};
  layout.axes[2] = glm::vec3(0, 0, 2);
  layout.origin = glm::dvec3(-21.3f, -21.6f, -22.8f);
  for (const bool mirrored : {false, true}) {
    if (mirrored) {
      layout.axes[0].x = -1;
      layout.origin.x = 21.3f;
    }
    const float radius = 18.5f;
    const std::vector<Triangle> triangles = surface(ball(layout, glm::vec3(0), radius), 0);
    const Mesh mesh = measured(triangles);
    const double pi = 3.14159265358979;
    CHECK(mesh.area == Approx(4 * pi * radius * radius).epsilon(0.01));
    CHECK(mesh.volume == Approx(4 * pi * radius * radius * radius / 3).epsilon(0.01));
    CHECK(mesh.open_edges == 0);
    CHECK(mesh.shared_edges == 0);
    CHECK(mesh.points == triangles.size() / 2 + 2);  // Euler's formula
    for (const Triangle& triangle : triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        REQUIRE(glm::length(triangle.positions[i]) == Approx(radius).margin(0.05));
        REQUIRE(glm::dot(triangle.normals[i], glm::normalize(triangle.positions[i])) > 0.99f);
      }
  }
}

TEST_CASE("makes an isosurface of a plane across oblique axes in its position") {
  const VolumeLayout layout = oblique(9, 8, 7);
  const glm::vec3 direction = glm::normalize(glm::vec3(1, 2, -1));
  const float middle = glm::dot(direction, place_of(layout, 4, 3.5f, 3));
  const VolumeSource source = volume_of(layout, [&](auto x, auto y, auto z) {
    return glm::dot(direction, place_of(layout, static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))) -
           middle;
  });
  const std::vector<Triangle> triangles = surface(source, 0);
  REQUIRE(triangles.size() > 20);
  for (const Triangle& triangle : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      REQUIRE(glm::dot(direction, triangle.positions[i]) == Approx(middle).margin(1e-4));
      REQUIRE(glm::distance(triangle.normals[i], -direction) < 1e-3f);
    }
}

TEST_CASE("makes an isosurface of noise without cracks") {
  for (const unsigned levels : {2u, 3u, 1000u})
    for (const unsigned seed : {1u, 2u, 3u}) {
      const std::vector<Triangle> triangles = surface(closed_noise(16, levels, seed), levels == 1000 ? 500.5 : 1);
      REQUIRE(triangles.size() > 1000);
      const Mesh mesh = measured(triangles);
      CHECK(mesh.open_edges == 0);
      CHECK(mesh.volume > 0);
      if (levels == 1000) CHECK(mesh.shared_edges == 0);
    }
}

TEST_CASE("makes the same isosurface on any number of threads, in the order of cells", "[optimised]") {
  const VolumeSource source = closed_noise(60, 40, 5);
  const std::vector<Triangle> one = surface(source, 20, 1);
  REQUIRE(one.size() > 100000);
  for (const unsigned threads : {2u, 5u}) {
    const std::vector<Triangle> other = surface(source, 20, threads);
    REQUIRE(other.size() == one.size());
    bool same = true;
    for (std::size_t i = 0; i < one.size(); ++i)
      same = same && one[i].positions == other[i].positions && one[i].normals == other[i].normals;
    CHECK(same);
  }
}

TEST_CASE("makes no isosurface at missing voxels") {
  VolumeLayout layout;
  layout.dimensions = {30, 30, 30};
  const VolumeSource whole = ball(layout, glm::vec3(14.5f), 10);
  const VolumeSource half = volume_of(layout, [&](auto x, auto y, auto z) {
    if (x >= 15) return kNaN;
    return 10 - glm::distance(glm::vec3(14.5f), glm::vec3(x, y, z));
  });
  const std::vector<Triangle> triangles = surface(half, 0);
  REQUIRE_FALSE(triangles.empty());
  for (const Triangle& triangle : triangles)
    for (const glm::vec3& p : triangle.positions) REQUIRE(p.x <= 14);
  CHECK(measured(triangles).area == Approx(measured(surface(whole, 0)).area * 0.5).epsilon(0.1));
  CHECK(surface(volume_of(layout, [](auto...) { return kNaN; }), 0).empty());
}

TEST_CASE("makes no isosurface of a volume without cells, and reports wrong arguments") {
  VolumeLayout layout;
  layout.dimensions = {4, 4, 1};
  CHECK(surface(volume_of<std::uint8_t>(layout, std::vector<std::uint8_t>(16, 3)), 2).empty());
  const TriangleSink all = [](std::span<const Triangle>) { return true; };
  CHECK(isosurface(volume_of<std::uint8_t>(layout, {}), {.isovalue = std::nan("")}, all));
  CHECK(isosurface({layout, nullptr}, {}, all));
  layout.dimensions = {4, 4, 4};
  const auto problem = isosurface(volume_of<std::uint8_t>(layout, std::vector<std::uint8_t>(16, 3)), {}, all);
  REQUIRE(problem);
  CHECK(problem->message.find("slice") != std::string::npos);

  Progress progress;
  progress.cancelled = true;
  const auto cancelled = isosurface(closed_noise(10, 5, 1), {.isovalue = 2}, all, &progress);
  REQUIRE(cancelled);
  CHECK(cancelled->message == "cancelled");
}

TEST_CASE("stops as soon as the sink refuses more triangles") {
  int calls = 0;
  const auto problem =
      isosurface(closed_noise(60, 40, 5), {.isovalue = 20}, [&](std::span<const Triangle>) { return ++calls < 2; });
  CHECK_FALSE(problem);
  CHECK(calls == 2);
}

TEST_CASE("gives the bone of the CT head the area of another marching cubes program", "[optimised]") {
  const std::string folder = GHOSTSPACE_TESTS "/../../shared/data/";
  std::ifstream voxels(folder + "volumes/cthead/CThead.be.raw", std::ios::binary);
  std::ifstream reference(folder + "meshes/derived/cthead_bone_iso1400.ply", std::ios::binary);
  if (!voxels || !reference) {
    WARN("no CT head in ../shared/data");
    return;
  }
  VolumeLayout layout;
  layout.dimensions = {256, 256, 113};
  layout.axes[2].z = 2;
  layout.type = VoxelType::u16;
  layout.big_endian = true;
  std::vector<std::uint16_t> stored(256 * 256 * 113);
  voxels.read(reinterpret_cast<char*>(stored.data()), static_cast<std::streamsize>(stored.size() * 2));
  const std::vector<Triangle> ours = surface(volume_of(layout, std::move(stored)), 1400);

  std::string line;
  while (std::getline(reference, line) && line != "end_header") {
  }
  constexpr std::size_t kPoints = 283391, kTriangles = 567060;
  std::vector<std::array<float, 6>> points(kPoints);
  reference.read(reinterpret_cast<char*>(points.data()), kPoints * sizeof(points[0]));
  std::vector<std::array<glm::vec3, 3>> theirs(kTriangles);
  for (auto& triangle : theirs) {
    std::array<std::int32_t, 3> index{};
    reference.get();  // the count of corners: 3
    reference.read(reinterpret_cast<char*>(index.data()), sizeof(index));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& p = points.at(static_cast<std::size_t>(index[i]));
      triangle[i] = glm::vec3(p[0], p[1], p[2]);
    }
  }
  REQUIRE(reference);
  const Mesh our_mesh = measured(ours), their_mesh = measured(theirs);
  INFO("ours: " << ours.size() << " triangles, area " << our_mesh.area << ", volume " << our_mesh.volume << ", "
                << our_mesh.points << " points, " << our_mesh.open_edges << " open edges, " << our_mesh.shared_edges);
  INFO("theirs: " << theirs.size() << " triangles, area " << their_mesh.area << ", volume " << their_mesh.volume << ", "
                  << their_mesh.points << " points, " << their_mesh.open_edges << " open edges, "
                  << their_mesh.shared_edges);
  CHECK(static_cast<double>(ours.size()) == Approx(static_cast<double>(kTriangles)).epsilon(0.005));
  CHECK(our_mesh.area == Approx(their_mesh.area).epsilon(0.002));
  CHECK(our_mesh.volume == Approx(their_mesh.volume).epsilon(0.001));
  CHECK(our_mesh.open_edges <= their_mesh.open_edges);
}
