#include "qnv/mesh/triangle_tree.h"

#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

namespace gs::qnv::displaced::triangle_tree_test {
namespace {

glm::vec3 random_place(std::mt19937& random, float size) {
  const auto number = [&] { return (static_cast<float>(random() % 20001) / 10000 - 1) * size; };
  const float x = number(), y = number();
  return {x, y, number()};
}

/// Returns the smallest distance to any triangle.
template <class Of>
float least(const SurfaceMesh& mesh, const glm::vec3& facing, float cosine, Of of) {
  float found = std::numeric_limits<float>::infinity();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::vec3 a = mesh.positions[mesh.triangles[t][0]], b = mesh.positions[mesh.triangles[t][1]],
                    c = mesh.positions[mesh.triangles[t][2]];
    if (glm::dot(glm::normalize(glm::cross(b - a, c - a)), facing) < cosine) continue;
    found = std::min(found, of(t, a, b, c));
  }
  return found;
}

/// Returns the smallest distance from `p` to a fine grid of points on a triangle.
float near_on(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  constexpr int kSteps = 24;
  float found = std::numeric_limits<float>::infinity();
  for (int j = 0; j <= kSteps; ++j)
    for (int i = 0; i + j <= kSteps; ++i)
      found = std::min(found, glm::length(a + (b - a) * (static_cast<float>(i) / kSteps) +
                                          (c - a) * (static_cast<float>(j) / kSteps) - p));
  return found;
}

}  // namespace

TEST_CASE("finds in a tree of triangles the result of a full search") {
  std::mt19937 random(8);
  for (const SurfaceMesh& mesh : {mesh_of(ball(1)), mesh_of(torus(9, 7)), mesh_of(sheet(9))})
    for (const unsigned threads : {1u, 3u}) {
      const TriangleTree tree(mesh, threads);
      std::size_t met = 0;
      for (int i = 0; i < 120; ++i) {
        const glm::vec3 from = random_place(random, 1.3f);
        const glm::vec3 to = i % 7 == 0 ? glm::vec3(0, 0, 1) : glm::normalize(random_place(random, 1) + 1e-3f);
        const float cosine = i % 3 == 0 ? -1.0f : 0.2f;
        const SurfacePoint hit = tree.along(from, to, 0.8f, to, cosine);
        const float all = least(mesh, to, cosine, [&](std::uint32_t t, auto...) {
          const SurfacePoint one = tree.on(t, from, to, 0.8f);
          return one.triangle == kNone ? std::numeric_limits<float>::infinity() : std::abs(one.distance);
        });
        // On a tie between two triangles either is valid, or both in one query.
        if (std::isfinite(all)) {
          REQUIRE(hit.triangle != kNone);
          CHECK(std::abs(hit.distance) == Approx(all).margin(1e-4));
          CHECK(glm::length(from + hit.distance * to - hit.position) < 1e-5f);
          ++met;
        }
        const SurfacePoint near = tree.nearest(from, 5.0f, to, cosine);
        const float nearest =
            least(mesh, to, cosine, [&](std::uint32_t, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
              return near_on(from, a, b, c);
            });
        if (std::isfinite(nearest)) {
          REQUIRE(near.triangle != kNone);
          CHECK(near.distance <= nearest + 1e-5f);
          CHECK(near.distance >= nearest - 0.05f);
          CHECK(glm::length(near.position - from) == Approx(near.distance).margin(1e-5));
          CHECK(tree.nearest(from, near.distance * 0.9f, to, cosine).triangle == kNone);
        }
      }
      CHECK(met > 10);
    }
}

TEST_CASE("answers queries on a tree of few, no or degenerate triangles") {
  const SurfaceMesh none;
  const TriangleTree empty(none);
  CHECK(empty.nearest({0, 0, 0}, 9, {0, 0, 1}, -1).triangle == kNone);
  CHECK(empty.along({0, 0, 0}, {0, 0, 1}, 9, {0, 0, 1}, -1).triangle == kNone);
  for (std::uint32_t count = 1; count < 30; ++count) {
    SurfaceMesh mesh;
    for (std::uint32_t t = 0; t < count; ++t) {
      const auto x = static_cast<float>(t);
      // Every other triangle is degenerate.
      for (const glm::vec3& p : {glm::vec3(x, 0, 0), glm::vec3(x, 1, 0), glm::vec3(t % 2 ? x : x + 1, 1, 0)})
        mesh.positions.push_back(p);
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const TriangleTree tree(mesh);
    for (std::uint32_t t = 0; t < count; ++t) {
      const float x = static_cast<float>(t) + 0.25f;
      CHECK(tree.nearest({x - 0.25f, 0.5f, 1}, 2, {0, 0, 0}, -1).distance == Approx(1));
      const SurfacePoint hit = tree.along({x, 0.75f, 1}, {0, 0, -1}, 2, {0, 0, 0}, -1);
      CHECK((hit.triangle == kNone) == (t % 2 == 1));
      if (hit.triangle != kNone) CHECK(hit.triangle == t);
    }
  }
}

}  // namespace gs::qnv::displaced::triangle_tree_test
