#include "qnv/codecs/gaussians/encode/visibility.h"

#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace gs::qnv::gaussians::visibility_test {
namespace {

/// Adds an opaque sphere of round splats.
void add_sphere(Gaussians& to, float radius, int count) {
  for (int i = 0; i < count; ++i) {
    const float y = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count);
    const float turn = 2.399963f * static_cast<float>(i), r = std::sqrt(1 - y * y);
    to.positions.push_back(radius * glm::vec3(r * std::cos(turn), y, r * std::sin(turn)));
    to.scales.emplace_back(radius * 2.2f / std::sqrt(static_cast<float>(count)));
    to.rotations.emplace_back(0, 0, 0, 1);
    to.opacities.push_back(0.95f);
    to.bases.emplace_back(0.5f);
  }
}

double mean_of(const std::vector<float>& all, std::size_t first, std::size_t count) {
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(count), 0.0) / static_cast<double>(count);
}

}  // namespace

TEST_CASE("gives Gaussians on a surface a high visibility, and those inside a low one") {
  Gaussians body;
  add_sphere(body, 1, 2000);
  add_sphere(body, 0.9f, 1000);
  add_sphere(body, 0.5f, 500);
  add_sphere(body, 0.2f, 200);
  const std::vector<float> all = visibility_of(body, 2, nullptr);
  REQUIRE(all.size() == body.size());
  CHECK(mean_of(all, 0, 2000) > 0.25);
  CHECK(mean_of(all, 2000, 1000) < 0.1);
  CHECK(mean_of(all, 3000, 700) < kLeastVisibility + 0.01);
  CHECK(*std::ranges::min_element(all) >= kLeastVisibility);
}

TEST_CASE("gives the walls of a room a high visibility from inside") {
  Gaussians room;
  add_sphere(room, 1.2f, 3000);
  add_sphere(room, 1.1f, 3000);
  add_sphere(room, 1, 3000);
  const std::vector<float> all = visibility_of(room, 2, nullptr);
  REQUIRE(all.size() == room.size());
  CHECK(mean_of(all, 0, 3000) > 0.2);
  CHECK(mean_of(all, 3000, 3000) < 0.1);
  CHECK(mean_of(all, 6000, 3000) > 0.2);
}

TEST_CASE("gives equal visibility for any number of threads") {
  const Gaussians cloud = test::splat_cloud(2000);
  CHECK(visibility_of(cloud, 1, nullptr) == visibility_of(cloud, 3, nullptr));
  Progress progress;
  progress.cancelled = true;
  CHECK(visibility_of(cloud, 1, &progress).empty());
}

TEST_CASE("gives degenerate Gaussians a visibility") {
  CHECK(visibility_of(test::splat_cloud(1), 1, nullptr) == std::vector<float>{1});
  Gaussians flat = test::splat_cloud(300);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    flat.positions[i].y = 0;
    flat.scales[i] = glm::vec3(0);
  }
  flat.positions[7] = glm::vec3(1e30f, -1e30f, 1e30f);
  flat.scales[8] = glm::vec3(1e20f);
  const std::vector<float> all = visibility_of(flat, 1, nullptr);
  REQUIRE(all.size() == 300);
  const auto [least, most] = std::ranges::minmax_element(all);
  CHECK(*least >= kLeastVisibility);
  CHECK(*most <= 1);
}

}  // namespace gs::qnv::gaussians::visibility_test
