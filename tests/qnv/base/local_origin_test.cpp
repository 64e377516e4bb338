#include "qnv/base/description.h"

#include <catch2/catch.hpp>

#include <limits>
#include <random>

namespace gs::qnv {
namespace {

WideBox box_about(const glm::dvec3& middle, double half) { return {middle - half, middle + half}; }

TEST_CASE("moves the origin to the middle of a small distant box axis by axis") {
  CHECK(local_origin({}) == glm::dvec3(0));
  CHECK(local_origin(box_about({3, -20, 31}, 1)) == glm::dvec3(0));
  CHECK(local_origin(box_about({4'500'000.3, 3, -33}, 1)) == glm::dvec3(4'500'000.5, 0, -33));
  CHECK(local_origin(box_about({1, 2, 3}, 0)) == glm::dvec3(0));
  CHECK(local_origin(box_about({1, 2, 3000.5}, 0)) == glm::dvec3(0, 0, 3000.5));
  CHECK(local_origin(box_about({1e300, 0, 0}, 1)).y == 0);
  // The origin is a float32 value, so that float32 positions can represent it.
  const glm::dvec3 origin = local_origin(box_about({123'456.789, 9.87654321e8, -77.7}, 0.5));
  CHECK(glm::dvec3(glm::vec3(origin)) == origin);
}

TEST_CASE("keeps float32 positions exactly when they are relative to the local origin") {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> about(-1, 1);
  for (const float away : {33.0f, 1000.0f, 123'456.0f, 4'500'000.0f, 1e9f}) {
    const glm::dvec3 middle(away, -away * 3, 0.25f);
    WideBox box;
    std::vector<glm::vec3> places;
    for (int i = 0; i < 100; ++i) {
      places.push_back(glm::vec3(middle) + glm::vec3(about(random), about(random), about(random)));
      box.add(places.back());
    }
    const glm::dvec3 origin = local_origin(box);
    bool same = origin.x != 0 && origin.y != 0 && origin.z == 0;
    for (const glm::vec3& p : places)
      same = same && glm::vec3(origin + glm::dvec3(glm::vec3(glm::dvec3(p) - origin))) == p;
    CHECK(same);
  }
}

}  // namespace
}  // namespace gs::qnv
