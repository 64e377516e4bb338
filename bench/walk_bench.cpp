// Measures a step of a walk over a landscape of a million triangles, and a search for the triangle under the pointer.
// Prints median and longest times in microseconds.

#include "app/view/walking.h"
#include "render/rays/item_bvh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <thread>
#include <vector>

namespace {

using namespace gs;
using Clock = std::chrono::steady_clock;

constexpr int kSide = 708;  // points; 2 * 707 * 707 = 999,698 triangles of half a metre

std::shared_ptr<vrml::Mesh> landscape() {
  auto mesh = std::make_shared<vrml::Mesh>();
  for (int z = 0; z < kSide; ++z)
    for (int x = 0; x < kSide; ++x) {
      const float height = 3 * std::sin(0.03f * static_cast<float>(x)) * std::cos(0.023f * static_cast<float>(z)) +
                           0.1f * std::sin(1.7f * static_cast<float>(x + z));
      mesh->positions.push_back({0.5f * static_cast<float>(x), height, 0.5f * static_cast<float>(z)});
      mesh->bounds.add(mesh->positions.back());
    }
  for (std::uint32_t z = 0; z + 1 < kSide; ++z)
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t a = z * kSide + x, b = a + 1, c = a + kSide, d = c + 1;
      for (const std::uint32_t index : {a, c, b, b, c, d}) mesh->indices.push_back(index);
    }
  return mesh;
}

double microseconds(Clock::time_point from) {
  return std::chrono::duration<double, std::micro>(Clock::now() - from).count();
}

void print(const char* what, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  std::printf("%-28s median %8.1f us, 99 %% %8.1f us, longest %8.1f us\n", what, times[times.size() / 2],
              times[times.size() * 99 / 100], times.back());
}

}  // namespace

int main() {
  render::RenderList list;
  render::DrawItem item;
  item.mesh = landscape();
  list.bounds = item.mesh->bounds;
  list.items.push_back(item);
  render::ItemBvh tree;
  const auto look = [&](const glm::dvec3& from, const glm::dvec3& direction) {
    return tree.nearest(list, {from, direction}, std::size_t{1} << 24, render::Sought::met);
  };
  Clock::time_point begin = Clock::now();
  (void)look({1, 50, 1}, {0, -1, 0});
  std::printf("%-28s %8.1f us\n", "first look, without a tree", microseconds(begin));
  while (tree.bytes() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::printf("%-28s %8.1f ms\n", "its tree is there after", microseconds(begin) / 1000);

  app::Obstacles obstacles;
  obstacles.near = [&](const glm::dvec3& lower, const glm::dvec3& upper) {
    return tree.near(list, lower, upper, 20'000);
  };
  obstacles.distance = [&](const glm::dvec3& from, const glm::dvec3& direction) -> std::optional<double> {
    const auto hit = look(from, direction);
    return hit ? std::optional(hit->triangle.distance) : std::nullopt;
  };
  for (const double speed : {1.5, 10.0}) {
    app::Walk body;
    body.eye = {20, 10, 20};
    std::vector<double> walks, looks;
    for (int i = 0; i < 2000; ++i) {
      const double turn = 0.005 * i;
      const glm::dvec3 way(speed / 60 * std::cos(turn), 0, speed / 60 * std::sin(turn));
      begin = Clock::now();
      body = app::walk(body, app::Avatar{}, obstacles, way, 1.0 / 60);
      walks.push_back(microseconds(begin));
      begin = Clock::now();
      (void)look(body.eye, glm::dvec3(std::cos(turn), -0.2, std::sin(turn)));
      looks.push_back(microseconds(begin));
    }
    std::printf("at %.1f m/s, 60 steps a second%s:\n", speed, body.on_ground ? "" : " (not on the ground!)");
    print("  a step of the walk", std::move(walks));
    print("  a look ahead", std::move(looks));
  }
  return 0;
}
